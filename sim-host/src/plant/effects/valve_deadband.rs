//! Overlap of the spool's lands: commands smaller than it pass no flow.

use super::{Effect, Entry, Hooks, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "valve_deadband",
    equation: "dz(u, d) = u - clamp(u, -d, d)",
    stage: Stage::Valve,
    parameters: &[Parameter { key: "half_width", unit: "unit of u", rigid_unit: "unit of u", meaning: "half width of the overlap", yardstick: Yardstick::Command, low: 1e-3, high: 5.0, starts: &[0.01, 0.2, 1.0], positive: true, role: Role::Shared }],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "small commands do nothing: flats at each reversal, growing with smaller motion",
    mistaken_for: &["coulomb_friction", "backlash"],
    test: "pressure difference; supply pressure or payload changed; amplitude ladder",
};

/// Overlap of the spool's lands.
#[derive(Debug, Clone)]
pub struct ValveDeadband<S> {
    half_width: S,
}

impl<S: Scalar> ValveDeadband<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[half_width] = parameters else { return None };
        Some(Self { half_width })
    }
}

impl<S: Scalar> Effect<S> for ValveDeadband<S> {
    fn hooks(&self) -> Hooks {
        Hooks { valve: true, ..Hooks::default() }
    }
    fn valve(&self, u: S, _y: &[S], _dy: &mut [S]) -> S {
        u - u.clamp(-self.half_width, self.half_width)
    }
}
