//! A cushion near the end of the stroke.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "end_stop",
    equation: "f = k d (d/10 mm)^(n - 1) (1 + l d'), d = max(abs(x) - x_c, 0), against x",
    stage: Stage::Table,
    family: Family::Contact,
    parameters: &[
        Parameter {
            key: "position",
            unit: "m",
            rigid_unit: "m",
            meaning: "displacement where the cushion begins",
            signal_scale: SignalScale::Displacement,
            low: 0.33,
            high: 2.0,
            starts: &[0.985, 0.92, 0.75, 0.5],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        Parameter {
            key: "stiffness",
            unit: "1/s2",
            rigid_unit: "1/s2",
            meaning: "cushion stiffness per table mass",
            signal_scale: SignalScale::One,
            low: 1.0,
            high: 1e5,
            starts: &[30.0, 1000.0],
            positive: true,
            simple: Ends::Both,
            role: Role::Shared,
        },
        Parameter {
            key: "exponent",
            unit: "1",
            rigid_unit: "1",
            meaning: "how the cushion stiffens with depth, its stiffness that at 10 mm: n",
            signal_scale: SignalScale::One,
            low: 1.0,
            high: 4.0,
            starts: &[1.0],
            positive: true,
            simple: Ends::Low,
            role: Role::Refined,
        },
        Parameter {
            key: "loss",
            unit: "s/m",
            rigid_unit: "s/m",
            meaning: "what the cushion resists more per speed inwards, as a throttled outflow does: l",
            signal_scale: SignalScale::One,
            low: 0.0,
            high: 100.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Low,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a force beyond one displacement, on both sides",
    mistaken_for: &["displacement_nonlinearity"],
    test: "slow sweeps of growing amplitude",
    order: Order::Second,
    contains: &[],
    counter: None,
};

/// A cushion near the end of the stroke.
#[derive(Debug, Clone)]
pub(crate) struct EndStop<S> {
    position: S,
    stiffness: S,
    exponent: S,
    loss: S,
}

/// Depth at which the stiffness is stated of a cushion that stiffens, m.
const DEPTH: f64 = 0.01;
/// How many times as fast one that stiffens may swing deeper in.
const DEEPER: f64 = 3.0;

impl<S: Scalar> EndStop<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[position, stiffness, exponent, loss] = parameters else { return None };
        Some(Self { position, stiffness, exponent, loss })
    }
}

impl<S: Scalar> Effect<S> for EndStop<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        let deeper = if self.exponent.value() > 1.0 { DEEPER } else { 1.0 };
        deeper * self.stiffness.value().abs().sqrt()
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        let beyond = at.displacement - at.displacement.clamp(-self.position, self.position);
        if beyond.value() == 0.0 {
            return beyond;
        }
        let sign = beyond.value().signum();
        let stiffened = ((beyond * sign) / DEPTH).pow(self.exponent - 1.0);
        let inwards = self.loss * at.velocity * sign + 1.0;
        // A cushion does not pull.
        beyond * self.stiffness * stiffened * inwards.max(S::from(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn force(details: [f64; 2], displacement: f64, velocity: f64) -> f64 {
        let stop = EndStop::<f64>::new(&[0.1, 500.0, details[0], details[1]]).unwrap();
        let at = Instant { time: 0.0, displacement, velocity, sensed_velocity: velocity, velocity_limit: 1.0 };
        stop.force(&at, &[], &mut [])
    }

    /// Without details a spring beyond the position; with them stiffer the deeper, and harder to enter than to leave. It never pulls.
    #[test]
    fn a_cushion_pushes_back_by_its_law() {
        assert_eq!(force([1.0, 0.0], 0.09, 0.3), 0.0);
        assert!((force([1.0, 0.0], 0.12, 0.3) - 10.0).abs() < 1e-12);
        assert!((force([2.0, 0.0], -0.12, 0.3) + 20.0).abs() < 1e-12, "at 10 mm as stiff as stated, at 20 mm twice");
        assert!((force([1.0, 2.0], 0.12, 0.3) - 16.0).abs() < 1e-12);
        assert!((force([1.0, 2.0], -0.12, -0.3) + 16.0).abs() < 1e-12);
        assert_eq!(force([1.0, 2.0], 0.12, -0.8), 0.0);
    }
}
