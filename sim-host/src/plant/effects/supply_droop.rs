//! The accumulator empties under sustained flow and the pump refills it: pressure, and with its square root gain and
//! velocity limit, sag after long fast motion.
//!
//! The pressure is relative to its start; running at the limit for long it falls by `depth`.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "supply_droop",
    equation: "p' = (1 - p - D abs(v)/v_max)/T; gain and v_max times sqrt(p)",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[
        Parameter {
            key: "depth",
            unit: "1",
            rigid_unit: "1",
            meaning: "relative pressure lost under sustained motion at the velocity limit",
            signal_scale: SignalScale::One,
            low: 0.005,
            high: 0.95,
            starts: &[0.02, 0.3],
            positive: true,
            simple: Ends::Low,
            role: Role::Shared,
        },
        Parameter {
            key: "recovery",
            unit: "s",
            rigid_unit: "s",
            meaning: "time constant of the recovery",
            signal_scale: SignalScale::One,
            low: 0.05,
            high: 60.0,
            starts: &[0.4, 3.0],
            positive: true,
            simple: Ends::High,
            role: Role::Shared,
        },
    ],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "gain and limit sag after fast motion and recover in seconds",
    mistaken_for: &["gain_drift", "flow_softening", "load_dependent_flow"],
    test: "back-to-back ramps; supply pressure logged",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[depth, recovery] = parameters {
            countered.droop = (depth, recovery);
        }
    }),
};

/// An accumulator that empties.
#[derive(Debug, Clone)]
pub(crate) struct SupplyDroop<S> {
    depth: S,
    recovery: S,
}

impl<S: Scalar> SupplyDroop<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[depth, recovery] = parameters else { return None };
        Some(Self { depth, recovery })
    }
}

impl<S: Scalar> Effect<S> for SupplyDroop<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, follow: true, ..Hooks::default() }
    }
    fn states(&self) -> usize {
        1
    }
    fn rest(&self, _displacement: S, y: &mut [S]) {
        y.fill(S::from(1.0));
    }
    fn flow(&self, _at: &Instant<S>, y: &[S], flow: &mut Flow<S>) {
        if let Some(&pressure) = y.first() {
            let root = pressure.max(S::from(0.02)).sqrt();
            flow.gain = flow.gain * root;
            flow.limit = flow.limit * root;
        }
    }
    fn follow(&self, at: &Instant<S>, y: &[S], dy: &mut [S]) {
        if let (Some(&pressure), Some(rate)) = (y.first(), dy.first_mut()) {
            *rate = (-pressure + 1.0 - self.depth * at.velocity.abs() / at.velocity_limit) / self.recovery;
        }
    }
    fn supply_pressure(&self, y: &[S]) -> Option<S> {
        y.first().copied()
    }
}
