//! One linear oscillator under a ground acceleration: its largest responses.

use std::f64::consts::PI;

/// Steps from sample to sample that are judged together.
const BLOCK: usize = 8;

/// Largest change of a ground velocity over each block, m/s: the integral of the acceleration's magnitude, straight between samples.
pub(super) fn impulses(acceleration: &[f64], dt: f64) -> Vec<f64> {
    let step = |k: usize| 0.5 * dt * (acceleration[k].abs() + acceleration[k + 1].abs());
    let steps = acceleration.len().saturating_sub(1);
    (0..steps).step_by(BLOCK).map(|from| (from..steps.min(from + BLOCK)).map(step).sum()).collect()
}

/// `x'' + 2 z w x' + w^2 x = -a`, stepped exactly for an acceleration that is linear over a step.
pub(super) struct Oscillator {
    w: f64,
    damping: f64,
    /// What is divided by at every sample, turned over once.
    over: Reciprocals,
    /// Length of a sample, s.
    dt: f64,
    /// Length of a step, s.
    h: f64,
    /// Steps to a sample.
    steps: usize,
    /// After a step.
    short: Transition,
    /// After a sample.
    long: Transition,
}

/// Factors of the particular solution and of the free vibration that meets the start.
#[derive(Debug, Clone, Copy)]
struct Reciprocals {
    /// `1 / dt`.
    dt: f64,
    /// `1 / w`.
    w: f64,
    /// `1 / w^2`.
    w2: f64,
    /// `2 z / w^3`.
    ramp: f64,
    /// `1 / (w sqrt(1 - z^2))`.
    damped: f64,
}

impl Reciprocals {
    fn new(w: f64, z: f64, dt: f64) -> Self {
        let damped = 1.0 / (w * (1.0 - z * z).sqrt());
        Self { dt: 1.0 / dt, w: 1.0 / w, w2: 1.0 / (w * w), ramp: 2.0 * z / (w * w * w), damped }
    }
}

/// `(x, v)` from `(x, v, a, a_next)`.
#[derive(Debug, Clone, Copy)]
struct Transition([[f64; 4]; 2]);

impl Transition {
    /// Over `h` s of an oscillator: the response to each of the four inputs alone makes a column.
    fn new(w: f64, damping: f64, h: f64) -> Self {
        let mut rows = [[0.0; 4]; 2];
        let units = [(1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0)];
        for (i, (x, v, a, next)) in units.into_iter().enumerate() {
            (rows[0][i], rows[1][i]) = advance((w, damping, h), (x, v), (a, next));
        }
        Self(rows)
    }

    fn after(&self, (x, v): (f64, f64), a: f64, next: f64) -> (f64, f64) {
        // Grouped so that what the ground adds does not wait for the state.
        let of = |row: &[f64; 4]| (row[0] * x + row[1] * v) + (row[2] * a + row[3] * next);
        (of(&self.0[0]), of(&self.0[1]))
    }
}

impl Oscillator {
    pub(super) fn new(period: f64, damping: f64, dt: f64) -> Self {
        let w = 2.0 * PI / period;
        let steps = (20.0 * dt / period).ceil().clamp(4.0, 1e4) as usize;
        let h = dt / steps as f64;
        let (short, long) = (Transition::new(w, damping, h), Transition::new(w, damping, dt));
        Self { w, damping, over: Reciprocals::new(w, damping, dt), dt, h, steps, short, long }
    }

    /// Relative displacement, relative velocity and absolute acceleration, and the rates they change at.
    fn quantities(&self, x: f64, v: f64, a: f64) -> ([f64; 3], [f64; 3]) {
        let (w, c) = (self.w, 2.0 * self.damping * self.w);
        let absolute = -c * v - w * w * x;
        let relative = absolute - a;
        ([x, v, absolute], [v, relative, -c * relative - w * w * v])
    }

    /// What none of the quantities exceeds within a sample: the particular solution's largest and the free vibration's amplitude, or,
    /// for a soft oscillator, where its rates take it.
    fn bounds(&self, (x, v): (f64, f64), a: f64, next: f64) -> [f64; 3] {
        let (w, z, over) = (self.w, self.damping, &self.over);
        let slope = (next - a) * over.dt;
        let particular = |a: f64| over.ramp * slope - a * over.w2;
        let (begin, drift) = (particular(a), -slope * over.w2);
        let c1 = x - begin;
        let c2 = (v - drift + z * w * c1) * over.damped;
        let amplitude = (c1 * c1 + c2 * c2).sqrt();
        let farthest = begin.abs().max(particular(next).abs());
        // The particular solution's absolute acceleration is the ground's.
        let strongest = a.abs().max(next.abs());
        let absolute = strongest + (1.0 + 2.0 * z) * w * w * amplitude;
        let velocity = (drift.abs() + w * amplitude).min(v.abs() + self.dt * (strongest + absolute));
        let displacement = (farthest + amplitude).min(x.abs() + self.dt * velocity);
        [displacement, velocity, absolute.min(2.0 * z * w * velocity + w * w * displacement)]
    }

    /// Whether no quantity can exceed its peak within a block: the amplitude `sqrt(x^2 + (v / w)^2)` grows by no more than the ground's
    /// impulse over `w`, whatever the damping takes.
    fn calm(&self, (x, v): (f64, f64), impulse: f64, peaks: &[f64; 3]) -> bool {
        let (w, z) = (self.w, self.damping);
        let rate = v * self.over.w;
        let amplitude = (x * x + rate * rate).sqrt() + impulse * self.over.w;
        let absolute = w * w * amplitude * (1.0 + 4.0 * z * z).sqrt();
        amplitude <= peaks[0] && w * amplitude <= peaks[1] && absolute <= peaks[2]
    }

    /// Largest relative displacement, relative velocity and absolute acceleration.
    pub(super) fn peaks(&self, acceleration: &[f64], impulses: &[f64]) -> [f64; 3] {
        let (mut peaks, begins) = self.surveyed(acceleration, impulses.len());
        for (block, (impulse, begin)) in impulses.iter().zip(begins).enumerate() {
            if self.calm(begin, *impulse, &peaks) {
                continue;
            }
            let until = acceleration.len().min((block + 1) * BLOCK + 1);
            let mut state = begin;
            for pair in acceleration[block * BLOCK..until].windows(2) {
                let bounds = self.bounds(state, pair[0], pair[1]);
                if bounds.iter().zip(&peaks).all(|(bound, peak)| bound <= peak) {
                    state = self.long.after(state, pair[0], pair[1]);
                } else {
                    state = self.sought(&mut peaks, state, (pair[0], pair[1]));
                }
            }
        }
        peaks
    }

    /// The largest of each quantity at the samples, which few blocks can exceed, and the state at the begin of each block.
    fn surveyed(&self, acceleration: &[f64], blocks: usize) -> ([f64; 3], Vec<(f64, f64)>) {
        let mut begins = Vec::with_capacity(blocks);
        let (mut state, mut peaks) = ((0.0, 0.0), [0.0f64; 3]);
        let (stiffness, viscosity) = (self.w * self.w, 2.0 * self.damping * self.w);
        for block in 0..blocks {
            begins.push(state);
            let until = acceleration.len().min((block + 1) * BLOCK + 1);
            for pair in acceleration[block * BLOCK..until].windows(2) {
                state = self.long.after(state, pair[0], pair[1]);
                let values = [state.0, state.1, viscosity * state.1 + stiffness * state.0];
                for (peak, value) in peaks.iter_mut().zip(values) {
                    // Compared, not `max`, which WebAssembly has to call.
                    if value.abs() > *peak {
                        *peak = value.abs();
                    }
                }
            }
        }
        (peaks, begins)
    }

    /// The state after a sample, and the peaks with those within it.
    pub(super) fn sought(&self, peaks: &mut [f64; 3], mut state: (f64, f64), (from, to): (f64, f64)) -> (f64, f64) {
        let slope = (to - from) / self.steps as f64;
        for i in 0..self.steps {
            let a = from + slope * i as f64;
            let (_, before) = self.quantities(state.0, state.1, a);
            let next = self.short.after(state, a, a + slope);
            let (values, after) = self.quantities(next.0, next.1, a + slope);
            for j in 0..3 {
                peaks[j] = values[j].abs().max(peaks[j]);
                if before[j] * after[j] < 0.0 {
                    let turn = self.turn(j, state, (a, slope), (before[j], after[j]));
                    peaks[j] = turn.abs().max(peaks[j]);
                }
            }
            state = next;
        }
        state
    }

    /// The extreme of quantity `j` within a step, where its rate passes through zero, by false position.
    fn turn(&self, j: usize, state: (f64, f64), (a, slope): (f64, f64), rates: (f64, f64)) -> f64 {
        let (mut from, mut to) = ((0.0, rates.0), (1.0, rates.1));
        let mut extreme = 0.0;
        for _ in 0..4 {
            let share = (from.0 * to.1 - to.0 * from.1) / (to.1 - from.1);
            let end = a + slope * share;
            let (x, v) = advance((self.w, self.damping, self.h * share), state, (a, end));
            let (values, rate) = self.quantities(x, v, end);
            extreme = values[j];
            if rate[j] * from.1 > 0.0 {
                from = (share, rate[j]);
            } else if rate[j] * to.1 > 0.0 {
                to = (share, rate[j]);
            } else {
                break;
            }
        }
        extreme
    }
}

/// State of an oscillator `(w, damping)` after `h` s, from a state, under an acceleration running straight from one value
/// to another: the particular solution `-(a + s t) / w^2 + 2 z s / w^3` and the free vibration that meets the start.
pub(in crate::motion) fn advance((w, z, h): (f64, f64, f64), (x0, v0): (f64, f64), (a0, a1): (f64, f64)) -> (f64, f64) {
    let slope = (a1 - a0) / h;
    let particular = |a: f64| -a / (w * w) + 2.0 * z * slope / (w * w * w);
    let particular_velocity = -slope / (w * w);
    let wd = w * (1.0 - z * z).sqrt();
    let c1 = x0 - particular(a0);
    let c2 = (v0 - particular_velocity + z * w * c1) / wd;
    let (decay, cos, sin) = ((-z * w * h).exp(), (wd * h).cos(), (wd * h).sin());
    let free = decay * (c1 * cos + c2 * sin);
    let free_velocity = decay * ((c2 * wd - z * w * c1) * cos - (c1 * wd + z * w * c2) * sin);
    (free + particular(a1), free_velocity + particular_velocity)
}
