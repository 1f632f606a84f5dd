//! The gain changes as the oil warms.

use super::{Effect, Ends, Entry, Flow, Hooks, Instant, Order, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "gain_drift",
    equation: "b0 (1 + k t)",
    stage: Stage::Flow,
    parameters: &[Parameter {
        key: "rate",
        unit: "1/s",
        rigid_unit: "1/s",
        meaning: "relative change of gain per second",
        yardstick: Yardstick::One,
        low: -0.05,
        high: 0.05,
        starts: &[0.0],
        positive: false,
        simple: Ends::Neither,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "the same motion tracks differently early and late in a run",
    mistaken_for: &["supply_droop", "viscous_friction"],
    test: "randomised repeats of one short motion",
    order: Order::Fourth,
    counter: None,
};

/// A gain that changes with time.
#[derive(Debug, Clone)]
pub struct GainDrift<S> {
    rate: S,
}

impl<S: Scalar> GainDrift<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[rate] = parameters else { return None };
        Some(Self { rate })
    }
}

impl<S: Scalar> Effect<S> for GainDrift<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, ..Hooks::default() }
    }
    fn flow(&self, at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        flow.gain = flow.gain * (self.rate * at.time + 1.0);
    }
}
