//! The integration steps between one sample and the next, and the motion that the sample's sensors see of them.

use super::dynamics::{Dynamics, State};
use super::linear::Linear;
use super::{Excitation, Trace, Wanted};
use crate::plant::effects::Instant;
use crate::scalar::Scalar;

/// The way from one sample to the next.
#[derive(Debug)]
pub(super) struct Sample<S> {
    /// Integration steps in a controller tick.
    steps: usize,
    /// Integration steps in a sample.
    total: usize,
    /// Length of a step, s.
    h: f64,
    linear: Option<Linear<S>>,
    /// The spool's position in each step of a tick.
    spools: Vec<S>,
    /// Whether the motion at the sample itself is asked for, and the force there.
    asked: (bool, bool),
    /// Motion at the sample, and force per table mass there (m/s2), where they are asked for.
    start: Instant<S>,
    force: S,
    /// Sensed and true velocity in the middle of the sample before, m/s, and of this one; set one by one, since what is
    /// copied as a pair waits for what was written in parts.
    before: (S, S),
    middle: (S, S),
}

impl<S: Scalar> Sample<S> {
    /// From a state of rest; `matrices` lets linear stretches be taken by [`Linear`].
    pub(super) fn new(
        dynamics: &mut Dynamics<S>,
        rest: &State<S>,
        drive: &Excitation,
        steps: usize,
        matrices: bool,
    ) -> Self {
        let total = drive.ticks * steps;
        let h = drive.dt / total as f64;
        // What has memory of the displacement is told of every step.
        let span = if drive.ticks == 1 && !dynamics.any.after { total } else { 1 };
        let linear = if matrices { Linear::of(dynamics, rest, h, span) } else { None };
        let moves = drive.wanted.velocity || (drive.wanted.acceleration && dynamics.any.acceleration);
        let velocities = dynamics.velocities(rest);
        Self {
            steps,
            total,
            h,
            linear,
            spools: vec![S::from(0.0); steps],
            asked: (moves || drive.wanted.load, drive.wanted.load),
            start: dynamics.instant(rest),
            force: S::from(0.0),
            before: velocities,
            middle: velocities,
        }
    }

    /// Moves on by one controller tick, the `number`-th of its sample, under the command that the state holds.
    pub(super) fn tick(&mut self, dynamics: &mut Dynamics<S>, state: &mut State<S>, number: usize) {
        for spool in &mut self.spools {
            dynamics.begin_step(state, self.h);
            *spool = state.spool;
        }
        if let Some(linear) = &mut self.linear
            && linear.span() > 1
            && linear.holds(state, &self.spools)
        {
            state.spool = self.spools[0];
            note(dynamics, state, self.asked, (&mut self.start, &mut self.force));
            state.spool = self.spools[(self.total - 1) / 2];
            let middle = state.time + 0.5 * self.h * self.total as f64;
            linear.advance(state, &self.spools, self.h, true);
            (self.middle.0, self.middle.1) = dynamics.velocities_halfway(state, middle);
            return;
        }
        for i in 0..self.steps {
            // A single step finds the spool where it was just put.
            if self.steps > 1 {
                state.spool = self.spools[i];
            }
            self.step(dynamics, state, number, i);
        }
    }

    /// One integration step, the `i`-th of the `tick`-th tick of its sample.
    fn step(&mut self, dynamics: &mut Dynamics<S>, state: &mut State<S>, tick: usize, i: usize) {
        let number = tick * self.steps + i;
        let (halfway, middle) = (2 * number + 1 == self.total, state.time + 0.5 * self.h);
        let spool = &self.spools[i..=i];
        if let Some(linear) = &mut self.linear
            && linear.span() == 1
            && linear.holds(state, spool)
        {
            if number == 0 {
                note(dynamics, state, self.asked, (&mut self.start, &mut self.force));
            }
            linear.advance(state, spool, self.h, halfway);
        } else {
            dynamics.integrate(state, self.h, halfway);
            if number == 0 && self.asked.0 {
                self.start.become_of(&state.work.start.at);
                self.force = state.work.start.force;
            }
        }
        if halfway {
            (self.middle.0, self.middle.1) = dynamics.velocities_halfway(state, middle);
        }
        dynamics.settle(state);
        if 2 * (number + 1) == self.total {
            (self.middle.0, self.middle.1) = dynamics.velocities(state);
        }
    }

    /// What the sensors of motion show at this sample.
    pub(super) fn push(&mut self, dynamics: &Dynamics<S>, wanted: Wanted, dt: f64, trace: &mut Trace<S>) {
        if wanted.acceleration {
            let mean = dynamics.by_true_clock((self.middle.0 - self.before.0) / dt);
            let shows = dynamics.any.acceleration;
            trace.acceleration.push(if shows { dynamics.sense_acceleration(mean, &self.start) } else { mean });
        }
        if wanted.velocity {
            trace.velocity.push(self.start.velocity);
        }
        if wanted.load {
            trace.load.push(dynamics.by_true_clock((self.middle.1 - self.before.1) / dt) + self.force);
        }
        self.before = self.middle;
    }
}

/// Motion and force at the start of a step, where they are asked for.
fn note<S: Scalar>(
    dynamics: &Dynamics<S>,
    state: &mut State<S>,
    (motion, force): (bool, bool),
    (start, at_start): (&mut Instant<S>, &mut S),
) {
    if motion {
        dynamics.note(state, start);
    }
    if force {
        *at_start = dynamics.force_now(state);
    }
}
