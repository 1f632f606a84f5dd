//! How one channel agrees with a derivative of another, bin by bin where both carry signal.

use crate::recording::signal::{Spectra, quantile, segment_length, spectra};
use realfft::num_complex::Complex64;
use std::f64::consts::PI;

/// What two channels say about each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Agreement {
    /// Lowest frequency at which they are coherent, Hz.
    pub(super) from_hz: f64,
    /// Highest such frequency, Hz.
    pub(super) to_hz: f64,
    /// Size of the second against the derivative of the first.
    pub(super) gain: f64,
    /// Farthest that it is from one at any frequency, as a logarithm.
    pub(super) farthest: f64,
    /// Power of frequency with which that size changes.
    pub(super) slope: f64,
    /// They run against each other.
    pub(super) turned: bool,
    /// Whether they do above [`TILTING`], and the size there; none where too little is seen there.
    pub(super) fast: Option<(bool, f64)>,
    /// Both carry signal, but not the same.
    pub(super) unrelated: bool,
    /// Size at the lowest coherent frequencies.
    pub(super) low_gain: f64,
    /// They run against each other at the lowest coherent frequencies.
    pub(super) low_turned: bool,
    /// How well one sign and one delay explain the phases below 8 Hz, 0 to 1.
    pub(super) in_step: f64,
    /// Coherent bins below 8 Hz.
    pub(super) slow_bins: usize,
    /// How far the second leads the first beyond doubt, s; zero where it does not.
    pub(super) lead_s: f64,
}

/// One frequency at which both channels are coherent.
#[derive(Debug, Clone, Copy)]
pub(in crate::recording) struct Bin {
    /// Hz.
    pub(in crate::recording) frequency: f64,
    /// Size of the second against the derivative of the first.
    pub(in crate::recording) gain: f64,
    /// Phase of the second against the derivative of the first, rad.
    pub(in crate::recording) phase: f64,
    /// Weight: the inverse variance of the phase.
    pub(in crate::recording) weight: f64,
}

impl Bin {
    /// A bin of the spectra of a channel and one that is to be its derivative of the `order`.
    pub(in crate::recording) fn of(spectra: &Spectra, k: usize, order: u32) -> Self {
        let (frequency, coherence) = (spectra.frequency[k], spectra.coherence(k));
        let derivative = (2.0 * PI * frequency).powi(order.cast_signed());
        Self {
            frequency,
            gain: (spectra.output[k] / spectra.input[k]).sqrt() / derivative,
            phase: spectra.cross[k].arg() - f64::from(order) * PI / 2.0,
            weight: coherence / (1.0 - coherence).max(1e-3),
        }
    }
}

/// Lowest frequency that is looked at, Hz: below it drift and tilt are larger than motion.
const LOWEST: f64 = 0.2;

/// Frequency below which gravity on a tilting accelerometer may outweigh the motion, Hz: up to 25 rad of tilt a metre of
/// travel, far more than any table has.
const TILTING: f64 = 2.5;

/// Below this frequency a sensor's delay turns no sign, Hz.
const SLOW: f64 = 8.0;

/// Power below this part of the strongest line's is not used.
const RANGE: f64 = 1e-5;

/// How far above the floor of its upper half band a channel's power must stand to be motion. A sensor's noise rises towards low
/// frequencies, flicker tenfold a decade, and a loop carries it to the table, where it is coherent with all that the table does.
const ABOVE_NOISE: f64 = 300.0;

/// Fewest coherent bins from which anything is said.
const FEWEST: usize = 3;

/// The coherent bins of `second` against the `order`-th derivative of `first`, and whether both carry signal elsewhere.
pub(in crate::recording) fn coherent_bins(first: &[f64], second: &[f64], dt: f64, order: u32) -> (Vec<Bin>, bool) {
    let longest = (10.0 / dt) as usize;
    let spectra = spectra_of(first, second, dt, order, segment_length(first.len(), longest));
    if spectra.segments < 4 {
        return (Vec::new(), false);
    }
    let floor = |power: &[f64]| {
        // The quietest tenth of the upper half band is noise; with none, the arithmetic's own.
        let upper = quantile(&power[power.len() / 2..], 0.1);
        upper.max(1e-24 * power.iter().copied().fold(0.0, f64::max))
    };
    let (input_floor, output_floor) = (floor(&spectra.input), floor(&spectra.output));
    let derived = |k: usize| spectra.input[k] * (2.0 * PI * spectra.frequency[k]).powi(2 * order.cast_signed());
    // Far below the strongest lines a window's own leakage is all there is: of Hann's a tenth of m^-6 in power, m bins away.
    let used = |k: &usize| *k >= 2 && (LOWEST..0.35 / dt).contains(&spectra.frequency[*k]);
    let strongest = (0..spectra.frequency.len())
        .filter(used)
        .fold((0.0f64, 0.0f64), |(a, b), k| (a.max(derived(k)), b.max(spectra.output[k])));
    let loudest =
        (1..spectra.input.len()).fold(0, |best, k| if spectra.input[k] > spectra.input[best] { k } else { best });
    let leaked = |k: usize| spectra.input[loudest] / (k.abs_diff(loudest).max(3) as f64).powi(6);
    let threshold = threshold(spectra.segments);
    let (mut bins, mut strange, mut signal) = (Vec::new(), 0, 0);
    for k in (0..spectra.frequency.len()).filter(used) {
        if derived(k) < RANGE * strongest.0 || spectra.output[k] < RANGE * strongest.1 {
            continue;
        }
        // A loop carries its sensor's noise to the table: where displacement is noise, what follows it is no motion.
        if spectra.input[k] < ABOVE_NOISE * input_floor || spectra.input[k] < leaked(k) {
            continue;
        }
        let coherence = spectra.coherence(k);
        if spectra.output[k] > ABOVE_NOISE * output_floor {
            signal += 1;
            strange += usize::from(coherence < 0.15);
        }
        if coherence > threshold {
            bins.push(Bin::of(&spectra, k, order));
        }
    }
    let unrelated = signal >= 6 && strange * 5 > signal * 4 && bins.len() * 5 < signal;
    (bins, unrelated)
}

/// Spectra of two channels, the first through its differences of the `order`: a displacement falls off so steeply that what a window
/// leaks of its slow motion hides the rest.
pub(in crate::recording) fn spectra_of(first: &[f64], second: &[f64], dt: f64, order: u32, segment: usize) -> Spectra {
    let mut spectra = spectra(&differences(first, order), second, dt, segment);
    // At half the sampling rate a first difference leaves nothing to divide.
    for k in 1..spectra.frequency.len().saturating_sub(1) {
        let angle = 2.0 * PI * spectra.frequency[k] * dt;
        // What the differences make of a sine: j sin(w dt) for the first, -4 sin(w dt / 2)^2 for the second.
        let (size, sign) = match order {
            1 => (angle.sin(), Complex64::i()),
            2 => (4.0 * (0.5 * angle).sin().powi(2), Complex64::new(-1.0, 0.0)),
            _ => continue,
        };
        let size = size.max(f64::MIN_POSITIVE);
        spectra.input[k] /= size * size;
        spectra.cross[k] *= sign / size;
    }
    spectra
}

/// Central differences, samples apart; the ends as their neighbours.
fn differences(series: &[f64], order: u32) -> Vec<f64> {
    let difference = |w: &[f64]| match (order, w) {
        (1, [before, _, after]) => 0.5 * (after - before),
        (2, [before, now, after]) => before - 2.0 * now + after,
        (_, [_, now, _]) => *now,
        _ => f64::NAN,
    };
    let inner: Vec<f64> = series.windows(3).map(difference).collect();
    let (Some(&from), Some(&to)) = (inner.first(), inner.last()) else { return series.to_vec() };
    std::iter::once(from).chain(inner).chain([to]).collect()
}

/// Coherence that chance exceeds once in a thousand bins, and at least a half.
fn threshold(segments: usize) -> f64 {
    let count = (0.6 * segments as f64).max(2.0);
    (1.0 - 1e-3f64.powf(1.0 / (count - 1.0))).clamp(0.5, 0.95)
}

/// Compares `second` with the `order`-th derivative of `first`; none where too little of either is signal.
pub(super) fn agreement(first: &[f64], second: &[f64], dt: f64, order: u32) -> Option<Agreement> {
    let (bins, unrelated) = coherent_bins(first, second, dt, order);
    if bins.len() < FEWEST && !unrelated {
        return None;
    }
    let low = &bins[..bins.len().div_ceil(4).max(FEWEST).min(bins.len())];
    // Higher up a delay of some samples turns the phase as well: what is seen there alone says nothing of signs.
    let told = bins.partition_point(|b| b.frequency < SLOW);
    let slow = told.max(low.len());
    let (turned, delay) = alignment(&bins[..slow]);
    let (low_turned, _) = alignment(low);
    let (turned, low_turned) = (turned && told >= FEWEST, low_turned && told >= FEWEST);
    let fast = &bins[bins.partition_point(|b| b.frequency < TILTING).min(slow)..slow];
    let from_hz = bins.first().map_or(LOWEST, |b| b.frequency);
    Some(Agreement {
        from_hz,
        to_hz: bins.last().map_or(0.35 / dt, |b| b.frequency),
        gain: typical_gain(&bins),
        farthest: bins.iter().fold(0.0, |most, bin| bin.gain.ln().abs().max(most)),
        slope: slope(&bins),
        turned,
        fast: (fast.len() >= FEWEST).then(|| (alignment(fast).0, typical_gain(fast))),
        unrelated,
        low_gain: typical_gain(low),
        low_turned,
        lead_s: lead(&bins[..slow], delay_over(&bins[..slow]), dt),
        slow_bins: slow,
        in_step: in_step(&bins[..slow], turned, delay),
    })
}

/// How far the second comes before the first, where that is beyond doubt: a loop may lead a little at its slowest, and
/// few bins know little.
fn lead(bins: &[Bin], delay: f64, dt: f64) -> f64 {
    let information: f64 = bins.iter().map(|b| b.weight * (2.0 * PI * b.frequency).powi(2)).sum();
    let doubt = (3.0 * dt).max(0.02).max(8.0 / information.max(f64::MIN_POSITIVE).sqrt());
    if bins.len() >= 6 && -delay > doubt { -delay } else { 0.0 }
}

fn in_step(bins: &[Bin], turned: bool, delay: f64) -> f64 {
    let sum = |f: &dyn Fn(&Bin) -> f64| bins.iter().map(f).sum::<f64>();
    let aligned = sum(&|b| b.weight * (b.phase + 2.0 * PI * b.frequency * delay).cos());
    let sign = if turned { -1.0 } else { 1.0 };
    (sign * aligned / sum(&|b| b.weight).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
}

fn typical_gain(bins: &[Bin]) -> f64 {
    let logs: Vec<f64> = bins.iter().map(|b| b.gain.ln()).collect();
    quantile(&logs, 0.5).exp()
}

/// Slope of the gain over frequency, both logarithmic, by Theil and Sen; zero where the band is too narrow to tell.
fn slope(bins: &[Bin]) -> f64 {
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return 0.0 };
    if last.frequency < 2.5 * first.frequency || bins.len() < 6 {
        return 0.0;
    }
    // A line of hum is one bin: the median over all pairs far enough apart does not follow it.
    let apart = |a: &Bin, b: &Bin| b.frequency > 1.5 * a.frequency;
    let pairs = bins.iter().enumerate().flat_map(|(i, a)| bins[i + 1..].iter().map(move |b| (a, b)));
    let slopes: Vec<f64> = pairs
        .filter(|(a, b)| apart(a, b))
        .map(|(a, b)| (b.gain / a.gain).ln() / (b.frequency / a.frequency).ln())
        .collect();
    quantile(&slopes, 0.5)
}

/// Whether the signs differ, and the delay of the second after the first, s: the pair that lines the phases up best,
/// among delays short enough that one cannot stand in for the other.
pub(in crate::recording) fn alignment(bins: &[Bin]) -> (bool, f64) {
    let total: f64 = bins.iter().map(|b| b.weight).sum();
    let centre = bins.iter().map(|b| b.weight * b.frequency).sum::<f64>() / total.max(f64::MIN_POSITIVE);
    let longest = 0.2 / centre.max(1e-3);
    let score =
        |delay: f64| bins.iter().map(|b| b.weight * (b.phase + 2.0 * PI * b.frequency * delay).cos()).sum::<f64>();
    let (best, worst) = (highest(score, -longest, longest), highest(|d| -score(d), -longest, longest));
    let turned = -score(worst) > score(best);
    (turned, if turned { worst } else { best })
}

/// Delay of the second after the first, s, whatever its length: found at the lowest frequencies, where it cannot be
/// mistaken for a whole period more, then followed upwards.
pub(in crate::recording) fn delay_over(bins: &[Bin]) -> f64 {
    let (turned, mut delay) = alignment(&bins[..bins.len().div_ceil(4)]);
    let sign = if turned { -1.0 } else { 1.0 };
    for part in 2..=8 {
        let part = &bins[..bins.len() * part / 8];
        let reach = 0.25 / part.last().map_or(1.0, |b| b.frequency);
        let score =
            |d: f64| sign * part.iter().map(|b| b.weight * (b.phase + 2.0 * PI * b.frequency * d).cos()).sum::<f64>();
        delay = highest(score, delay - reach, delay + reach);
    }
    delay
}

/// Where a function is highest: a grid, then a parabola through the best point and its neighbours.
fn highest(score: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const STEPS: i32 = 200;
    let at = |k: i32| from + (to - from) * f64::from(k) / f64::from(STEPS);
    let best =
        (0..=STEPS).map(|k| (k, score(at(k)))).fold((0, f64::NEG_INFINITY), |b, c| if c.1 > b.1 { c } else { b });
    if best.0 == 0 || best.0 == STEPS {
        return at(best.0);
    }
    let (before, after) = (score(at(best.0 - 1)), score(at(best.0 + 1)));
    let bend = before - 2.0 * best.1 + after;
    let shift = if bend < 0.0 { 0.5 * (before - after) / bend } else { 0.0 };
    at(best.0) + shift * (at(1) - at(0))
}
