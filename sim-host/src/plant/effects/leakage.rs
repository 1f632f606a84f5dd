//! Oil leaks past the piston in proportion to load pressure.

use super::{Compliance, Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "leakage",
    equation: "q/A - C (A p_L/m)",
    stage: Stage::Actuator,
    family: Family::OilColumn,
    parameters: &[Parameter {
        key: "coefficient",
        unit: "s",
        rigid_unit: "s",
        meaning: "velocity lost per load acceleration A p_L/m",
        signal_scale: SignalScale::One,
        low: 1e-5,
        high: 0.2,
        starts: &[3e-4, 0.005],
        positive: true,
        simple: Ends::Low,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "velocity sags while force is needed; creep under a held load",
    mistaken_for: &["viscous_friction", "load_dependent_flow", "valve_lag", "command_delay"],
    test: "pressure at constant velocity; a loaded hold",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

/// Leakage past the piston.
#[derive(Debug, Clone)]
pub(crate) struct Leakage<S> {
    coefficient: S,
}

impl<S: Scalar> Leakage<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[coefficient] = parameters else { return None };
        Some(Self { coefficient })
    }
}

impl<S: Scalar> Effect<S> for Leakage<S> {
    fn hooks(&self) -> Hooks {
        Hooks { linear: true, ..Hooks::default() }
    }
    fn yields(&self, compliance: &mut Compliance<S>) {
        compliance.leakage = Some(self.coefficient);
    }
}
