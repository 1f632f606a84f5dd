//! Transport delay of the command, at any fraction of an integration step.
//!
//! The command is constant over a step; delayed, it switches inside one. Its mean over the step is linear in the delay,
//! so the delay has an exact derivative.

use super::{Effect, Ends, Entry, Family, Hooks, Order, Parameter, Role, Stage, SignalScale};
use crate::plant::model::Kind;
use crate::scalar::Scalar;
use std::collections::VecDeque;

/// What it is.
pub(crate) const ENTRY: Entry = Entry {
    id: "command_delay",
    equation: "u(t - tau)",
    stage: Stage::Command,
    family: Family::Command,
    parameters: &[Parameter {
        key: "time",
        unit: "s",
        rigid_unit: "s",
        meaning: "delay",
        signal_scale: SignalScale::One,
        low: 2e-4,
        high: 0.1,
        starts: &[0.001, 0.008, 0.03],
        positive: true,
        simple: Ends::Low,
        role: Role::Shared,
    }],
    kinds: &[Kind::Servo, Kind::RigidMass],
    frees: &[],
    signature: "phase that falls in proportion to frequency, no loss of amplitude",
    mistaken_for: &["valve_lag", "displacement_lag"],
    test: "sines of 20 Hz and up at small amplitude and high gain",
    order: Order::Second,
    contains: &[],
    counter: Some(|parameters, countered| {
        if let &[time] = parameters {
            countered.delay = time;
        }
    }),
};

/// Rate of steps short enough, 1/s: a command that arrives within a step acts as its mean over it, and too early or too late by a
/// share of the step looks like a lagging valve.
const ARRIVAL: f64 = 2000.0;

/// Transport delay of the command.
#[derive(Debug, Clone)]
pub(crate) struct CommandDelay<S> {
    time: S,
    past: VecDeque<S>,
    /// What was sent before all of it, unit of u.
    before: S,
}

impl<S: Scalar> CommandDelay<S> {
    /// Takes the parameters in the order of [`ENTRY`].
    pub(crate) fn new(parameters: &[S]) -> Option<Self> {
        let &[time] = parameters else { return None };
        Some(Self { time, past: VecDeque::new(), before: S::from(0.0) })
    }
}

impl<S: Scalar> Effect<S> for CommandDelay<S> {
    fn hooks(&self) -> Hooks {
        Hooks { command: true, linear: true, ..Hooks::default() }
    }
    fn fastest(&self) -> f64 {
        ARRIVAL
    }
    fn under_way(&mut self, command: S) {
        self.before = command;
    }
    fn command(&mut self, u: S, h: f64) -> S {
        let steps = self.time / h;
        let whole = steps.value().floor().max(0.0);
        let fraction = steps - whole;
        self.past.push_front(u);
        self.past.truncate((whole as usize).saturating_add(2));
        let newer = self.past.get(whole as usize).copied().unwrap_or(self.before);
        let older = self.past.get((whole as usize).saturating_add(1)).copied().unwrap_or(self.before);
        newer + (older - newer) * fraction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_arrives_later_by_any_share_of_a_step_or_not_at_all() {
        let arrived = |time: f64| {
            let mut delay = CommandDelay::new(&[time]).unwrap();
            [1.0, 2.0, 3.0].map(|u| delay.command(u, 0.5))
        };
        assert_eq!(arrived(0.0), [1.0, 2.0, 3.0]);
        assert_eq!(arrived(0.75), [0.0, 0.5, 1.5]);
        assert_eq!(arrived(1e300), [0.0; 3]);
    }

    #[test]
    fn what_was_sent_before_a_part_of_a_run_arrives_in_it() {
        let mut delay = CommandDelay::new(&[0.75]).unwrap();
        delay.under_way(4.0);
        assert_eq!([1.0, 2.0, 3.0].map(|u| delay.command(u, 0.5)), [4.0, 2.5, 1.5]);
    }
}
