//! Response spectra and Fourier amplitude.

use super::STANDARD_GRAVITY;
use rayon::prelude::*;
use realfft::RealFftPlanner;
use std::f64::consts::PI;

/// Largest responses of linear single-degree-of-freedom oscillators to a ground acceleration, by period.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseSpectrum {
    /// Damping, share of critical.
    pub damping: f64,
    /// Undamped periods, s.
    pub periods: Vec<f64>,
    /// Largest displacement relative to the ground, m.
    pub s_d: Vec<f64>,
    /// Largest velocity relative to the ground, m/s.
    pub s_v: Vec<f64>,
    /// Largest absolute acceleration, m/s².
    pub s_a: Vec<f64>,
}

impl ResponseSpectrum {
    /// `S_a` in g.
    pub fn s_a_in_g(&self) -> Vec<f64> {
        self.s_a.iter().map(|a| a / STANDARD_GRAVITY).collect()
    }

    /// Pseudo-acceleration `(2 pi / T)^2 S_d`, m/s².
    pub fn pseudo_acceleration(&self) -> Vec<f64> {
        self.periods.iter().zip(&self.s_d).map(|(t, d)| (2.0 * PI / t).powi(2) * d).collect()
    }
}

/// Why there is no response spectrum.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SpectrumError {
    /// The damping is not below critical.
    #[error("damping {0}: expected from 0 to below 1, 0.05 for the usual 5 %")]
    Damping(f64),
    /// A period that is not positive.
    #[error("period {0} s: expected over 0")]
    Period(f64),
}

/// Periods evenly spaced in the logarithm, s.
pub fn periods(from: f64, to: f64, count: usize) -> Vec<f64> {
    let step = if count > 1 { (to / from).ln() / (count - 1) as f64 } else { 0.0 };
    (0..count).map(|i| from * (step * i as f64).exp()).collect()
}

/// The response spectrum of a ground acceleration (m/s²) sampled every `dt` s and linear between samples.
///
/// Each oscillator is stepped exactly (Nigam and Jennings, 1969), in steps of at most a twentieth of its period and a quarter
/// of a sample; where a quantity turns within a step, its peak is sought there. Only a turn there and back within one step
/// is missed: white noise under a soft oscillator showed it at 1.7e-3 of the peak in steps of a sample, below 1e-4 in these.
/// The oscillator is first taken from sample to sample; within a sample it is only looked at where a quantity can exceed its largest
/// at all samples.
/// The oscillator starts at rest; what it does after the last sample does not count, so pad a record with rest where it
/// should.
pub fn response_spectrum(
    acceleration: &[f64],
    dt: f64,
    damping: f64,
    periods: &[f64],
) -> Result<ResponseSpectrum, SpectrumError> {
    if !(0.0..1.0).contains(&damping) {
        return Err(SpectrumError::Damping(damping));
    }
    if let Some(&period) = periods.iter().find(|t| !(**t > 0.0 && t.is_finite())) {
        return Err(SpectrumError::Period(period));
    }
    let impulses = impulses(acceleration, dt);
    let peaks: Vec<[f64; 3]> =
        periods.par_iter().map(|&period| Oscillator::new(period, damping, dt).peaks(acceleration, &impulses)).collect();
    let column = |i: usize| peaks.iter().map(|p| p[i]).collect();
    Ok(ResponseSpectrum { damping, periods: periods.to_vec(), s_d: column(0), s_v: column(1), s_a: column(2) })
}

/// Steps from sample to sample that are judged together.
const BLOCK: usize = 8;

/// Largest change of a ground velocity over each block, m/s: the integral of the acceleration's magnitude, straight between samples.
fn impulses(acceleration: &[f64], dt: f64) -> Vec<f64> {
    let step = |k: usize| 0.5 * dt * (acceleration[k].abs() + acceleration[k + 1].abs());
    let steps = acceleration.len().saturating_sub(1);
    (0..steps).step_by(BLOCK).map(|from| (from..steps.min(from + BLOCK)).map(step).sum()).collect()
}

/// `x'' + 2 z w x' + w^2 x = -a`, stepped exactly for an acceleration that is linear over a step.
struct Oscillator {
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
    fn new(period: f64, damping: f64, dt: f64) -> Self {
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
    fn peaks(&self, acceleration: &[f64], impulses: &[f64]) -> [f64; 3] {
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
                    *peak = value.abs().max(*peak);
                }
            }
        }
        (peaks, begins)
    }

    /// The state after a sample, and the peaks with those within it.
    fn sought(&self, peaks: &mut [f64; 3], mut state: (f64, f64), (from, to): (f64, f64)) -> (f64, f64) {
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
pub(super) fn advance((w, z, h): (f64, f64, f64), (x0, v0): (f64, f64), (a0, a1): (f64, f64)) -> (f64, f64) {
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

/// Fourier amplitude of a signal sampled every `dt` s, `dt |sum x exp(-i w t)|`: frequencies (Hz) and amplitudes (unit of
/// the signal times s). The signal is padded with zeros to a power of two.
pub fn fourier_amplitude(signal: &[f64], dt: f64) -> (Vec<f64>, Vec<f64>) {
    let size = signal.len().next_power_of_two().max(2);
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(size);
    let mut buffer = signal.to_vec();
    buffer.resize(size, 0.0);
    let mut spectrum = forward.make_output_vec();
    // The buffers are made for this plan: their lengths cannot be wrong.
    let amplitude = match forward.process(&mut buffer, &mut spectrum) {
        Ok(()) => spectrum.iter().map(|c| c.norm() * dt).collect(),
        Err(_) => Vec::new(),
    };
    ((0..=size / 2).map(|i| i as f64 / (size as f64 * dt)).collect(), amplitude)
}

#[cfg(test)]
mod tests;
