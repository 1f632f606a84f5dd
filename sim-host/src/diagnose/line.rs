//! The line in the accelerometer's residual that a hum would start from.
//!
//! Samples that are held out are missing from the residual, in stretches, and put side bands beside every line. A line is
//! therefore distinguished from a resonance by what one sine, fitted to the samples there are, takes away of the power around it.

use super::residual::{of_longest, padded_spectrum};
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Fit;
use crate::plant::simulate::SimulateError;
use crate::recording::signal::{Sine, quantile};

/// Where a hum starts when the residual shows nothing, Hz.
const MAINS: f64 = 50.0;
/// Lowest frequency of a line, how far around it is looked, and over how much a peak is compared with its neighbours, Hz.
const LOWEST: f64 = 5.0;
const AROUND: f64 = 1.0;
const NEIGHBOURS: f64 = 5.0;
/// Peaks of the spectrum that are tried, those that stand highest above their neighbours first.
const TRIED: usize = 8;
/// Share of the power around it that one sine takes away where it is a line: of one that breathes by a fifth
/// a fiftieth is left, of a resonance with a damping of 0.02, over two hundred of its periods, more than half.
const LINE: f64 = 0.65;
/// Parts of a series of which the loudest may have a line, and the fewest samples of one.
const PARTS: usize = 10;
const SHORTEST: usize = 256;
/// Steps of a bin in which the frequency is looked for on either side of a peak.
const STEPS: i32 = 10;

/// The strongest line in the accelerometer's residual, Hz.
pub(super) fn strongest_line(runs: &[Run], baseline: &Fit) -> Result<f64, SimulateError> {
    let shown = of_longest(baseline, runs, &[Channel::Acceleration])?;
    Ok(shown.and_then(|(series, dt)| of_all_or_a_part(&series, dt)).unwrap_or(MAINS))
}

/// The strongest line of a series, or of its loudest part where the whole has none: what hums for a while is no line of the whole.
fn of_all_or_a_part(series: &[f64], dt: f64) -> Option<f64> {
    let whole = strongest(series, dt);
    if whole.is_some_and(|(_, is_line)| is_line) {
        return whole.map(|(line, _)| line.frequency);
    }
    let length = (series.len() / PARTS).max(SHORTEST);
    let power = |part: &[f64]| part.iter().filter(|x| x.is_finite()).map(|x| x * x).sum::<f64>();
    let parts =
        (0..series.len()).step_by((length / 2).max(1)).map(|from| &series[from..(from + length).min(series.len())]);
    let loudest = parts.max_by(|a, b| power(a).total_cmp(&power(b)));
    let part = loudest.and_then(|part| strongest(part, dt)).filter(|(_, is_line)| *is_line);
    part.or(whole).map(|(line, _)| line.frequency)
}

/// A series without its strongest line, where it has one.
pub(super) fn without_line(series: Vec<f64>, dt: f64) -> Vec<f64> {
    match strongest(&series, dt) {
        Some((line, true)) => line.taken_off(&series, dt),
        _ => series,
    }
}

/// The strongest line of a series, and true; where none is one, the peak that is nearest to it. Samples that are not finite are
/// missing.
fn strongest(series: &[f64], dt: f64) -> Option<(Sine, bool)> {
    let power = padded_spectrum(series);
    let hz = 0.5 / (dt * (power.len() - 1) as f64);
    let around = ((AROUND / hz) as usize).max(4);
    let tried = peaks(&power, hz, around).into_iter().filter_map(|peak| {
        let near = |i| (peak as f64 + f64::from(i) / f64::from(STEPS)) * hz;
        let sine = Sine::best(series, dt, (-STEPS..=STEPS).map(near))?;
        let without = padded_spectrum(&sine.taken_off(series, dt));
        let band = peak.saturating_sub(around)..(peak + around).min(power.len());
        let sum = |power: &[f64]| power[band.clone()].iter().sum::<f64>();
        Some((sine, 1.0 - sum(&without) / sum(&power).max(f64::MIN_POSITIVE), power[peak]))
    });
    let tried: Vec<(Sine, f64, f64)> = tried.collect();
    // Among lines the strongest, for a harmonic may stand higher above its quieter neighbours.
    let line = tried.iter().filter(|(_, share, _)| *share > LINE).max_by(|a, b| a.2.total_cmp(&b.2));
    let nearest = || tried.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    line.map(|&(line, ..)| (line, true)).or_else(|| nearest().map(|&(peak, ..)| (peak, false)))
}

/// The peaks of a spectrum, bins of `hz` wide, that stand highest above their neighbours; none within `around` bins of another, for a side
/// band is not tried for the line that it belongs to.
fn peaks(power: &[f64], hz: f64, around: usize) -> Vec<usize> {
    let (first, last) = (((LOWEST / hz) as usize).max(1), power.len() - 1);
    let neighbours = (NEIGHBOURS / hz) as usize + 4;
    let is_peak = |&i: &usize| power[i] >= power[i - 1] && power[i] >= power[i + 1];
    let highest = |from: usize| {
        let block = from..(from + around).min(last);
        block.filter(is_peak).max_by(|&a, &b| power[a].total_cmp(&power[b]))
    };
    let stands = |i: usize| {
        let beside = &power[i.saturating_sub(neighbours)..(i + neighbours).min(power.len())];
        (power[i] / quantile(beside, 0.5).max(f64::MIN_POSITIVE), i)
    };
    let mut peaks: Vec<(f64, usize)> = (first..last).step_by(around).filter_map(highest).map(stands).collect();
    peaks.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut apart: Vec<usize> = Vec::new();
    for (_, peak) in peaks {
        if apart.len() < TRIED && apart.iter().all(|a| a.abs_diff(peak) > around) {
            apart.push(peak);
        }
    }
    apart
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use std::f64::consts::TAU;

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
    fn a_line_is_taken_off_and_noise_is_left() {
        let power = |series: &[f64]| series.iter().filter(|x| x.is_finite()).map(|x| x * x).sum::<f64>();
        let (quiet, loud) = (series(50.02, 0.0), series(50.02, 20.0));
        assert!((power(&without_line(loud, 1e-3)) / power(&quiet) - 1.0).abs() < 0.2);
        assert!(power(&without_line(quiet.clone(), 1e-3)) > 0.9 * power(&quiet));
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
