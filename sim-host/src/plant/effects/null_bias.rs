//! A constant added to the command: the valve's null is not at zero, or a force pulls one way.
//!
//! For a rigid mass the offset is a force in newtons beside the command's.

use super::{Effect, Ends, Entry, Hooks, Order, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "null_bias",
    equation: "u + b",
    stage: Stage::Command,
    parameters: &[Parameter {
        key: "offset",
        unit: "unit of u",
        rigid_unit: "N",
        meaning: "constant added to the command",
        yardstick: Yardstick::Command,
        low: -1e4,
        high: 1e4,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a constant push: a slow creep at zero command, an offset in the effort",
    mistaken_for: &["asymmetric_limit", "tilt_coupling"],
    test: "zero command for a minute; the same motion at two amplitudes",
    order: Order::Fourth,
    counter: Some(|parameters, countered| {
        if let &[offset] = parameters {
            countered.null_bias = offset;
        }
    }),
};

/// A constant added to the command.
#[derive(Debug, Clone)]
pub struct NullBias<S> {
    offset: S,
}

impl<S: Scalar> NullBias<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[offset] = parameters else { return None };
        Some(Self { offset })
    }
}

impl<S: Scalar> Effect<S> for NullBias<S> {
    fn hooks(&self) -> Hooks {
        Hooks { command: true, linear: true, ..Hooks::default() }
    }
    fn command(&mut self, u: S, _h: f64) -> S {
        u + self.offset
    }
}
