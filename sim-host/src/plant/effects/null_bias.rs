//! A constant added to the command: the valve's null is not at zero, or a force pulls one way.
//!
//! For a rigid mass the offset is a force in newtons beside the command's.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "null_bias",
    equation: "u + b + r t",
    stage: Stage::Command,
    family: Family::Command,
    parameters: &[OFFSET, WARMING],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "a constant push: a slow creep at zero command, an offset in the effort",
    mistaken_for: &["asymmetric_limit", "tilt_coupling"],
    test: "zero command for a minute; the same motion at two amplitudes",
    order: Order::Fourth,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[offset, ..] = parameters {
            countered.null_bias = offset;
        }
    }),
};

const OFFSET: Parameter = Parameter {
    key: "offset",
    unit: "unit of u",
    rigid_unit: "N",
    meaning: "added to the command at the start of each run",
    signal_scale: SignalScale::Command,
    low: -1e4,
    high: 1e4,
    starts: &[0.0],
    positive: false,
    simple: Ends::Neither,
    role: Role::Shared,
};

/// Torque motors shift their null as they warm.
const WARMING: Parameter = Parameter {
    key: "warming",
    unit: "unit of u per s",
    rigid_unit: "N/s",
    meaning: "what is added to the offset per second of a run: r",
    role: Role::Refined,
    ..OFFSET
};

/// An offset of the command.
#[derive(Debug, Clone)]
pub(crate) struct NullBias<S> {
    offset: S,
    warming: S,
    /// Time from the start of the run, s.
    time: f64,
}

impl<S: Scalar> NullBias<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[offset, warming] = parameters else { return None };
        Some(Self { offset, warming, time: 0.0 })
    }
}

impl<S: Scalar> Effect<S> for NullBias<S> {
    fn hooks(&self) -> Hooks {
        Hooks { command: true, after: true, linear: true, ..Hooks::default() }
    }
    fn command(&mut self, u: S, h: f64) -> S {
        u + self.offset + self.warming * (self.time + 0.5 * h)
    }
    fn after(&mut self, _displacement: S, time: f64) {
        self.time = time;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The offset grows from the start of the run, by its mean over each step.
    #[test]
    fn a_bias_that_warms_grows_with_time() {
        let mut bias = NullBias::<f64>::new(&[0.02, 0.001]).unwrap();
        assert!((bias.command(0.1, 0.01) - 0.120_005).abs() < 1e-12);
        bias.after(0.0, 10.0);
        assert!((bias.command(0.1, 0.01) - 0.130_005).abs() < 1e-12);
    }
}
