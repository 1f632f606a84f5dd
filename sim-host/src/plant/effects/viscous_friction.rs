//! Friction that grows with velocity.
//!
//! A film of oil is sheared in proportion to the speed until the shear itself warms and thins it: the coefficient falls as
//! speed rises. What the work done leaves as heat in the film thins it too, for the rest of a run that is short beside its cooling.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "viscous_friction",
    equation: "f = c v / (1 + k abs(v)) / (1 + h int v^2 dt)",
    stage: Stage::Table,
    family: Family::Friction,
    parameters: &[
        Parameter {
            key: "coefficient",
            unit: "1/s",
            rigid_unit: "N s/m",
            meaning: "friction per velocity and table mass, at low speed",
            signal_scale: SignalScale::Force,
            low: 1e-4,
            high: 100.0,
            starts: &[0.05, 1.0],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "thinning",
            unit: "s/m",
            rigid_unit: "s/m",
            meaning: "what speed takes of the coefficient: k",
            signal_scale: SignalScale::One,
            low: -0.2,
            high: 30.0,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::Refined,
        },
        Parameter {
            key: "warming",
            unit: "s/m2",
            rigid_unit: "s/m2",
            meaning: "what the work done in a run takes of the coefficient, per integral of squared velocity: h",
            signal_scale: SignalScale::One,
            low: -0.02,
            high: 1e3,
            starts: &[0.0],
            positive: false,
            simple: Ends::Neither,
            role: Role::Refined,
        },
    ],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a force that grows with speed",
    mistaken_for: &["leakage", "gain_drift"],
    test: "pressure at several constant velocities",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[coefficient, ..] = parameters {
            countered.viscous = coefficient;
        }
    }),
};

/// Least that what warms the film may be divided by: a film that thickens with work done does so to this share's inverse.
const COLDEST: f64 = 0.1;

/// Friction that grows with velocity.
#[derive(Debug, Clone)]
pub(crate) struct ViscousFriction<S> {
    coefficient: S,
    thinning: S,
    warming: S,
    /// Nothing thins the film, and no derivative asks what if.
    plain: bool,
    /// The work done warms it, or a derivative asks what if.
    warms: bool,
}

impl<S: Scalar> ViscousFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[coefficient, thinning, warming] = parameters else { return None };
        let warms = !warming.is_nothing();
        Some(Self { coefficient, thinning, warming, plain: thinning.is_nothing() && !warms, warms })
    }
}

impl<S: Scalar> Effect<S> for ViscousFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, linear: self.plain, ..Hooks::default() }
    }
    fn states(&self) -> usize {
        usize::from(self.warms)
    }
    fn force(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) -> S {
        let newtonian = self.coefficient * at.velocity;
        if self.plain {
            return newtonian;
        }
        let thinned = newtonian / (self.thinning * at.velocity.abs() + 1.0);
        let (&[work], [rate]) = (y, dy) else { return thinned };
        *rate = at.velocity * at.velocity;
        thinned / (self.warming * work + 1.0).max(S::from(COLDEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_takes_its_share_on_both_sides() {
        let force = |thinning: f64, velocity: f64| {
            let at = Instant { time: 0.0, displacement: 0.0, velocity, sensed_velocity: 0.0, velocity_limit: 1.0 };
            ViscousFriction::new(&[10.0, thinning, 0.0]).unwrap().force(&at, &[], &mut [])
        };
        assert!((force(0.0, 0.2) - 2.0).abs() < 1e-12);
        assert!((force(0.5, 0.2) - 2.0 / 1.1).abs() < 1e-12);
        assert!((force(0.5, -0.2) + 2.0 / 1.1).abs() < 1e-12);
    }

    #[test]
    fn work_done_takes_its_share() {
        let at = Instant { time: 0.0, displacement: 0.0, velocity: 0.2, sensed_velocity: 0.0, velocity_limit: 1.0 };
        let film = ViscousFriction::new(&[10.0, 0.0, 3.0]).unwrap();
        let mut rate = [0.0];
        assert_eq!(film.states(), 1);
        assert!((film.force(&at, &[0.5], &mut rate) - 2.0 / 2.5).abs() < 1e-12);
        assert!((rate[0] - 0.04).abs() < 1e-12);
        assert_eq!(ViscousFriction::<f64>::new(&[10.0, 0.0, 0.0]).unwrap().states(), 0);
    }
}
