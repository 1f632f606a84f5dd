//! The line in the accelerometer's residual that a hum would start from.
//!
//! Samples that are held back are missing from the residual, in stretches, and put side bands beside every line. A line is
//! therefore told from a resonance by what one sine, fitted to the samples there are, takes away of the power around it.

use super::residual::{residual, spectrum};
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::predict;
use crate::identify::fit::Fit;
use crate::plant::simulate::SimulateError;
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::TAU;

/// Where a hum starts when the residual shows nothing, Hz.
const MAINS: f64 = 50.0;
/// Lowest frequency of a line, how far around it is looked, and over how much a peak is compared with its neighbours, Hz.
const LOWEST: f64 = 5.0;
const AROUND: f64 = 1.0;
const NEIGHBOURS: f64 = 5.0;
/// Peaks of the spectrum that are tried, those that stand highest above their neighbours first.
const TRIED: usize = 8;
/// Share of the power around it that one sine takes away where it is a line: one that breathes by a fifth leaves a fiftieth, a
/// sine takes less than half of a resonance of two hundredths damping in two hundred of its periods.
const LINE: f64 = 0.65;
/// Parts of a series of which the loudest may have a line, and the fewest samples of one.
const PARTS: usize = 10;
const SHORTEST: usize = 256;
/// Steps of a bin in which the frequency is looked for on either side of a peak.
const STEPS: i32 = 10;

/// The strongest line in the accelerometer's residual, Hz.
pub(super) fn strongest_line(runs: &[Run], baseline: &Fit) -> Result<f64, SimulateError> {
    let Some((run, local)) = runs.iter().zip(&baseline.locals).max_by_key(|(r, _)| r.len()) else { return Ok(MAINS) };
    let predicted = predict(&baseline.model, run, local)?;
    let Some(series) = residual(run, &predicted, Channel::Acceleration) else { return Ok(MAINS) };
    Ok(of_all_or_a_part(&series, run.dt).unwrap_or(MAINS))
}

/// The strongest line of a series, or of its loudest part where the whole has none: what hums for a while is no line of the whole.
fn of_all_or_a_part(series: &[f64], dt: f64) -> Option<f64> {
    let whole = strongest(series, dt);
    if whole.is_some_and(|(_, is_line)| is_line) {
        return whole.map(|(frequency, _)| frequency);
    }
    let length = (series.len() / PARTS).max(SHORTEST);
    let power = |part: &[f64]| part.iter().filter(|x| x.is_finite()).map(|x| x * x).sum::<f64>();
    let parts =
        (0..series.len()).step_by((length / 2).max(1)).map(|from| &series[from..(from + length).min(series.len())]);
    let loudest = parts.max_by(|a, b| power(a).total_cmp(&power(b)));
    let part = loudest.and_then(|part| strongest(part, dt)).filter(|(_, is_line)| *is_line);
    part.or(whole).map(|(frequency, _)| frequency)
}

/// The strongest line of a series, Hz, and true; where none is one, the peak that is nearest to it. Samples that are not finite are
/// missing.
fn strongest(series: &[f64], dt: f64) -> Option<(f64, bool)> {
    let power = padded_spectrum(series);
    let hz = 0.5 / (dt * (power.len() - 1) as f64);
    let (lowest, around) = ((LOWEST / hz) as usize, ((AROUND / hz) as usize).max(4));
    let neighbours = (NEIGHBOURS / hz) as usize + 4;
    let peak = |&i: &usize| power[i] >= power[i - 1] && power[i] >= power[i + 1];
    let stands = |i: usize| {
        let mut around = power[i.saturating_sub(neighbours)..(i + neighbours).min(power.len())].to_vec();
        let middle = around.len() / 2;
        (power[i] / around.select_nth_unstable_by(middle, f64::total_cmp).1.max(f64::MIN_POSITIVE), i)
    };
    let blocks =
        (lowest.max(1)..power.len() - 1).step_by(around).map(|from| from..(from + around).min(power.len() - 1));
    let strongest = |block: std::ops::Range<usize>| block.filter(peak).max_by(|&a, &b| power[a].total_cmp(&power[b]));
    let mut peaks: Vec<(f64, usize)> = blocks.filter_map(strongest).map(stands).collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    // A side band is not tried for the line that it belongs to.
    let mut apart: Vec<usize> = Vec::new();
    for (_, peak) in peaks {
        if apart.len() < TRIED && apart.iter().all(|a| a.abs_diff(peak) > around) {
            apart.push(peak);
        }
    }
    let tried = apart.into_iter().filter_map(|peak| {
        let (frequency, without) = one_sine(series, dt, (peak as f64 * hz, hz))?;
        let band =
            |power: &[f64]| power[peak.saturating_sub(around)..(peak + around).min(power.len())].iter().sum::<f64>();
        let left = band(&padded_spectrum(&without)) / band(&power).max(f64::MIN_POSITIVE);
        Some((frequency, 1.0 - left, power[peak]))
    });
    let tried: Vec<(f64, f64, f64)> = tried.collect();
    // Among lines the strongest, for a harmonic may stand higher above its quieter neighbours.
    let line = tried.iter().filter(|(_, share, _)| *share > LINE).max_by(|a, b| a.2.total_cmp(&b.2));
    let nearest = || tried.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    line.map(|&(frequency, ..)| (frequency, true)).or_else(|| nearest().map(|&(frequency, ..)| (frequency, false)))
}

fn padded_spectrum(series: &[f64]) -> Vec<f64> {
    let size = series.len().next_power_of_two().max(16);
    let mut padded = series.to_vec();
    padded.resize(size, 0.0);
    spectrum(&padded, size)
}

/// The frequency (Hz) near a bin of a width (Hz) whose sine takes most away, and what it leaves.
fn one_sine(series: &[f64], dt: f64, (near, width): (f64, f64)) -> Option<(f64, Vec<f64>)> {
    let fit = |frequency: f64| {
        let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for (k, x) in series.iter().enumerate().filter(|(_, x)| x.is_finite()) {
            let row = wave(frequency, dt, k);
            matrix += row * row.transpose();
            right += row * *x;
        }
        let weights = matrix.try_inverse()? * right;
        Some((weights.dot(&right), weights, frequency))
    };
    let tried = (-STEPS..=STEPS).map(|i| near + f64::from(i) / f64::from(STEPS) * width);
    let (_, weights, frequency) = tried.filter_map(fit).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let without = series.iter().enumerate().map(|(k, x)| x - weights.dot(&wave(frequency, dt, k)));
    Some((frequency, without.collect()))
}

/// Sine and cosine at a sample.
fn wave(frequency: f64, dt: f64, sample: usize) -> Vector2<f64> {
    let (sine, cosine) = (TAU * frequency * sample as f64 * dt).sin_cos();
    Vector2::new(sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    /// A resonance that noise drives beside a hum that breathes, in stretches of which each third is missing.
    fn series(frequency: f64, hum: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let (mut before, mut last) = (0.0, 0.0);
        let value = |k: usize| {
            let t = 1e-3 * k as f64;
            let pole = (-TAU * 0.4e-3_f64).exp();
            let next =
                2.0 * pole * (TAU * 22e-3_f64).cos() * last - pole * pole * before + random.random_range(-1.0..1.0);
            (before, last) = (last, next);
            let held_back = (k / 500) % 3 == 2;
            let breath = 1.0 + 0.2 * (TAU * 0.11 * t).cos();
            if held_back { f64::NAN } else { next + hum * breath * (TAU * frequency * t).sin() }
        };
        (0..8000).map(value).collect()
    }

    #[test]
    fn a_line_is_found_within_a_twentieth_of_a_bin_whatever_is_held_back() {
        for frequency in [59.966, 50.02, 17.3, 119.91] {
            let found = of_all_or_a_part(&series(frequency, 20.0), 1e-3).unwrap();
            assert!((found - frequency).abs() < 0.006, "{found} for {frequency}");
        }
    }

    #[test]
    fn a_resonance_that_stands_higher_is_not_the_line() {
        let series = series(50.02, 2.0);
        let power = padded_spectrum(&series);
        let tallest = (40..power.len()).max_by(|&a, &b| power[a].total_cmp(&power[b])).unwrap();
        assert!((tallest as f64 / 8.192 - 22.0).abs() < 2.0, "the resonance is to stand higher");
        let found = of_all_or_a_part(&series, 1e-3).unwrap();
        assert!((found - 50.02).abs() < 0.02, "{found}");
    }

    #[test]
    fn what_hums_for_a_while_is_found() {
        // A resonance is a line to a part that is shorter than it rings: it must not be as strong.
        let mut series: Vec<f64> = series(50.02, 0.0).into_iter().map(|x| 0.2 * x).collect();
        for (k, x) in series.iter_mut().enumerate().filter(|(k, _)| (3000..4300).contains(k)) {
            *x += 30.0 * (TAU * 50.02e-3 * k as f64).sin();
        }
        assert!(!strongest(&series, 1e-3).unwrap().1, "no line of the whole");
        let found = of_all_or_a_part(&series, 1e-3).unwrap();
        assert!((found - 50.02).abs() < 0.1, "{found}");
    }

    #[test]
    fn nothing_is_no_line() {
        assert_eq!(of_all_or_a_part(&[f64::NAN; 1000], 1e-3), None);
    }
}
