//! Friction that grows with velocity.
//!
//! A film of oil is sheared in proportion to the speed until the shear itself warms and thins it: the coefficient falls as
//! speed rises.

use super::{Effect, Ends, Entry, Family, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "viscous_friction",
    equation: "f = c v / (1 + k abs(v))",
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

/// Friction that grows with velocity.
#[derive(Debug, Clone)]
pub(crate) struct ViscousFriction<S> {
    coefficient: S,
    thinning: S,
    /// Nothing thins the film, and no derivative asks what if.
    plain: bool,
}

impl<S: Scalar> ViscousFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[coefficient, thinning] = parameters else { return None };
        let plain = (0..S::PARTS).all(|i| thinning.part(i) == 0.0);
        Some(Self { coefficient, thinning, plain })
    }
}

impl<S: Scalar> Effect<S> for ViscousFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, linear: self.plain, ..Hooks::default() }
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        let newtonian = self.coefficient * at.velocity;
        if self.plain { newtonian } else { newtonian / (self.thinning * at.velocity.abs() + 1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speed_takes_its_share_on_both_sides() {
        let force = |thinning: f64, velocity: f64| {
            let at = Instant { time: 0.0, displacement: 0.0, velocity, sensed_velocity: 0.0, velocity_limit: 1.0 };
            ViscousFriction::new(&[10.0, thinning]).unwrap().force(&at, &[], &mut [])
        };
        assert!((force(0.0, 0.2) - 2.0).abs() < 1e-12);
        assert!((force(0.5, 0.2) - 2.0 / 1.1).abs() < 1e-12);
        assert!((force(0.5, -0.2) + 2.0 / 1.1).abs() < 1e-12);
    }
}
