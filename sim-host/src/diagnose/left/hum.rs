//! Hum of the mains that is too faint to be a hypothesis: one line, in all runs at once, in what a model leaves.

use super::rows::Look;
use crate::diagnose::residual::residual;
use crate::identify::data::Channel;
use crate::identify::model::Model;
use crate::plant::effects::mains_hum;
use crate::recording::check::{fold, mains_lines};
use crate::recording::{Doubt, SetUpFinding};
use realfft::num_complex::Complex64;
use std::f64::consts::TAU;

/// How far from its nominal frequency the mains may be, Hz.
const AROUND: f64 = 0.1;
/// Steps of a bin in which it is looked for.
const STEPS: f64 = 4.0;
/// How far on either side what is usual there is taken from, and how far that keeps away from the line, Hz.
const BESIDE: std::ops::Range<f64> = 0.5..2.5;
/// Frequencies on either side that say what is usual.
const USUAL: usize = 24;
/// Longest block of samples that are summed before lines beside a frequency are looked for, s: over it the farthest turns by a twentieth.
const BLOCK: f64 = 0.02;
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

/// What a model leaves of a channel in a run around a frequency, which lies at none here: sums over blocks that are short beside the offsets
/// at which lines are looked for.
struct Around {
    blocks: Vec<Complex64>,
    /// Length of a block, s.
    length: f64,
    /// Samples that are finite.
    count: f64,
    dt: f64,
    /// Where the sampling folds the frequency to, Hz.
    seen: f64,
    /// Mean power on either side.
    usual: f64,
}

/// The strongest line near a frequency of the mains; none where the sampling folds it to where nothing is to be said.
fn strongest(left: &[(Vec<f64>, f64)], mains: f64) -> Option<Line> {
    let runs: Vec<Around> = left.iter().filter_map(|(left, dt)| Around::of(left, *dt, mains)).collect();
    let longest = runs.iter().map(|run| run.blocks.len() as f64 * run.length).fold(0.0, f64::max);
    let steps = (STEPS * AROUND * longest).ceil().max(1.0) as i32;
    let near = (-steps..=steps).map(|i| mains + AROUND * f64::from(i) / f64::from(steps));
    near.filter_map(|frequency| at(&runs, frequency)).max_by(|a, b| a.stands_out.total_cmp(&b.stands_out))
}

/// The line at a frequency.
fn at(runs: &[Around], frequency: f64) -> Option<Line> {
    let (mut stands_out, mut amplitude) = (0.0, 0.0);
    for run in runs {
        let line = run.power(fold(frequency, 1.0 / run.dt) - run.seen);
        stands_out += line / run.usual;
        amplitude += (line - run.usual).max(0.0) * 4.0 / run.count;
    }
    let count = runs.len();
    (count > 0).then(|| Line { stands_out, runs: count, amplitude: (amplitude / count as f64).sqrt() })
}

impl Around {
    /// Of residuals `dt` (s) apart.
    fn of(left: &[f64], dt: f64, mains: f64) -> Option<Self> {
        let seen = fold(mains, 1.0 / dt);
        if !(BESIDE.end..0.5 / dt - BESIDE.end).contains(&seen) {
            return None;
        }
        let block = ((BLOCK / dt) as usize).max(1);
        let step = Complex64::cis(-TAU * seen * dt);
        let mut turned = Complex64::ONE;
        let mut sum = |part: &[f64]| {
            let mut sum = Complex64::ZERO;
            for x in part {
                if x.is_finite() {
                    sum += turned * x;
                }
                turned *= step;
            }
            sum
        };
        let blocks = left.chunks(block).map(&mut sum).collect();
        let count = left.iter().filter(|x| x.is_finite()).count().max(1) as f64;
        let around = Self { blocks, length: block as f64 * dt, count, dt, seen, usual: 1.0 };
        Some(Self { usual: around.beside(), ..around })
    }

    /// Mean power on either side.
    fn beside(&self) -> f64 {
        let width = (BESIDE.end - BESIDE.start) / USUAL as f64;
        let away = (0..USUAL).map(|i| BESIDE.start + width * (i as f64 + 0.5));
        let both = away.flat_map(|away| [-away, away]).map(|offset| self.power(offset));
        (both.sum::<f64>() / (2 * USUAL) as f64).max(f64::MIN_POSITIVE)
    }

    /// Squared amplitude at an offset (Hz), times the samples, over four; of white noise of unit variance one on average.
    fn power(&self, offset: f64) -> f64 {
        let step = Complex64::cis(-TAU * offset * self.length);
        let mut turned = Complex64::ONE;
        let mut sum = Complex64::ZERO;
        for block in &self.blocks {
            sum += turned * block;
            turned *= step;
        }
        sum.norm_sqr() / self.count
    }
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

    /// Sums over blocks leave a line near the frequency, and the power of noise beside it, as they are.
    #[test]
    fn blocks_are_short_beside_the_offsets() {
        let runs = runs(1, 0.5);
        let (left, dt) = &runs[0];
        let around = Around::of(left, *dt, 50.0).unwrap();
        assert_eq!(around.blocks.len(), 600);
        let exactly = |frequency: f64| {
            let turned = |(k, x): (usize, &f64)| Complex64::cis(-TAU * frequency * dt * k as f64) * x;
            left.iter().enumerate().map(turned).sum::<Complex64>().norm_sqr() / left.len() as f64
        };
        let (line, exact) = (around.power(-0.03), exactly(49.97));
        assert!((line / exact - 1.0).abs() < 1e-3, "{line} {exact}");
        assert!((0.6..1.6).contains(&around.usual), "{}", around.usual);
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
