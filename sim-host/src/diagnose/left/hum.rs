//! Hum of the mains that is too faint to be a hypothesis: one line, in all runs at once, in what a model leaves.

use super::rows::Look;
use crate::diagnose::residual::residual;
use crate::identify::data::Channel;
use crate::identify::model::Model;
use crate::plant::effects::mains_hum;
use crate::recording::check::{fold, mains_lines};
use crate::recording::{Doubt, SetUpFinding};
use std::f64::consts::TAU;

/// How far from its nominal frequency the mains may be, Hz.
const AROUND: f64 = 0.1;
/// Steps of a bin in which it is looked for.
const STEPS: f64 = 4.0;
/// How far on either side what is usual there is taken from, and how far that keeps away from the line, Hz.
const BESIDE: std::ops::Range<f64> = 0.5..2.5;
/// Frequencies on either side that say what is usual.
const USUAL: usize = 24;
/// Fewest samples of a run.
const FEWEST: usize = 256;

/// A line over all runs.
struct Line {
    /// Its power in units of what is usual beside it, summed over the runs.
    stands_out: f64,
    runs: usize,
    /// Root of its mean squared amplitude less what noise makes of one, in units of the noise.
    amplitude: f64,
}

/// Adds a hum where a channel has one that is neither said nor part of the model.
pub(super) fn report(
    looks: &[Look],
    (channel, noise): (Channel, f64),
    model: &Model,
    findings: &mut Vec<SetUpFinding>,
) {
    // What a displacement's hum makes of the loop is motion, and every sensor beside shows it.
    let known = |f: &SetUpFinding| {
        let same = [channel.name(), Channel::Displacement.name()];
        f.what == Doubt::Hum && f.channel.is_some_and(|of| same.contains(&of))
    };
    let modelled = channel == Channel::Acceleration && model.ids().contains(&mains_hum::ENTRY.id);
    if modelled || findings.iter().any(known) {
        return;
    }
    let of = |&(run, predicted): &Look| Some((residual(run, predicted, channel)?, run.dt));
    let left: Vec<(Vec<f64>, f64)> = looks.iter().filter_map(of).filter(|(left, _)| left.len() >= FEWEST).collect();
    let lines = mains_lines().filter_map(|mains| strongest(&left, mains));
    let Some(line) = lines.max_by(|a, b| a.stands_out.total_cmp(&b.stands_out)) else { return };
    if line.is_certain() {
        findings.push(SetUpFinding::hum(channel.name(), noise * line.amplitude, channel.unit()));
    }
}

impl Line {
    /// Whether no noise makes such a line: a sum of as many exponential variables of mean one stays below this in a million trials.
    fn is_certain(&self) -> bool {
        let runs = self.runs as f64;
        self.stands_out > runs + 6.0 * runs.sqrt() + 13.0
    }
}

/// What a model leaves of a channel in a run, beside a frequency of the mains.
struct Beside<'a> {
    left: &'a [f64],
    dt: f64,
    /// Mean power on either side of the frequency.
    usual: f64,
}

/// The strongest line near a frequency of the mains; none where the sampling folds it to where nothing is to be said.
fn strongest(left: &[(Vec<f64>, f64)], mains: f64) -> Option<Line> {
    let beside = |(left, dt): &(Vec<f64>, f64)| {
        let seen = fold(mains, 1.0 / dt);
        let clear = BESIDE.end..0.5 / dt - BESIDE.end;
        clear.contains(&seen).then(|| beside(left, *dt, seen))
    };
    let usual = left.iter().map(|run| (run, beside(run)));
    let runs: Vec<Beside> =
        usual.filter_map(|((left, dt), usual)| Some(Beside { left, dt: *dt, usual: usual? })).collect();
    let longest = runs.iter().map(|run| run.left.len() as f64 * run.dt).fold(0.0, f64::max);
    let steps = (STEPS * AROUND * longest).ceil().max(1.0) as i32;
    let near = (-steps..=steps).map(|i| mains + AROUND * f64::from(i) / f64::from(steps));
    near.filter_map(|frequency| at(&runs, frequency)).max_by(|a, b| a.stands_out.total_cmp(&b.stands_out))
}

/// The line at a frequency.
fn at(runs: &[Beside], frequency: f64) -> Option<Line> {
    let (mut stands_out, mut amplitude) = (0.0, 0.0);
    for Beside { left, dt, usual } in runs {
        let line = power(left, fold(frequency, 1.0 / dt) * dt);
        stands_out += line / usual;
        amplitude += (line - usual).max(0.0) * 4.0 / left.len() as f64;
    }
    let count = runs.len();
    (count > 0).then(|| Line { stands_out, runs: count, amplitude: (amplitude / count as f64).sqrt() })
}

/// Mean power on either side of a frequency.
fn beside(left: &[f64], dt: f64, seen: f64) -> f64 {
    let width = (BESIDE.end - BESIDE.start) / USUAL as f64;
    let away = (0..USUAL).map(|i| BESIDE.start + width * (i as f64 + 0.5));
    let both = away.flat_map(|away| [seen - away, seen + away]).map(|f| power(left, dt * f));
    (both.sum::<f64>() / (2 * USUAL) as f64).max(f64::MIN_POSITIVE)
}

/// Squared amplitude at so many turns a sample, times the samples, over four; of white noise of unit variance one on average.
fn power(left: &[f64], turns: f64) -> f64 {
    let (mut re, mut im, mut count) = (0.0, 0.0, 0.0_f64);
    let (step_sine, step_cosine) = (TAU * turns).sin_cos();
    let (mut sine, mut cosine) = (0.0, 1.0);
    for x in left {
        if x.is_finite() {
            re += x * cosine;
            im += x * sine;
            count += 1.0;
        }
        (sine, cosine) = (sine * step_cosine + cosine * step_sine, cosine * step_cosine - sine * step_sine);
    }
    (re * re + im * im) / count.max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::gauss;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;

    /// Runs of 12 s at 500 Hz with noise and hum of an amplitude (in units of the noise) at 49.97 Hz, each in a phase of its own.
    fn runs(count: usize, amplitude: f64) -> Vec<(Vec<f64>, f64)> {
        let mut noise = ChaCha8Rng::seed_from_u64(11);
        let run = |i: usize| {
            let hum = |k: usize| amplitude * (TAU * 49.97 * 2e-3 * k as f64 + i as f64).sin();
            ((0..6000).map(|k| gauss(&mut noise) + hum(k)).collect(), 2e-3)
        };
        (0..count).map(run).collect()
    }

    /// A hum that no run shows for certain is certain over eight, with its amplitude; noise alone is none.
    #[test]
    fn a_faint_hum_is_found_over_all_runs() {
        let strongest = |count, amplitude| strongest(&runs(count, amplitude), 50.0).unwrap();
        let faint = strongest(8, 0.12);
        assert!(faint.is_certain());
        assert!((faint.amplitude / 0.12 - 1.0).abs() < 0.2, "{}", faint.amplitude);
        assert!(!strongest(1, 0.06).is_certain());
        assert!(!strongest(8, 0.0).is_certain());
    }
}
