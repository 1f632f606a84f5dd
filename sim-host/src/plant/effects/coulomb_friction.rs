//! Dry friction of the bearings: one size, against the motion.
//! 
//! The sign is smoothed over [`SLIP`], far below the speeds of any test, so that the equations stay integrable.

use super::{Effect, Entry, Hooks, Instant, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "coulomb_friction",
    equation: "f = Fc tanh(v/v0)",
    stage: Stage::Table,
    parameters: &[Parameter { key: "force", unit: "m/s2", rigid_unit: "N", meaning: "friction force per table mass", yardstick: Yardstick::Force, low: 1e-4, high: 4.0, starts: &[0.005, 0.1, 0.6], positive: true, role: Role::Shared }],
    kinds: &[Kind::Servo, Kind::RigidMass, Kind::ForceBalance],
    frees: &[],
    signature: "a step in effort at every reversal, the same size at all speeds",
    mistaken_for: &["valve_deadband", "stribeck_friction", "backlash"],
    test: "pressure difference; supply pressure or payload changed; amplitude ladder",
};

/// Speed over which the sign of the velocity is smoothed, m/s.
pub(super) const SLIP: f64 = 1e-3;

/// Dry friction.
#[derive(Debug, Clone)]
pub struct CoulombFriction<S> {
    force: S,
}

impl<S: Scalar> CoulombFriction<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[force] = parameters else { return None };
        Some(Self { force })
    }
}

impl<S: Scalar> Effect<S> for CoulombFriction<S> {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        (self.force.value() / SLIP).abs()
    }
    fn force(&self, at: &Instant<S>, _y: &[S], _dy: &mut [S]) -> S {
        self.force * (at.velocity / SLIP).tanh()
    }
}
