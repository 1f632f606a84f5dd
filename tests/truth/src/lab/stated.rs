//! The model as an experiment states it, solved exactly from sample to sample, in the loop that ran: what strengths are
//! measured against, and what the refit moves.

use super::setup::sensing::{Sensing, Sensor};
use crate::baseline::Stretch;
use crate::plant::Machine;

/// The law of a controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// `kp e[k] + ki dt (e[0] + ... + e[k])`.
    Pi {
        /// Proportional gain.
        kp: f64,
        /// Integral gain (1/s).
        ki: f64,
    },
    /// `kv (kp e[k] - velocity)`, velocity the backward difference of the measured displacement.
    Cascade {
        /// Position gain (1/s).
        kp: f64,
        /// Velocity gain (command per m/s).
        kv: f64,
    },
}

/// A controller as the file formats have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller {
    /// Law.
    pub kind: Kind,
    /// Command per backward difference of the reference over the sample interval (command per m/s); 0 for none.
    pub kvf: f64,
    /// Notch in the command: frequency (Hz), damping (1), depth (gain at the centre, 1).
    pub notch: Option<[f64; 3]>,
    /// Samples by which the controller reads its displacement late: what the stated law leaves out.
    pub late: usize,
}

impl Controller {
    /// A plain law.
    pub fn plain(kind: Kind) -> Self {
        Self { kind, kvf: 0.0, notch: None, late: 0 }
    }
}

/// A controller with its memory.
#[derive(Debug, Clone)]
pub struct Loop {
    law: Controller,
    dt: f64,
    sum: f64,
    measured: Option<f64>,
    reference: Option<f64>,
    waiting: std::collections::VecDeque<f64>,
    notch: Option<Notch>,
}

impl Loop {
    /// At rest; `dt` in s.
    pub fn new(law: Controller, dt: f64) -> Self {
        let notch = law.notch.map(|n| Notch::new(n, dt));
        Self { law, dt, sum: 0.0, measured: None, reference: None, waiting: std::collections::VecDeque::new(), notch }
    }

    /// One sample: the command from reference and displacement as measured (m).
    pub fn step(&mut self, reference: f64, measured: f64) -> f64 {
        let measured = if self.law.late > 0 {
            self.waiting.push_back(measured);
            if self.waiting.len() > self.law.late + 1 {
                self.waiting.pop_front();
            }
            self.waiting.front().copied().unwrap_or(measured)
        } else {
            measured
        };
        let error = reference - measured;
        let mut command = match self.law.kind {
            Kind::Pi { kp, ki } => {
                self.sum += error;
                kp * error + ki * self.dt * self.sum
            }
            Kind::Cascade { kp, kv } => {
                let velocity = (measured - self.measured.replace(measured).unwrap_or(measured)) / self.dt;
                kv * (kp * error - velocity)
            }
        };
        let before = self.reference.replace(reference).unwrap_or(reference);
        command += self.law.kvf * (reference - before) / self.dt;
        self.notch.as_mut().map_or(command, |notch| notch.step(command))
    }
}

/// `(s2 + 2 z d w s + w2)/(s2 + 2 z w s + w2)` by the bilinear rule, the centre kept.
#[derive(Debug, Clone)]
struct Notch {
    b: [f64; 3],
    a: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
}

impl Notch {
    fn new([frequency, damping, depth]: [f64; 3], dt: f64) -> Self {
        let k = (std::f64::consts::PI * frequency * dt).tan();
        let norm = 1.0 + 2.0 * damping * k + k * k;
        let wide = 2.0 * damping * depth * k;
        let middle = 2.0 * (k * k - 1.0) / norm;
        Self {
            b: [(1.0 + wide + k * k) / norm, middle, (1.0 - wide + k * k) / norm],
            a: [middle, (1.0 - 2.0 * damping * k + k * k) / norm],
            x: [0.0; 2],
            y: [0.0; 2],
        }
    }

    fn step(&mut self, x: f64) -> f64 {
        let y = self.b[0] * x + self.b[1] * self.x[0] + self.b[2] * self.x[1]
            - self.a[0] * self.y[0]
            - self.a[1] * self.y[1];
        self.x = [x, self.x[0]];
        self.y = [y, self.y[0]];
        y
    }
}

/// What is asked of the table in one run.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Reference displacement (m), one value a sample.
    pub reference: Vec<f64>,
    /// Sample interval, true (s).
    pub dt: f64,
    /// The loop that ran.
    pub controller: Controller,
    /// Number within the case, from 0.
    pub number: u64,
}

/// What the model says perfect sensors give.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Prediction {
    /// Displacement (m).
    pub displacement: Vec<f64>,
    /// Acceleration (m/s2).
    pub acceleration: Vec<f64>,
    /// Command.
    pub command: Vec<f64>,
    /// Share of the samples beyond the velocity limit (1).
    pub saturated: f64,
}

/// Simulates the stated model in the loop of `run`; with `sensor`, its noise enters the loop.
pub fn predict(machine: &Machine, run: &Run, sensor: Option<&Sensor>) -> Prediction {
    let mut sensing = sensor.map(|s| Sensing::start(s, run.number, run.dt));
    let mut control = Loop::new(run.controller, run.dt);
    let mut out = Prediction::default();
    let (mut slow, mut x, mut before) = (0.0, run.reference.first().copied().unwrap_or(0.0), 0.0);
    let half = 0.5 * run.dt;
    let mut saturated = 0_usize;
    for &reference in &run.reference {
        let measured = sensing.as_mut().map_or(x, |s| s.displacement(x, before));
        let command = control.step(reference, measured);
        let stretch = Stretch::of(machine, slow, command);
        let after = stretch.velocity(half);
        let a = (after - before) / run.dt;
        out.displacement.push(measured);
        out.acceleration.push(sensing.as_mut().map_or(a, |s| s.acceleration(a)));
        out.command.push(command);
        saturated += usize::from(stretch.beyond(half));
        before = after;
        x += stretch.distance(run.dt);
        slow = stretch.slow(run.dt);
    }
    out.saturated = saturated as f64 / run.reference.len().max(1) as f64;
    out
}
