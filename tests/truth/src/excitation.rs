//! References of seven kinds, all starting at rest, none needing a record.

use crate::rng::Stream;
use std::f64::consts::{PI, TAU};

/// Kind of reference.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Excitation {
    /// Band-limited noise.
    Noise,
    /// Sines on a harmonic grid with random phases, several periods.
    Multisine,
    /// Sine whose frequency rises exponentially at constant velocity.
    Sweep,
    /// Near-field pulses (Mavroeidis and Papageorgiou's form).
    Pulses,
    /// Triangles of growing amplitude, back and forth.
    Ladder,
    /// A shaken-ground spectrum under a rising and falling envelope.
    Quake,
    /// Smooth steps of several heights.
    Steps,
}

impl Excitation {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Noise, Self::Multisine, Self::Sweep, Self::Pulses, Self::Ladder, Self::Quake, Self::Steps];
}

/// What a reference should be like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Sample interval (s).
    pub dt: f64,
    /// Number of samples.
    pub count: usize,
    /// Peak velocity (m/s).
    pub velocity: f64,
    /// Peak displacement at most (m).
    pub displacement: f64,
    /// Highest frequency worth exciting (Hz).
    pub top: f64,
}

/// A reference displacement (m), zero at first.
pub fn reference(kind: Excitation, shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let mut x = match kind {
        Excitation::Noise => noise(shape, rng),
        Excitation::Multisine => multisine(shape, rng),
        Excitation::Sweep => sweep(shape, rng),
        Excitation::Pulses => pulses(shape, rng),
        Excitation::Ladder => ladder(shape, rng),
        Excitation::Quake => quake(shape, rng),
        Excitation::Steps => steps(shape, rng),
    };
    let first = x.first().copied().unwrap_or(0.0);
    let (mut fastest, mut farthest) = (1e-12_f64, 1e-12_f64);
    for i in 0..x.len() {
        x[i] -= first;
        farthest = farthest.max(x[i].abs());
        if i > 0 {
            fastest = fastest.max((x[i] - x[i - 1]).abs() / shape.dt);
        }
    }
    let scale = (shape.velocity / fastest).min(shape.displacement / farthest);
    for v in &mut x {
        *v *= scale;
    }
    x
}

/// Rises from 0 to 1 in the first `rise` seconds and falls again before the end.
fn taper(t: f64, duration: f64, rise: f64) -> f64 {
    let edge = |s: f64| if s >= rise { 1.0 } else { 0.5 - 0.5 * (PI * s.max(0.0) / rise).cos() };
    edge(t - 0.25) * edge(duration - 0.25 - t)
}

fn sampled(shape: &Shape, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..shape.count).map(|k| f(k as f64 * shape.dt)).collect()
}

fn duration(shape: &Shape) -> f64 {
    shape.count as f64 * shape.dt
}

/// A sum of sines `(frequency, amplitude, phase)`, by rotation: one multiplication a sine and sample.
fn sum_of_sines(shape: &Shape, sines: &[(f64, f64, f64)]) -> Vec<f64> {
    let mut out = vec![0.0; shape.count];
    for &(frequency, amplitude, phase) in sines {
        let (sin, cos) = (TAU * frequency * shape.dt).sin_cos();
        let (mut im, mut re) = phase.sin_cos();
        for value in &mut out {
            *value += amplitude * im;
            (re, im) = (re * cos - im * sin, re * sin + im * cos);
        }
    }
    out
}

fn enveloped(shape: &Shape, mut x: Vec<f64>, envelope: impl Fn(f64) -> f64) -> Vec<f64> {
    for (k, value) in x.iter_mut().enumerate() {
        *value *= envelope(k as f64 * shape.dt);
    }
    x
}

fn noise(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let low = rng.uniform(0.1, 0.4);
    let slope = rng.uniform(1.0, 2.0);
    let sines: Vec<_> = (0..90)
        .map(|_| {
            let f = rng.log_uniform(low, shape.top);
            (f, rng.normal() * f.powf(-slope), rng.uniform(0.0, TAU))
        })
        .collect();
    let end = duration(shape);
    enveloped(shape, sum_of_sines(shape, &sines), |t| taper(t, end, 1.5))
}

fn multisine(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let base = f64::from(1 + rng.below(3) as u32) / (0.5 * duration(shape));
    let lines = ((shape.top / base) as usize).clamp(3, 60);
    let slope = rng.uniform(0.8, 1.5);
    let sines: Vec<_> = (0..lines)
        .map(|i| {
            let f = base * (1 + 2 * i) as f64;
            (f, f.powf(-slope), rng.uniform(0.0, TAU))
        })
        .filter(|(f, ..)| *f <= shape.top)
        .collect();
    let end = duration(shape);
    enveloped(shape, sum_of_sines(shape, &sines), |t| taper(t, end, 1.0))
}

fn sweep(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let (from, to) = (rng.uniform(0.15, 0.4), shape.top);
    let end = duration(shape);
    let rate = (to / from).ln() / end;
    sampled(shape, |t| {
        let frequency = from * (rate * t).exp();
        let phase = TAU * from * ((rate * t).exp() - 1.0) / rate;
        taper(t, end, 1.0) * phase.sin() / frequency
    })
}

fn pulses(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let end = duration(shape);
    let list: Vec<_> = (0..3 + rng.below(3))
        .map(|_| {
            let frequency = rng.log_uniform(0.4, (0.5 * shape.top).clamp(0.6, 2.5));
            let gamma = rng.uniform(1.5, 3.0);
            let reach = 0.5 * gamma / frequency;
            let centre = rng.uniform(0.3 + reach, (end - 1.0 - reach).max(0.4 + reach));
            (frequency, gamma, centre, rng.uniform(0.4, 1.0) * rng.sign(), rng.uniform(0.0, TAU))
        })
        .collect();
    let velocity = |t: f64| -> f64 {
        list.iter()
            .map(|&(frequency, gamma, centre, size, phase)| {
                let s = t - centre;
                if s.abs() > 0.5 * gamma / frequency {
                    return 0.0;
                }
                size * 0.5 * (1.0 + (TAU * frequency / gamma * s).cos()) * (TAU * frequency * s + phase).cos()
            })
            .sum()
    };
    let mut x = 0.0;
    sampled(shape, velocity)
        .into_iter()
        .map(|v| {
            x += v * shape.dt;
            x
        })
        .collect()
}

/// Moving average over `width` samples, ends held.
fn smoothed(x: &[f64], width: usize) -> Vec<f64> {
    let mut sums = vec![0.0; x.len() + 1];
    for (i, value) in x.iter().enumerate() {
        sums[i + 1] = sums[i] + value;
    }
    (0..x.len())
        .map(|i| {
            let from = i.saturating_sub(width);
            (sums[i + 1] - sums[from]) / (i + 1 - from) as f64
        })
        .collect()
}

fn ladder(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let rungs = 4 + rng.below(4);
    let end = duration(shape) - 1.0;
    let period = end / rungs as f64;
    let constant_speed = rng.chance(0.5);
    let corners = rng.uniform(0.03, 0.08);
    let raw = sampled(shape, |t| {
        let s = t - 0.5;
        if s < 0.0 || s >= end {
            return 0.0;
        }
        let rung = (s / period) as usize;
        let size = (1 + rung) as f64 / rungs as f64;
        let cycles = if constant_speed { (2.0 / size).round().clamp(1.0, 6.0) } else { 2.0 };
        let phase = (s / period * cycles).fract();
        let triangle = if phase < 0.25 {
            4.0 * phase
        } else if phase < 0.75 {
            2.0 - 4.0 * phase
        } else {
            4.0 * phase - 4.0
        };
        size * triangle
    });
    smoothed(&raw, ((corners / shape.dt) as usize).max(2))
}

fn quake(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let ground = rng.uniform(1.2, 3.0);
    let damping = rng.uniform(0.3, 0.6);
    let low = rng.uniform(0.15, 0.35);
    let sines: Vec<_> = (0..120)
        .map(|_| {
            let f = rng.log_uniform(low, shape.top);
            let r2 = (f / ground).powi(2);
            let g = 4.0 * damping * damping * r2;
            let kanai = ((1.0 + g) / ((1.0 - r2).powi(2) + g)).sqrt();
            // Log-spaced lines: each stands for a band as wide as its frequency.
            (f, rng.normal() * kanai * f.sqrt() / (f * f), rng.uniform(0.0, TAU))
        })
        .collect();
    let end = duration(shape);
    let (rise, hold) = (rng.uniform(1.5, 4.0), rng.uniform(3.0, 8.0));
    enveloped(shape, sum_of_sines(shape, &sines), |t| {
        let s = t - 0.5;
        let body = if s < 0.0 {
            0.0
        } else if s < rise {
            (s / rise).powi(2)
        } else if s < rise + hold {
            1.0
        } else {
            (-(s - rise - hold) / 5.0).exp()
        };
        body * taper(t, end, 1.0)
    })
}

fn steps(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    let end = duration(shape);
    let count = 5 + rng.below(4);
    let slot = (end - 1.0) / count as f64;
    let levels: Vec<f64> =
        (0..=count).map(|i| if i == 0 || i == count { 0.0 } else { rng.uniform(-1.0, 1.0) }).collect();
    let lengths: Vec<f64> = (0..count).map(|_| rng.uniform(0.25, 0.8) * slot).collect();
    sampled(shape, |t| {
        let s = (t - 0.5).max(0.0);
        let i = ((s / slot) as usize).min(count - 1);
        let p = ((s - i as f64 * slot) / lengths[i]).clamp(0.0, 1.0);
        let rise = p * p * p * (10.0 - 15.0 * p + 6.0 * p * p);
        levels[i] + (levels[i + 1] - levels[i]) * rise
    })
}

#[cfg(test)]
mod tests {
    use super::{Excitation, Shape, reference};
    use crate::rng::Stream;

    #[test]
    fn every_reference_starts_at_rest_and_keeps_its_velocity_and_stroke() {
        let shape = Shape { dt: 0.004, count: 6000, velocity: 0.2, displacement: 0.08, top: 6.0 };
        for (i, kind) in Excitation::ALL.into_iter().enumerate() {
            for case in 0..20 {
                let x = reference(kind, &shape, &mut Stream::new(3, case, i as u64));
                assert_eq!(x.len(), shape.count);
                assert_eq!(x[0], 0.0);
                let fastest = x.windows(2).map(|p| (p[1] - p[0]).abs() / shape.dt).fold(0.0, f64::max);
                let farthest = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                assert!(fastest < 0.2001 && farthest < 0.0801, "{kind:?}: {fastest} m/s, {farthest} m");
                assert!((fastest - 0.2).abs() < 1e-6 || (farthest - 0.08).abs() < 1e-6, "{kind:?} uses neither bound");
                assert!((x[1] - x[0]).abs() / shape.dt < 0.02, "{kind:?} starts with a jump");
            }
        }
    }
}
