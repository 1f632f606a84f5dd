//! Whether a table with its specimen still answers a drive as it did when the drive was learnt.
//!
//! The same check motion, too weak to harm, is recorded when a drive is learnt and again before it is played. Whatever the table's
//! physics, equal tables answer equally but for noise. A table that is warmer answers with another gain and delay, which is no reason
//! to learn again: what of the difference a gain, a delay and two more slowly varying terms explain is taken out. A specimen that
//! softened changes the answer near its resonance, which they do not follow.
//! ```text
//! D = X' - X;   D - X (g0 + g1 jw + g2 (jw)^2 + g3 (jw)^3) = R;   change(f) = |R| / |X|, by sixths of an octave
//! ```
//! A sixth of an octave has changed where R holds more power than noise explains, and more than [`LEAST`] of X.

use nalgebra::{Complex, DMatrix, DVector};
use realfft::RealFftPlanner;
use std::f64::consts::{PI, TAU};

/// What two check runs say.
#[derive(Debug, Clone, PartialEq)]
pub struct Staleness {
    /// True where the answer has changed: a drive learnt before is stale.
    pub stale: bool,
    /// The largest change that counts, relative; 0 where none does.
    pub change: f64,
    /// Where it is, Hz; NaN where there is none.
    pub frequency: f64,
    /// Change of gain over the whole band, relative.
    pub gain: f64,
    /// Change of delay, s, positive where the table has become later.
    pub delay: f64,
    /// By sixths of an octave: frequency (Hz), relative change, and its power over what noise explains.
    pub by_frequency: Vec<(f64, f64, f64)>,
}

/// Why two runs are not comparable.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StaleError {
    /// They differ in length or are too short.
    #[error("the check runs have {first} and {second} samples: expected the same, and {least} at least")]
    Length {
        /// Samples of the first.
        first: usize,
        /// Samples of the second.
        second: usize,
        /// Fewest.
        least: usize,
    },
    /// Nothing moves.
    #[error("the check run hardly moves between {from} and {to} Hz: nothing can be told of the specimen")]
    Still {
        /// Hz.
        from: f64,
        /// Hz.
        to: f64,
    },
}

/// Relative change below which a drive is as good as it was: what it adds to E_a is lost in the noise.
pub const LEAST: f64 = 0.01;
/// The band, Hz.
const BAND: (f64, f64) = (0.4, 15.0);
/// Where noise alone is seen, Hz; the upper end also as a share of the rate.
const NOISE: (f64, f64) = (25.0, 0.4);
/// Fewest samples.
const SAMPLES: usize = 512;
/// Terms of a slow change: gain, delay and two more.
const TERMS: usize = 4;
/// Standard deviations of the mean noise power beyond which a change is none of noise.
const CERTAIN: f64 = 6.0;

/// Compares displacements (m, every `dt` s) of the same check motion: `before` when the drive was learnt, `now`.
pub fn stale(before: &[f64], now: &[f64], dt: f64) -> Result<Staleness, StaleError> {
    if before.len() != now.len() || before.len() < SAMPLES {
        return Err(StaleError::Length { first: before.len(), second: now.len(), least: SAMPLES });
    }
    let (x, y) = (transform(before), transform(now));
    let difference: Vec<Complex<f64>> = y.iter().zip(&x).map(|(y, x)| y - x).collect();
    let width = 1.0 / (before.len() as f64 * dt);
    let bin = |f: f64| ((f / width).round() as usize).min(x.len() - 1);
    let (first, last) = (bin(BAND.0).max(2), bin(BAND.1));
    let power = |bins: &[Complex<f64>]| bins.iter().map(Complex::norm_sqr).sum::<f64>();
    let (from, to) = (bin(NOISE.0.min(0.7 * NOISE.1 / dt)), bin(NOISE.1 / dt));
    let noise = floor(&difference, from, to);
    let strong = power(&x[first..=last]);
    // A run beside a copy of itself has no noise in the difference, but its own is there.
    let rests = noise.max(floor(&x, from, to));
    if strong.is_nan() || strong <= 100.0 * rests * (last - first) as f64 {
        return Err(StaleError::Still { from: BAND.0, to: BAND.1 });
    }
    let omega = |i: usize| TAU * i as f64 * width;
    let scale = TAU * BAND.1;
    let term = |i: usize, k: usize| x[i] * Complex::new(0.0, omega(i) / scale).powu(k as u32);
    let slow = fitted(first, last, &difference, noise, &term);
    let rest: Vec<Complex<f64>> = (first..=last)
        .map(|i| difference[i] - (0..TERMS).map(|k| term(i, k) * slow[k]).sum::<Complex<f64>>())
        .collect();
    let mut by_frequency = Vec::new();
    let mut worst: Option<(f64, f64)> = None;
    let mut low = first;
    while low < last {
        let high = ((low as f64 * 2f64.powf(1.0 / 6.0)).ceil() as usize).max(low + 3).min(last + 1);
        let (left, own) = (power(&rest[low - first..high - first]), power(&x[low..high]));
        let count = (high - low) as f64;
        // The mean of so many powers of noise, each distributed exponentially.
        let ratio = left / (count * noise);
        let change = ((left - count * noise).max(0.0) / own).sqrt();
        let frequency = (low as f64 * (high - 1) as f64).sqrt() * width;
        by_frequency.push((frequency, change, ratio));
        // What hardly moves says nothing of the specimen.
        let moves = own > 30.0 * count * noise;
        if moves && ratio > 1.0 + CERTAIN / count.sqrt() && change > LEAST && worst.is_none_or(|(c, _)| change > c) {
            worst = Some((change, frequency));
        }
        low = high;
    }
    let (change, frequency) = worst.unwrap_or((0.0, f64::NAN));
    let delay = -slow.get(1).copied().unwrap_or(0.0) / scale;
    Ok(Staleness { stale: worst.is_some(), change, frequency, gain: slow[0], delay, by_frequency })
}

/// Mean power of a bin of noise.
fn floor(bins: &[Complex<f64>], from: usize, to: usize) -> f64 {
    let mut powers: Vec<f64> =
        bins[from.min(to)..to.max(from + 1).min(bins.len())].iter().map(Complex::norm_sqr).collect();
    let middle = powers.len() / 2;
    if powers.is_empty() {
        return f64::MIN_POSITIVE;
    }
    // The median of an exponential distribution is ln 2 of its mean; hum does not disturb it.
    (*powers.select_nth_unstable_by(middle, f64::total_cmp).1 / 2f64.ln()).max(f64::MIN_POSITIVE)
}

/// Real coefficients of the slow terms by least squares.
fn fitted(
    first: usize,
    last: usize,
    difference: &[Complex<f64>],
    noise: f64,
    term: &dyn Fn(usize, usize) -> Complex<f64>,
) -> Vec<f64> {
    let (mut matrix, mut right) = (DMatrix::<f64>::zeros(TERMS, TERMS), DVector::<f64>::zeros(TERMS));
    for (i, change) in difference.iter().enumerate().take(last + 1).skip(first) {
        let terms: Vec<Complex<f64>> = (0..TERMS).map(|k| term(i, k)).collect();
        // Every frequency counts alike as far as it moves: where noise exceeds the least change that matters, it counts less.
        let weight = 1.0 / (LEAST * LEAST * terms[0].norm_sqr() + noise).max(f64::MIN_POSITIVE);
        for (a, x) in terms.iter().enumerate() {
            right[a] += weight * (x.conj() * change).re;
            for (b, y) in terms.iter().enumerate() {
                matrix[(a, b)] += weight * (x.conj() * y).re;
            }
        }
    }
    matrix.cholesky().map_or_else(|| vec![0.0; TERMS], |c| c.solve(&right).iter().copied().collect())
}

/// Spectrum less the mean, Hann-tapered.
fn transform(values: &[f64]) -> Vec<Complex<f64>> {
    let n = values.len();
    let mean = values.iter().sum::<f64>() / n as f64;
    let mut tapered: Vec<f64> = values
        .iter()
        .enumerate()
        .map(|(k, x)| (x - mean) * (0.5 - 0.5 * (2.0 * PI * k as f64 / n as f64).cos()))
        .collect();
    let forward = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let mut bins = forward.make_output_vec();
    // The buffers are made for this plan: their lengths cannot be wrong.
    let _ = forward.process(&mut tapered, &mut bins);
    bins.iter().map(|c| Complex::new(c.re, c.im)).collect()
}

/// A check motion at `rate` (Hz): displacement, m, at rest at both ends, that sweeps once through the band while the velocity stays at
/// `speed` (m/s) and the displacement below `reach` (m).
pub fn check_motion(rate: f64, speed: f64, reach: f64) -> Vec<f64> {
    let (seconds, rest) = (24.0, 1.0);
    let count = ((seconds + 2.0 * rest) * rate) as usize;
    let growth = (BAND.1 / BAND.0).ln() / seconds;
    (0..count)
        .map(|k| {
            let t = k as f64 / rate - rest;
            if !(0.0..=seconds).contains(&t) {
                return 0.0;
            }
            let frequency = BAND.0 * (growth * t).exp();
            let phase = TAU * BAND.0 / growth * ((growth * t).exp() - 1.0);
            let fade = ((t / 1.5).min((seconds - t) / 1.5)).clamp(0.0, 1.0);
            reach.min(speed / (TAU * frequency)) * fade * fade * (3.0 - 2.0 * fade) * phase.sin()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A second-order answer with a resonance on top, and noise.
    fn answer(gain: f64, late: usize, resonance: f64, seed: u64) -> Vec<f64> {
        let drive = check_motion(500.0, 0.02, 0.01);
        let (dt, w) = (2e-3, TAU * resonance);
        let (mut u, mut v, mut state) = (0.0, 0.0, seed);
        let mut noise = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            2e-6 * ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5)
        };
        (0..drive.len())
            .map(|k| {
                let r = gain * drive[k.saturating_sub(late)];
                v += dt * (w * w * (r - u) - 0.08 * w * v);
                u += dt * v;
                0.9 * r + 0.02 * u + noise()
            })
            .collect()
    }

    #[test]
    fn a_softened_resonance_is_stale_and_a_warmer_table_is_not() {
        let before = answer(1.0, 5, 4.0, 1);
        let same = stale(&before, &answer(1.0, 5, 4.0, 2), 2e-3).unwrap();
        assert!(!same.stale && same.gain.abs() < 1e-3, "{same:?}");
        let warm = stale(&before, &answer(1.01, 6, 4.0, 3), 2e-3).unwrap();
        assert!(!warm.stale, "{warm:?}");
        assert!((warm.gain - 0.01).abs() < 3e-3 && (warm.delay - 2e-3).abs() < 6e-4, "{warm:?}");
        let soft = stale(&before, &answer(1.0, 5, 3.6, 4), 2e-3).unwrap();
        assert!(soft.stale && (3.0..4.6).contains(&soft.frequency), "{soft:?}");
    }

    #[test]
    fn runs_that_differ_or_rest_are_refused() {
        let before = answer(1.0, 5, 4.0, 1);
        assert!(matches!(stale(&before, &before[1..], 2e-3), Err(StaleError::Length { .. })));
        let still: Vec<f64> = before.iter().map(|x| 1e-5 * x).collect();
        let noisy: Vec<f64> = answer(0.0, 5, 4.0, 9);
        let sum: Vec<f64> = still.iter().zip(&noisy).map(|(a, b)| a + b).collect();
        assert!(matches!(stale(&sum, &noisy, 2e-3), Err(StaleError::Still { .. })));
    }
}
