//! The orifice softens the velocity limit: flow bends over before it reaches it.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "flow_softening",
    equation: "w / (1 + abs(w/v_max)^n)^(1/n)",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[Parameter {
        key: "sharpness",
        unit: "1",
        rigid_unit: "1",
        meaning: "exponent n; the hard limit is n to infinity",
        signal_scale: SignalScale::One,
        low: 1.2,
        high: 40.0,
        starts: &[25.0, 8.0, 3.0],
        positive: true,
        simple: Ends::High,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo],
    frees: &["velocity_limit"],
    signature: "gain falls well below the velocity limit; odd harmonics",
    mistaken_for: &["load_dependent_flow", "supply_droop", "asymmetric_limit"],
    test: "velocity ladder from 50 to 110 % of the limit",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[sharpness] = parameters {
            countered.sharpness = sharpness;
        }
    }),
};

/// A softened velocity limit.
#[derive(Debug, Clone)]
pub(crate) struct FlowSoftening<S> {
    sharpness: S,
}

impl<S: Scalar> FlowSoftening<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[sharpness] = parameters else { return None };
        Some(Self { sharpness })
    }
}

impl<S: Scalar> Effect<S> for FlowSoftening<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, ..Hooks::default() }
    }
    fn flow(&self, _at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        flow.sharpness = Some(self.sharpness);
    }
}
