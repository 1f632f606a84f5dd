//! The spool cannot move faster than its pilot stage lets it.

use super::{Effect, Entry, Hooks, Parameter, Role, Stage, Yardstick};
use crate::plant::model::Kind;
use crate::scalar::Scalar;

/// What it is.
pub const ENTRY: Entry = Entry {
    id: "valve_rate_limit",
    equation: "abs(u') <= R",
    stage: Stage::Valve,
    parameters: &[Parameter {
        key: "rate",
        unit: "unit of u per s",
        rigid_unit: "unit of u per s",
        meaning: "fastest change of the command the spool follows",
        yardstick: Yardstick::CommandRate,
        low: 0.02,
        high: 50.0,
        starts: &[0.5, 1.2, 2.5, 5.0],
        positive: true,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo],
    frees: &[],
    signature: "large fast commands come out as ramps; small ones are untouched",
    mistaken_for: &["valve_lag", "command_delay"],
    test: "one frequency at growing amplitude",
};

/// A limit on the spool's speed.
#[derive(Debug, Clone)]
pub struct ValveRateLimit<S> {
    rate: S,
    spool: S,
}

impl<S: Scalar> ValveRateLimit<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub fn new(parameters: &[S]) -> Option<Self> {
        let &[rate] = parameters else { return None };
        Some(Self { rate, spool: S::from(0.0) })
    }
}

impl<S: Scalar> Effect<S> for ValveRateLimit<S> {
    fn hooks(&self) -> Hooks {
        Hooks { command: true, linear: true, ..Hooks::default() }
    }
    fn command(&mut self, u: S, h: f64) -> S {
        let reach = self.rate * h;
        let before = self.spool;
        self.spool = before + (u - before).clamp(-reach, reach);
        (before + self.spool) * 0.5
    }
}
