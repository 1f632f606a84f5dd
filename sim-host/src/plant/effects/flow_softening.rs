//! The orifice softens the velocity limit: flow bends over before it reaches it.
//!
//! What bends it may have a limit of its own beyond the one that holds it: a line in series with the valve takes a share of the
//! pressure that grows with the square of the flow (n = 2), long before spool or pump end it.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "flow_softening",
    equation: "w / (1 + abs(w/(k v_max))^n)^(1/n), at most v_max",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[SHARPNESS, KNEE],
    kinds: &[Kind::Servo],
    frees: &["velocity_limit"],
    signature: "gain falls well below the velocity limit; odd harmonics",
    mistaken_for: &["load_dependent_flow", "supply_droop", "asymmetric_limit"],
    test: "velocity ladder from 50 to 110 % of the limit",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        // The law inverts a flow that bends towards its limit, not one that is cut off.
        if let &[sharpness, knee] = parameters
            && knee <= TOGETHER
        {
            countered.sharpness = sharpness;
        }
    }),
};

/// Share by which the flow's own limit may lie beyond the velocity limit and be one with it.
const TOGETHER: f64 = 1.05;

const SHARPNESS: Parameter = Parameter {
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
};

const KNEE: Parameter = Parameter {
    key: "knee",
    meaning: "limit towards which the flow bends, over the velocity limit: k",
    low: 1.0,
    high: 20.0,
    starts: &[1.0],
    simple: Ends::Low,
    role: Role::Refined,
    ..SHARPNESS
};

/// A softened velocity limit.
#[derive(Debug, Clone)]
pub(crate) struct FlowSoftening<S> {
    sharpness: S,
    knee: S,
}

impl<S: Scalar> FlowSoftening<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[sharpness, knee] = parameters else { return None };
        Some(Self { sharpness, knee })
    }
}

impl<S: Scalar> Effect<S> for FlowSoftening<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, ..Hooks::default() }
    }
    fn flow(&self, _at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        flow.sharpness = Some(self.sharpness);
        flow.knee = self.knee;
    }
}

#[cfg(test)]
mod tests {
    use crate::plant::model::Baseline;
    use crate::plant::simulate::EffectParameters;
    use crate::plant::{Plant as _, stepped::Stepped};

    /// A line in series with the valve bends the flow as its own limit says, and the velocity limit cuts it off.
    #[test]
    fn a_flow_bends_towards_its_own_limit_and_is_cut_off_at_the_other() {
        let table = Baseline::Servo { b1: 0.0, b0: 138.0, a1: 60.0, velocity_limit: 0.25 };
        let at_rest = |command: f64, knee: f64| {
            let parameters = vec![2.0, knee];
            let placed = EffectParameters { id: super::ENTRY.id, parameters };
            let mut plant = Stepped::new(&table, &[placed], 5e-4, 0.0).unwrap();
            plant.advance(command, 1000);
            plant.velocity(command)
        };
        for (command, knee) in [(0.05f64, 1.0), (0.05, 2.0), (0.1, 2.0)] {
            let asked = 2.3 * command;
            let bent = asked / (1.0 + (asked / (knee * 0.25)).powi(2)).sqrt();
            assert!((at_rest(command, knee) - bent).abs() < 1e-4, "{command}, {knee}: {}", at_rest(command, knee));
        }
        assert!((at_rest(0.4, 2.0) - 0.25).abs() < 1e-9);
        assert!(at_rest(0.4, 1.0) < 0.245);
    }
}
