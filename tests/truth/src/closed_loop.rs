//! A run: the controller at its samples, the plant between them, the sensors at theirs.
//!
//! Conventions of the recordings: displacement and reference at `t_k`; the controller then, its command held from `t_k`
//! to `t_k+1`; `acceleration[k] = (v(t_k + dt/2) - v(t_k - dt/2))/dt`; `velocity[k]` after the command's update; start at
//! rest at `reference[0]`.

use crate::noise::Noise;
use crate::ode::{Integrator, State};
use crate::plant::state as at;
use crate::plant::{Held, Physics};
use crate::rng::Stream;
use std::collections::VecDeque;

/// The loop that ran: plain, with no limits and no anti-windup.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Controller {
    /// `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`.
    Pi {
        /// Proportional gain.
        kp: f64,
        /// Integral gain (1/s).
        ki: f64,
    },
    /// `u[k] = kv (kp e[k] - velocity)`, velocity the backward difference of the measured displacement.
    Cascade {
        /// Position gain (1/s).
        kp: f64,
        /// Velocity gain (unit of command per m/s).
        kv: f64,
    },
}

/// What is asked of the table in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Reference displacement (m), one value a sample.
    pub reference: Vec<f64>,
    /// Sample interval (s).
    pub dt: f64,
    /// The loop.
    pub controller: Controller,
    /// Number of the run within its case: phases of the mains and of chance events differ by it.
    pub number: u64,
}

/// What the sensors gave, one value a sample, SI.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Traces {
    /// Displacement (m).
    pub displacement: Vec<f64>,
    /// Acceleration (m/s2).
    pub acceleration: Vec<f64>,
    /// Command that the controller sent.
    pub command: Vec<f64>,
    /// Velocity (m/s).
    pub velocity: Vec<f64>,
    /// Pressure difference times area over table mass, mean over a sample (m/s2).
    pub pressure: Vec<f64>,
    /// Supply pressure over its start (1).
    pub supply: Vec<f64>,
}

/// The controller with its memory.
#[derive(Debug, Clone)]
pub struct Loop {
    law: Controller,
    sum: f64,
    before: Option<f64>,
}

impl Loop {
    /// At rest.
    pub fn new(law: Controller) -> Self {
        Self { law, sum: 0.0, before: None }
    }

    /// One sample: the command from reference and displacement as measured (m).
    pub fn step(&mut self, reference: f64, measured: f64, dt: f64) -> f64 {
        let error = reference - measured;
        match self.law {
            Controller::Pi { kp, ki } => {
                self.sum += error;
                kp * error + ki * dt * self.sum
            }
            Controller::Cascade { kp, kv } => {
                let velocity = (measured - self.before.replace(measured).unwrap_or(measured)) / dt;
                kv * (kp * error - velocity)
            }
        }
    }
}

/// Motion beyond this (m) is no test any more: the loop was not stable.
const RUNAWAY: f64 = 0.5;
/// Relative tolerance of the integration.
const TOLERANCE: f64 = 1e-6;

/// Simulates one run. `noise` absent gives what perfect sensors of the same kind would. `None` where the loop runs away.
pub fn simulate(physics: &Physics, run: &Run, noise: Option<&Noise>) -> Option<Traces> {
    let mut sim = Simulation::new(physics, run);
    let mut sensing = noise.map(|n| n.start(run.number));
    let count = run.reference.len();
    let mut out = Traces::default();
    let mut before = sim.half_sample(-0.5 * run.dt);
    for (k, &reference) in run.reference.iter().enumerate() {
        let t = k as f64 * run.dt;
        let clean = physics.sensors.displacement(&sim.y);
        let measured = sensing.as_mut().map_or(clean, |s| s.displacement(clean));
        let command = sim.control.step(reference, measured, run.dt);
        sim.send(t, command);
        let moving = physics.motion(t, &sim.y, &sim.held);
        let (x, supply) = (sim.y[at::X], sim.y[at::SUPPLY]);
        sim.advance(t, t + 0.5 * run.dt);
        let after = sim.half_sample(t + 0.5 * run.dt);
        let mean = |i: usize| (after[i] - before[i]) / run.dt;
        let mut acceleration = physics.sensors.acceleration(mean(0), x, t, sim.phase);
        acceleration *= sim.contact(k);
        out.displacement.push(measured);
        out.acceleration.push(sensing.as_mut().map_or(acceleration, |s| s.acceleration(acceleration, t)));
        out.command.push(command);
        out.velocity.push(moving.actuator);
        out.pressure.push(mean(1) + mean(2));
        out.supply.push(supply);
        before = after;
        if k + 1 < count {
            sim.advance(t + 0.5 * run.dt, t + run.dt);
        }
        sim.reversal();
        if !sim.y[at::X].is_finite() || sim.y[at::X].abs() > RUNAWAY {
            return None;
        }
    }
    Some(out)
}

struct Simulation<'a> {
    physics: &'a Physics,
    control: Loop,
    integrator: Integrator,
    y: State,
    held: Held,
    pending: VecDeque<(f64, f64)>,
    plays: [f64; 3],
    phase: f64,
    chance: Stream,
    direction: f64,
    loose_until: usize,
}

impl<'a> Simulation<'a> {
    fn new(physics: &'a Physics, run: &Run) -> Self {
        let mut chance = Stream::new(0x7275_6e73, run.number, run.reference.len() as u64);
        Self {
            physics,
            control: Loop::new(run.controller),
            integrator: Integrator::new(TOLERANCE, Physics::tolerance()),
            y: physics.at_rest(run.reference.first().copied().unwrap_or(0.0)),
            held: Held { command: 0.0, breakaway: 1.0 },
            pending: VecDeque::new(),
            plays: [0.0; 3],
            phase: chance.uniform(0.0, std::f64::consts::TAU),
            chance,
            direction: 0.0,
            loose_until: 0,
        }
    }

    /// Sensed velocity, actuator velocity and impulse: what means over a sample are differences of.
    fn half_sample(&self, t: f64) -> [f64; 3] {
        let motion = self.physics.motion(t, &self.y, &self.held);
        [motion.sensed, motion.actuator, self.y[at::IMPULSE]]
    }

    fn send(&mut self, t: f64, command: f64) {
        let delay = self.physics.command.delay;
        if delay > 0.0 {
            self.pending.push_back((t + delay, command));
        } else {
            self.apply(command);
        }
    }

    fn apply(&mut self, command: f64) {
        self.held.command = match &self.physics.command.hysteresis {
            Some(iron) => iron.pass(command, &mut self.plays),
            None => command,
        };
    }

    /// Integrates between two instants, stopping where a delayed command arrives.
    fn advance(&mut self, from: f64, to: f64) {
        let mut t = from;
        while let Some(&(arrives, command)) = self.pending.front() {
            if arrives > to {
                break;
            }
            if arrives > t {
                self.stretch(t, arrives);
                t = arrives;
            }
            self.apply(command);
            self.pending.pop_front();
        }
        self.stretch(t, to);
    }

    fn stretch(&mut self, from: f64, to: f64) {
        let (physics, held) = (self.physics, self.held);
        let f = |t: f64, y: &State, dy: &mut State| physics.derivative(t, y, &held, dy);
        self.integrator.advance(&f, from, to, &mut self.y);
    }

    /// Draws a new break-away level where the motion turns, if chance decides it.
    fn reversal(&mut self) {
        let Some(spread) = self.physics.table.breakaway_spread else { return };
        let direction = self.y[at::Z].signum();
        if direction != self.direction {
            self.direction = direction;
            self.held.breakaway = 1.0 + spread * self.chance.unit();
        }
    }

    /// What a loose connection lets through at sample `k`.
    fn contact(&mut self, k: usize) -> f64 {
        let lost = self.physics.sensors.loose;
        if lost == 0.0 {
            return 1.0;
        }
        if k >= self.loose_until && self.chance.chance(0.002) {
            self.loose_until = k + 5 + self.chance.below(80);
        }
        if k < self.loose_until { 1.0 - lost } else { 1.0 }
    }
}
