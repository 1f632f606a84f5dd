//! Something elastic between the table and the ground: hoses, cable chains, a gas spring, a gravity restoring force.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "spring",
    equation: "f = k x (1 + c x^2)",
    stage: Stage::Table,
    family: Family::Contact,
    parameters: &[
        Parameter {
            key: "stiffness",
            unit: "1/s2",
            rigid_unit: "N/m",
            meaning: "stiffness per table mass about the middle of the stroke",
            signal_scale: SignalScale::Force,
            low: 1e-4,
            high: 1e4,
            starts: &[0.5, 20.0],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "hardening",
            unit: "1/m2",
            rigid_unit: "1/m2",
            meaning: "relative change of stiffness per square of displacement: c",
            signal_scale: SignalScale::Curvature,
            low: -0.9,
            high: 20.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::High,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a force that grows with displacement; the table creeps back when the valve closes",
    mistaken_for: &["leakage", "end_stop", "tilt_coupling", "displacement_lag"],
    test: "pressure held at several places, at rest",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// A spring that hardens or softens with displacement.
#[derive(Debug, Clone)]
pub(crate) struct Spring<S> {
    stiffness: S,
    hardening: S,
    /// It is straight, and no derivative asks what if it were not.
    straight: bool,
}

impl<S: Scalar> Spring<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[stiffness, hardening] = parameters else { return None };
        let straight = hardening.is_nothing();
        Some(Self { stiffness, hardening, straight })
    }
}

impl<S: Scalar> Effect<S> for Spring<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, linear: self.straight, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        self.stiffness.value().abs().sqrt()
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        let linear = self.stiffness * at.displacement;
        if self.straight { linear } else { linear * (self.hardening * at.displacement * at.displacement + 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_pulls_back_to_the_middle_and_hardens() {
        let force = |hardening: f64, displacement: f64| {
            let at = Instant { time: 0.0, displacement, velocity: 0.0, sensed_velocity: 0.0, velocity_limit: 1.0 };
            Spring::new(&[20.0, hardening]).unwrap().force(&at, &[], &mut [])
        };
        assert!((force(0.0, 0.1) - 2.0).abs() < 1e-12);
        assert!((force(0.0, -0.1) + 2.0).abs() < 1e-12);
        assert!((force(50.0, 0.1) - 3.0).abs() < 1e-12);
    }
}
