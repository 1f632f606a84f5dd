//! What a motion lacks of the zero-period acceleration, added above the band: a short burst, which asks little of speed and stroke.
//!
//! ```text
//! x(t) = X w(t) cos(2 pi f t),   w a squared Hann window of a few cycles,   f above the standard's highest frequency
//! ```
//! It begins and ends at rest where it began, so the rest of the motion stays as it is. It is laid where the motion's own acceleration
//! is large already, on the first of such places at which the limits are kept.

use super::super::{Motion, peak};
use super::Requirement;
use std::f64::consts::{PI, TAU};

/// Frequency over the highest of the standard's band.
const ABOVE: f64 = 1.12;
/// Cycles of the burst.
const CYCLES: f64 = 8.0;
/// Places that are tried.
const PLACES: usize = 24;
/// The peak over what is asked: what rounding leaves.
const OVER: f64 = 1.002;

/// The motion with its peak acceleration raised to what the standard asks of it; none where it has that, or where no place gives a motion
/// that is `allowed`.
pub(super) fn raised(motion: &Motion, asked: Requirement<'_>, allowed: impl Fn(&Motion) -> bool) -> Option<Motion> {
    let (burst, wanted) = lacking(&motion.acceleration, motion.dt, asked)?;
    let candidates = places(&motion.acceleration, burst.reach);
    candidates.into_iter().map(|at| burst.laid(motion, at, wanted)).find(allowed)
}

/// The same of an acceleration alone, m/s2, every `dt` s, which no limit binds; none where it has what is asked.
pub(super) fn raised_acceleration(acceleration: &[f64], dt: f64, asked: Requirement<'_>) -> Option<Vec<f64>> {
    let (burst, wanted) = lacking(acceleration, dt, asked)?;
    let at = places(acceleration, burst.reach).into_iter().next()?;
    let mut made = acceleration.to_vec();
    burst.add(&mut made, 2, burst.size(acceleration, at, wanted));
    Some(made)
}

/// The burst and the peak acceleration that a motion lacks, m/s2; none where it has what is asked.
fn lacking(acceleration: &[f64], dt: f64, asked: Requirement<'_>) -> Option<(Burst, f64)> {
    let Requirement { standard, required, .. } = asked;
    let wanted = OVER * standard.zero_period * required.zero_period();
    (peak(acceleration) < wanted).then(|| (Burst::new(dt, ABOVE * standard.band.1), wanted))
}

/// The samples at which a burst may lie: the largest accelerations first, none within a burst of another.
fn places(acceleration: &[f64], reach: usize) -> Vec<usize> {
    let inside = reach..acceleration.len().saturating_sub(reach);
    let mut order: Vec<usize> = inside.collect();
    order.sort_by(|a, b| acceleration[*b].abs().total_cmp(&acceleration[*a].abs()));
    let mut kept: Vec<usize> = Vec::new();
    for at in order {
        if kept.iter().all(|k| k.abs_diff(at) > reach) {
            kept.push(at);
        }
        if kept.len() == PLACES {
            break;
        }
    }
    kept
}

/// Displacement, velocity and acceleration of a burst whose acceleration peaks at 1 in its middle.
struct Burst {
    /// Samples to either side of the middle.
    reach: usize,
    samples: Vec<[f64; 3]>,
}

impl Burst {
    fn new(dt: f64, frequency: f64) -> Self {
        let half = 0.5 * CYCLES / frequency;
        let reach = (half / dt).ceil() as usize;
        let w = TAU * frequency;
        let at = |k: usize| {
            let t = (k as f64 - reach as f64) * dt;
            if t.abs() >= half {
                return [0.0; 3];
            }
            // w = cos^4(p), p = pi t / (2 half), and its derivatives.
            let (p, q) = (0.5 * PI * t / half, 0.5 * PI / half);
            let (s, c) = p.sin_cos();
            let window = [c.powi(4), -4.0 * q * c.powi(3) * s, q * q * (12.0 * c * c * s * s - 4.0 * c.powi(4))];
            let (sine, cosine) = (w * t).sin_cos();
            let carrier = [cosine, -w * sine, -w * w * cosine];
            [
                window[0] * carrier[0],
                window[1] * carrier[0] + window[0] * carrier[1],
                window[2] * carrier[0] + 2.0 * window[1] * carrier[1] + window[0] * carrier[2],
            ]
        };
        let mut samples: Vec<[f64; 3]> = (0..=2 * reach).map(at).collect();
        let middle = samples[reach][2];
        samples.iter_mut().flatten().for_each(|value| *value /= middle);
        Self { reach, samples }
    }

    /// The motion with the burst about a sample, where the acceleration becomes `wanted`, its sign kept.
    fn laid(&self, motion: &Motion, at: usize, wanted: f64) -> Motion {
        let mut made = motion.clone();
        let size = self.size(&motion.acceleration, at, wanted);
        for (column, signal) in
            [&mut made.displacement, &mut made.velocity, &mut made.acceleration].into_iter().enumerate()
        {
            self.add(signal, column, size);
        }
        made
    }

    /// Adds displacement, velocity or acceleration of the burst, by its column, from a sample on.
    fn add(&self, signal: &mut [f64], column: usize, (first, size): (usize, f64)) {
        signal[first..].iter_mut().zip(&self.samples).for_each(|(value, sample)| *value += size * sample[column]);
    }

    /// Sample at which the burst about a sample begins, and its peak, m/s2.
    fn size(&self, acceleration: &[f64], at: usize, wanted: f64) -> (usize, f64) {
        let own = acceleration[at];
        (at - self.reach, wanted.copysign(own) - own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_ends_where_it_began_and_is_one_motion() {
        let (dt, burst) = (1.0 / 240.0, Burst::new(1.0 / 240.0, 37.0));
        let of = |i: usize| burst.samples.iter().map(|s| s[i]).collect::<Vec<f64>>();
        let (x, v, a) = (of(0), of(1), of(2));
        assert!((a[burst.reach] - 1.0).abs() < 1e-12 && peak(&a) <= 1.0 + 1e-12);
        assert!(x[0] == 0.0 && v[0] == 0.0 && x[x.len() - 1] == 0.0 && v[v.len() - 1] == 0.0);
        // Sums over the whole burst, whose window is smooth: nothing is left of velocity or displacement.
        assert!((a.iter().sum::<f64>() * dt).abs() < 1e-5 && (v.iter().sum::<f64>() * dt).abs() < 1e-7);
        assert!(peak(&v) < 1.05 / (TAU * 37.0), "{}", peak(&v));
    }
}
