//! Signals at another sampling interval.

use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// What a signal is taken to be between its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// A straight line, as response spectra and digitised records take it. Nothing keeps it from aliasing.
    Linear,
    /// Band-limited: a Kaiser-windowed sinc over 32 crossings to each side. Below 0.84 of the lower Nyquist frequency the
    /// gain is 1 within 1e-4, above it (where samples become fewer) under 1e-4. Ends are held.
    BandLimited,
}

/// Zero crossings of the sinc to each side.
const CROSSINGS: f64 = 32.0;
/// Shape of the Kaiser window: 81 dB.
const BETA: f64 = 8.0;
/// The window before it is scaled to one in the middle.
static WINDOW_PEAK: LazyLock<f64> = LazyLock::new(|| bessel_i0(BETA));
/// Where samples become fewer, the cut-off is this share of the new Nyquist frequency, so that the transition ends there.
const CUT: f64 = 0.92;

/// A signal sampled every `from` s, resampled to every `to` s over the same time.
pub(crate) fn resample(signal: &[f64], from: f64, to: f64, interpolation: Interpolation) -> Vec<f64> {
    if signal.is_empty() || !(from > 0.0 && to > 0.0) {
        return Vec::new();
    }
    // A millionth of a step keeps the last sample where the ratio is whole but for rounding.
    let count = ((signal.len() - 1) as f64 * from / to + 1e-6).floor() as usize + 1;
    let place = |k: usize| k as f64 * to / from;
    match interpolation {
        Interpolation::Linear => (0..count).map(|k| linear(signal, place(k))).collect(),
        Interpolation::BandLimited => {
            let cutoff = if to > from { CUT * from / to } else { 1.0 };
            (0..count).map(|k| band_limited(signal, place(k), cutoff)).collect()
        }
    }
}

/// The value at a place counted in samples, on a straight line between two; the ends are held.
pub(crate) fn linear(signal: &[f64], place: f64) -> f64 {
    let last = signal.len().saturating_sub(1);
    let at = (place.floor().max(0.0) as usize).min(last);
    let (a, b) = (signal[at], signal[(at + 1).min(last)]);
    a + (b - a) * (place - at as f64).clamp(0.0, 1.0)
}

/// The value at a place counted in samples, by a windowed sinc of a cut-off counted in the Nyquist frequency.
fn band_limited(signal: &[f64], place: f64, cutoff: f64) -> f64 {
    let reach = CROSSINGS / cutoff;
    let last = signal.len().cast_signed() - 1;
    let (mut sum, mut weights) = (0.0, 0.0);
    for i in (place - reach).ceil() as isize..=(place + reach).floor() as isize {
        let distance = place - i as f64;
        let weight = kernel(distance * cutoff);
        sum += weight * signal[i.clamp(0, last).cast_unsigned()];
        weights += weight;
    }
    sum / weights
}

/// The windowed sinc at a distance counted in crossings.
pub(super) fn kernel(distance: f64) -> f64 {
    let edge = 1.0 - (distance / CROSSINGS).powi(2);
    if edge < 0.0 {
        return 0.0;
    }
    let sinc = if distance.abs() < 1e-12 { 1.0 } else { (PI * distance).sin() / (PI * distance) };
    sinc * bessel_i0(BETA * edge.sqrt()) / *WINDOW_PEAK
}

/// Crossings of the kernel to each side.
pub(super) const REACH: usize = CROSSINGS as usize;

/// Modified Bessel function of the first kind, order 0, by its power series.
fn bessel_i0(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= quarter / f64::from(k * k);
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sine(frequency: f64, dt: f64, seconds: f64) -> Vec<f64> {
        (0..(seconds / dt) as usize).map(|k| (2.0 * PI * frequency * k as f64 * dt).sin()).collect()
    }

    fn interior(signal: &[f64]) -> &[f64] {
        &signal[signal.len() / 4..3 * signal.len() / 4]
    }

    #[test]
    fn samples_that_stay_are_kept() {
        let signal = sine(7.0, 0.02, 20.0);
        let fine = resample(&signal, 0.02, 0.001, Interpolation::BandLimited);
        for (k, x) in signal.iter().enumerate() {
            assert!((fine[20 * k] - x).abs() < 1e-12);
        }
    }

    #[test]
    fn a_sine_below_the_band_edge_survives_both_ways() {
        for (from, to) in [(0.01, 0.001), (0.01, 1.0 / 333.0), (0.001, 0.01), (0.005, 1.0 / 204.8)] {
            let frequency = 0.8 * 0.5 / f64::max(from, to);
            let out = resample(&sine(frequency, from, 20.0), from, to, Interpolation::BandLimited);
            let want = sine(frequency, to, 20.0);
            let worst =
                interior(&out).iter().zip(interior(&want[..out.len()])).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 2e-4, "{from} to {to}: {worst}");
        }
    }

    #[test]
    fn what_would_alias_is_taken_out() {
        let out = resample(&sine(55.0, 0.001, 20.0), 0.001, 0.01, Interpolation::BandLimited);
        let worst = interior(&out).iter().fold(0.0, |p: f64, x| x.abs().max(p));
        assert!(worst < 2e-4, "{worst}");
        // The straight line lets it through, which shows that the test can fail.
        let aliased = resample(&sine(55.0, 0.001, 20.0), 0.001, 0.01, Interpolation::Linear);
        assert!(interior(&aliased).iter().any(|x| x.abs() > 0.5));
    }

    proptest! {
        #[test]
        fn a_constant_stays_and_the_duration_too(
            value in -5.0..5.0f64, n in 2..400usize, from in 0.001..0.05f64, to in 0.001..0.05f64
        ) {
            for interpolation in [Interpolation::Linear, Interpolation::BandLimited] {
                let out = resample(&vec![value; n], from, to, interpolation);
                prop_assert!(out.iter().all(|x| (x - value).abs() < 1e-12));
                let (before, after) = ((n - 1) as f64 * from, (out.len() - 1) as f64 * to);
                prop_assert!(after <= before + 1e-6 && after > before - to - 1e-6);
            }
        }
    }
}
