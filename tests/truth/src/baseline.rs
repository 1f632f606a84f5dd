//! The model that an experiment states, solved exactly from sample to sample: the linear part in closed form, the limit by
//! the instants at which it is met. The truth without any flaw must agree with it, and strengths are measured against it.

use crate::closed_loop::{Loop, Run};
use crate::noise::Noise;
use crate::plant::Machine;

/// What the model says the perfect sensors give.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Prediction {
    /// Displacement (m).
    pub displacement: Vec<f64>,
    /// Acceleration (m/s2).
    pub acceleration: Vec<f64>,
    /// Command.
    pub command: Vec<f64>,
    /// Share of the samples at which the demand is beyond the velocity limit (1).
    pub saturated: f64,
}

/// Simulates the model in the loop of `run`.
pub fn predict(machine: &Machine, run: &Run) -> Prediction {
    solve(machine, run, None)
}

/// The same with noise on the sensors, and in the loop.
pub fn predict_noisy(machine: &Machine, run: &Run, noise: &Noise) -> Prediction {
    solve(machine, run, Some(noise))
}

fn solve(machine: &Machine, run: &Run, noise: Option<&Noise>) -> Prediction {
    let mut sensing = noise.map(|n| n.start(run.number));
    let mut control = Loop::new(run.controller);
    let mut out = Prediction::default();
    let (mut slow, mut x, mut before) = (0.0, run.reference.first().copied().unwrap_or(0.0), 0.0);
    let half = 0.5 * run.dt;
    let mut saturated = 0_usize;
    for (k, &reference) in run.reference.iter().enumerate() {
        let measured = sensing.as_mut().map_or(x, |s| s.displacement(x));
        let u = control.step(reference, measured, run.dt);
        let stretch = Stretch::of(machine, slow, u);
        let after = stretch.velocity(half);
        out.displacement.push(measured);
        let a = (after - before) / run.dt;
        out.acceleration.push(sensing.as_mut().map_or(a, |s| s.acceleration(a, k as f64 * run.dt)));
        out.command.push(u);
        saturated += usize::from(stretch.demand(half).abs() > stretch.limit);
        before = after;
        x += stretch.distance(run.dt);
        slow = stretch.slow(run.dt);
    }
    out.saturated = saturated as f64 / run.reference.len().max(1) as f64;
    out
}

/// One sample: demand `offset + settled + (start - settled) exp(-pole t)`, clamped to the limit.
pub(crate) struct Stretch {
    pole: f64,
    start: f64,
    settled: f64,
    offset: f64,
    limit: f64,
}

impl Stretch {
    pub(crate) fn of(machine: &Machine, slow: f64, u: f64) -> Self {
        match *machine {
            Machine::Servo { b1, b0, a1, velocity_limit } => {
                Self { pole: a1, start: slow, settled: (b0 / a1 - b1) * u, offset: b1 * u, limit: velocity_limit }
            }
            Machine::Rigid { mass, viscous, gain } => {
                let pole = viscous / mass;
                Self { pole, start: slow, settled: gain * u / viscous, offset: 0.0, limit: f64::INFINITY }
            }
        }
    }

    pub(crate) fn slow(&self, t: f64) -> f64 {
        self.settled + (self.start - self.settled) * (-self.pole * t).exp()
    }

    fn demand(&self, t: f64) -> f64 {
        self.offset + self.slow(t)
    }

    /// Whether the demand is beyond the limit after `t`.
    pub(crate) fn beyond(&self, t: f64) -> bool {
        self.demand(t).abs() > self.limit
    }

    pub(crate) fn velocity(&self, t: f64) -> f64 {
        self.demand(t).clamp(-self.limit, self.limit)
    }

    /// Distance travelled in `t`: the demand is monotone, so each bound is met at most once.
    pub(crate) fn distance(&self, t: f64) -> f64 {
        let (first, last) = (self.demand(0.0), self.demand(t));
        if first.abs() <= self.limit && last.abs() <= self.limit {
            return self.free_distance(0.0, t);
        }
        let mut cuts = [0.0, self.crossing(self.limit, t), self.crossing(-self.limit, t), t];
        cuts.sort_by(f64::total_cmp);
        cuts.windows(2)
            .map(|pair| {
                let middle = self.demand(0.5 * (pair[0] + pair[1]));
                if middle.abs() > self.limit {
                    middle.signum() * self.limit * (pair[1] - pair[0])
                } else {
                    self.free_distance(pair[0], pair[1])
                }
            })
            .sum()
    }

    fn free_distance(&self, from: f64, to: f64) -> f64 {
        let fading = ((-self.pole * from).exp() - (-self.pole * to).exp()) / self.pole;
        (self.offset + self.settled) * (to - from) + (self.start - self.settled) * fading
    }

    /// When the demand meets `level`, or the start where it does not within `t`.
    fn crossing(&self, level: f64, t: f64) -> f64 {
        let ratio = (level - self.offset - self.settled) / (self.start - self.settled);
        let when = -ratio.ln() / self.pole;
        if when.is_finite() && when > 0.0 && when < t { when } else { 0.0 }
    }
}
