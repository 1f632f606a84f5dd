//! The gain changes as the oil warms.

use super::{Effect, Ends, Entry, Family, Flow, Hooks, Instant, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "gain_drift",
    equation: "b0 (1 + k T (1 - exp(-t/T)))",
    stage: Stage::Flow,
    family: Family::Flow,
    parameters: &[RATE, SETTLING],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "the same motion tracks differently early and late in a run",
    mistaken_for: &["supply_droop", "viscous_friction"],
    test: "randomised repeats of one short motion",
    order: Order::Fourth,
    contains: &[],
    counter: None,
};

const RATE: Parameter = Parameter {
    key: "rate",
    unit: "1/s",
    rigid_unit: "1/s",
    meaning: "relative change of gain per second at the start of a run: k",
    signal_scale: SignalScale::One,
    low: -0.05,
    high: 0.05,
    starts: &[0.0],
    positive: false,
    simple: Ends::Neither,
    role: Role::Shared,
};

/// Oil that comes to its temperature changes no more.
const SETTLING: Parameter = Parameter {
    key: "settling",
    unit: "s",
    rigid_unit: "s",
    meaning: "time constant with which the change comes to its end, from 10 000 on none: T",
    low: 2.0,
    high: NEVER,
    starts: &[NEVER],
    positive: true,
    simple: Ends::High,
    role: Role::Refined,
    ..RATE
};

/// From here on the change goes on, s.
const NEVER: f64 = 1e4;

/// A gain that changes with time.
#[derive(Debug, Clone)]
pub(crate) struct GainDrift<S> {
    rate: S,
    settling: Option<S>,
}

impl<S: Scalar> GainDrift<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[rate, settling] = parameters else { return None };
        Some(Self { rate, settling: Some(settling).filter(|settling| settling.value() < NEVER) })
    }
}

impl<S: Scalar> Effect<S> for GainDrift<S> {
    fn hooks(&self) -> Hooks {
        Hooks { flow: true, ..Hooks::default() }
    }
    fn flow(&self, at: &Instant<S>, _y: &[S], flow: &mut Flow<S>) {
        let time = self.settling.map_or(S::from(at.time), |settling| {
            let passed = -(S::from(at.time) / settling);
            settling * (-passed.exp() + 1.0)
        });
        flow.gain = flow.gain * (self.rate * time + 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gain(settling: f64, time: f64) -> f64 {
        let drift = GainDrift::<f64>::new(&[0.01, settling]).unwrap();
        let at = Instant { time, displacement: 0.0, velocity: 0.0, sensed_velocity: 0.0, velocity_limit: 1.0 };
        let mut flow = Flow { gain: 1.0, limit: 1.0, positive: 1.0, negative: 1.0, sharpness: None };
        drift.flow(&at, &[], &mut flow);
        flow.gain
    }

    /// A line where it never settles, and where it does the same line at first and an end.
    #[test]
    fn a_gain_drifts_in_a_line_or_to_an_end() {
        assert!((gain(NEVER, 30.0) - 1.3).abs() < 1e-12);
        assert!((gain(5.0, 1e-3) - 1.0 - 1e-5).abs() < 1e-8);
        assert!((gain(5.0, 200.0) - 1.05).abs() < 1e-12);
    }
}
