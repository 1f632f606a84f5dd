//! Load pressure takes its share of the supply: less is left to drive flow through the valve.

use super::stiff_oil::{DAMPING, OIL, beneath};
use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "load_dependent_flow",
    equation: "w sqrt(1 - sgn(w) p_L/p_s), A p_L = m a + F",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[
        Parameter {
            key: "stall_acceleration",
            unit: "m/s2",
            rigid_unit: "m/s2",
            meaning: "load acceleration A p_s / m at which the flow stalls",
            signal_scale: SignalScale::One,
            low: 0.1,
            high: 500.0,
            starts: &[60.0, 10.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
        OIL,
        DAMPING,
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "less speed while accelerating, more while braking",
    mistaken_for: &["flow_softening", "oil_compliance", "leakage"],
    test: "the same motion with mass added; pressure difference",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[stall, ..] = parameters {
            countered.stall = stall;
        }
    }),
};

/// Flow that falls with load.
#[derive(Debug, Clone)]
pub(crate) struct LoadDependentFlow<S> {
    stall_acceleration: S,
    oil: (S, S),
}

impl<S: Scalar> LoadDependentFlow<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[stall_acceleration, frequency, damping] = parameters else { return None };
        Some(Self { stall_acceleration, oil: (frequency, damping) })
    }
}

impl<S: Scalar> Effect<S> for LoadDependentFlow<S> {
    fn hooks(&self) -> Hooks {
        Hooks::default()
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.stall_acceleration = Some(self.stall_acceleration);
        beneath(self.oil.0, self.oil.1, compliance);
    }
}
