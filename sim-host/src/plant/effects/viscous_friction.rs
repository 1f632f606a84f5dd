//! Friction in proportion to velocity.

use super::{Effect, Entry, Hooks, Instant, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "viscous_friction",
    equation: "f = c v",
    stage: Stage::Table,
    parameters: &[Parameter {
        key: "coefficient",
        unit: "1/s",
        rigid_unit: "N s/m",
        meaning: "friction per velocity and table mass",
        yardstick: Yardstick::Force,
        low: 1e-4,
        high: 100.0,
        starts: &[0.05, 1.0],
        positive: true,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a force that grows with speed",
    mistaken_for: &["leakage", "gain_drift"],
    test: "pressure at several constant velocities",
};

/// Friction in proportion to velocity.
#[derive(Debug, Clone)]
pub struct ViscousFriction<S> {
    coefficient: S,
}

impl<S: Scalar> ViscousFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[coefficient] = parameters else { return None };
        Some(Self { coefficient })
    }
}

impl<S: Scalar> Effect<S> for ViscousFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, linear: true, ..Hooks::default() }
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        self.coefficient * at.velocity
    }
}
