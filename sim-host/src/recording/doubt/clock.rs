//! Time stamps that scatter, and rows that are missing.
//!
//! Stamps that scatter may say when each sample was really taken, or may be late themselves while the converter kept its
//! pace. The samples tell: moved to the even grid along their slope they are smoother in the one case and rougher in the other.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::experiment::Experiment;
use crate::recording::run::Run;
use crate::recording::signal::{filled, slope};

/// Jitter below this share of a step is the writing of the numbers.
const LEAST: f64 = 0.003;
/// Roughness of the moved samples against the even ones below which the stamps are believed.
const SMOOTHER: f64 = 0.9;

/// Moves samples to the even grid where that makes them smoother.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        let missing = (0..run.len()).filter(|&k| run.channels.iter().all(|(_, s)| !s[k].is_finite())).count();
        if missing > 0 {
            findings.push(SetUpFinding::new(Doubt::LostRows, missing as f64, "rows").against(0.0).of_run(&run.name));
        }
        let Some(jitter) = believed(run) else { continue };
        let offsets = std::mem::take(&mut run.clock.offsets);
        let moved: Vec<(Channel, Vec<f64>)> =
            run.channels.iter().map(|(channel, samples)| (channel, on_grid(samples, &offsets, run.dt))).collect();
        for (channel, samples) in moved {
            run.channels.set(channel, samples);
        }
        findings.push(SetUpFinding::new(Doubt::ClockJitter, jitter, "s").against(0.0).of_run(&run.name));
    }
    findings
}

/// The jitter where the stamps say when the samples were taken; none where they scatter by themselves.
fn believed(run: &Run) -> Option<f64> {
    let offsets = &run.clock.offsets;
    if offsets.len() != run.len() || run.clock.jitter < LEAST * run.dt {
        return None;
    }
    let samples = run.channel(Channel::Displacement).or_else(|| run.channel(Channel::Reference))?;
    let moved = on_grid(samples, offsets, run.dt);
    (roughness(&moved) < SMOOTHER * roughness(samples)).then_some(run.clock.jitter)
}

/// Samples taken `offsets` after their places in the grid, brought back along their slope.
fn on_grid(samples: &[f64], offsets: &[f64], dt: f64) -> Vec<f64> {
    let slopes = slope(&filled(samples), dt);
    samples.iter().zip(&slopes).zip(offsets).map(|((x, slope), late)| x - slope * late).collect()
}

/// Mean square of the fourth differences.
fn roughness(samples: &[f64]) -> f64 {
    let fourth = |w: &[f64]| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]).powi(2);
    let all: Vec<f64> = samples.windows(5).map(fourth).filter(|x| x.is_finite()).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}
