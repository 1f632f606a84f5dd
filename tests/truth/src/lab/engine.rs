//! A run: the controller at its samples, the plant between them, the sensors at theirs. Conventions are those of the file
//! formats: the command acts from `t_k` to `t_k+1`; acceleration is the mean over a sample about `t_k`; velocity is taken after
//! the command's update; runs start at rest at `reference[0]`.

use super::law::Now;
use super::plant::{IMPULSE, Motion, Plant, State, X};
use super::setup::sensing::{Sensing, Sensor};
use super::stated::{Loop, Run};
use crate::closed_loop::Traces;
use crate::rng::Stream;
use std::collections::VecDeque;

/// Longest integration step (s).
const LONGEST: f64 = 1e-3;
/// Steps a time constant of the fastest law.
const STEPS: f64 = 2.5;

/// Simulates one run. Without `sensor` the traces are those of perfect sensors. None where the loop runs away.
pub fn simulate(plant: &Plant, run: &Run, sensor: Option<&Sensor>) -> Option<Traces> {
    let mut control = Loop::new(run.controller, run.dt);
    course(plant, run, sensor, |k, measured| control.step(run.reference[k], measured))
}

/// What perfect sensors give of a plant that is sent `commands` whatever it does, one a sample. None where it runs away.
pub fn replay(plant: &Plant, run: &Run, commands: &[f64]) -> Option<Traces> {
    course(plant, run, None, |k, _| commands.get(k).copied().unwrap_or_default())
}

/// One run under the commands that `command` gives from the sample's number and the displacement as measured (m).
fn course(
    plant: &Plant,
    run: &Run,
    sensor: Option<&Sensor>,
    mut command: impl FnMut(usize, f64) -> f64,
) -> Option<Traces> {
    let mut sim = Simulation::new(plant, run);
    let mut sensing = sensor.map(|s| Sensing::start(s, run.number, run.dt));
    let runaway = 4.0 * run.reference.iter().fold(0.05_f64, |m, x| m.max(x.abs()));
    let mut out = Traces::default();
    let mut before = sim.half_sample();
    for (k, &reference) in run.reference.iter().enumerate() {
        let t = k as f64 * run.dt;
        sim.now.t = t;
        sim.now.reference = reference;
        let clean = plant.displacement(&sim.now, &sim.y, &sim.m);
        let measured = sensing.as_mut().map_or(clean, |s| s.displacement(clean, sim.now.v));
        let command = command(k, measured);
        sim.send(t, command);
        let moving = sim.motion();
        let supply = plant.supply(&sim.y);
        let at = Now { x: sim.y[X], v: moving.actuator, ..sim.now };
        sim.advance(t, t + 0.5 * run.dt);
        let after = sim.half_sample();
        let mean = |i: usize| (after[i] - before[i]) / run.dt;
        let acceleration = plant.acceleration(&at, mean(0), &sim.y, &sim.m);
        out.displacement.push(measured);
        out.acceleration.push(sensing.as_mut().map_or(acceleration, |s| s.acceleration(acceleration)));
        out.command.push(command);
        out.velocity.push(moving.actuator);
        out.pressure.push(mean(1) + mean(2));
        out.supply.push(supply);
        before = after;
        sim.advance(t + 0.5 * run.dt, t + run.dt);
        if !sim.y[X].is_finite() || sim.y[X].abs() > runaway {
            return None;
        }
    }
    Some(out)
}

struct Simulation<'a> {
    plant: &'a Plant,
    now: Now,
    y: State,
    m: State,
    pending: VecDeque<(f64, f64)>,
    longest: f64,
    chance: Stream,
}

impl<'a> Simulation<'a> {
    fn new(plant: &'a Plant, run: &Run) -> Self {
        let start = run.reference.first().copied().unwrap_or(0.0);
        let (y, m) = plant.at_rest(start);
        Self {
            plant,
            now: Now { run: run.number, x: start, reference: start, ..Now::default() },
            y,
            m,
            pending: VecDeque::new(),
            longest: LONGEST.min(1.0 / (STEPS * plant.fastest())),
            chance: Stream::new(0x6c61_7465, run.number, run.reference.len() as u64),
        }
    }

    fn motion(&self) -> Motion {
        self.plant.motion(&self.now, &self.y, &self.m)
    }

    /// Sensed velocity, actuator velocity and impulse: what means over a sample are differences of.
    fn half_sample(&self) -> [f64; 3] {
        let motion = self.motion();
        [motion.sensed, motion.actuator, self.y[IMPULSE]]
    }

    fn send(&mut self, t: f64, command: f64) {
        let (delay, scatter) = self.plant.delay;
        if delay > 0.0 {
            let late = delay * (1.0 + scatter * (self.chance.unit() - 0.5));
            let last = self.pending.back().map_or(0.0, |p| p.0);
            self.pending.push_back(((t + late).max(last), command));
        } else {
            self.now.command = command;
        }
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
            self.now.command = command;
            self.pending.pop_front();
        }
        self.stretch(t, to);
    }

    fn stretch(&mut self, from: f64, to: f64) {
        let steps = ((to - from) / self.longest).ceil().max(1.0);
        let h = (to - from) / steps;
        for i in 0..steps as usize {
            self.now.t = from + i as f64 * h;
            self.step(h);
        }
        self.now.t = to;
    }

    /// Runge and Kutta's fourth-order step between two half updates of the memories.
    fn step(&mut self, h: f64) {
        let (plant, n) = (self.plant, self.plant.used());
        let mut k = [[0.0; super::plant::MOST]; 4];
        let mut seen = plant.rates(&self.now, &self.y, &self.m, &mut k[0]);
        if plant.remembers() {
            plant.remember(&seen, 0.5 * h, &self.y, &mut self.m);
            seen = plant.rates(&self.now, &self.y, &self.m, &mut k[0]);
        }
        let mut trial = self.y;
        for (stage, share) in [(1, 0.5), (2, 0.5), (3, 1.0)] {
            for i in 0..n {
                trial[i] = self.y[i] + share * h * k[stage - 1][i];
            }
            let now = Now { t: self.now.t + share * h, ..seen };
            let (_, later) = k.split_at_mut(stage);
            plant.rates(&now, &trial, &self.m, &mut later[0]);
        }
        for (i, value) in self.y.iter_mut().enumerate().take(n) {
            *value += h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
        }
        self.now = Now { t: self.now.t + h, ..seen };
        if plant.remembers() {
            let mut last = [0.0; super::plant::MOST];
            seen = plant.rates(&self.now, &self.y, &self.m, &mut last);
            plant.remember(&seen, 0.5 * h, &self.y, &mut self.m);
            self.now = seen;
        } else {
            self.now.x = self.y[X];
        }
    }
}
