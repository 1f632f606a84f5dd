//! Mains hum: a narrow line at 50 or 60 Hz or a harmonic, or where sampling folds it to.
//!
//! A table at its velocity limit makes narrow lines too, the harmonics of its saw-tooth, and some fall on the mains. They
//! come and go with the motion; hum lasts, and is there while the table rests.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::{Spectra, filled, quantile, segment_length, spectra};
use std::f64::consts::TAU;

/// A line must stand out from its neighbours by this factor in power.
const STANDS_OUT: f64 = 30.0;

/// Harmonics of the mains that are looked for.
const HARMONICS: [f64; 3] = [1.0, 2.0, 3.0];

/// Stretches a record is cut into to see whether a line lasts.
const STRETCHES: usize = 24;

/// Share of its mean power that a line must keep in the quietest quarter of the stretches, and how many times that mean it
/// may reach in one: noise alone reaches four.
const LASTING: (f64, f64) = (0.3, 6.0);

/// Looks for the strongest line of the mains in every sensor.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    use Channel::{Acceleration, Displacement, PressureDifference, SpecimenAcceleration, Velocity};
    [Displacement, Velocity, Acceleration, PressureDifference, SpecimenAcceleration]
        .into_iter()
        .filter_map(|channel| finding(run, channel))
        .collect()
}

/// Where a channel shows the strongest line of the mains, Hz; none where it shows none.
pub(crate) fn mains_line(run: &Run, channel: Channel) -> Option<f64> {
    strongest(run, channel).map(|(_, seen_hz, _)| seen_hz)
}

/// The strongest line of the mains: its own frequency, where it is seen, and its shape.
fn strongest(run: &Run, channel: Channel) -> Option<(f64, f64, Line)> {
    let samples = run.channel(channel)?;
    let segment = segment_length(samples.len(), (20.0 / run.dt) as usize);
    let power = spectra(samples, samples, run.dt, segment);
    let driven = run.channel(Channel::Reference).map(|r| spectra(r, r, run.dt, segment));
    if power.segments < 4 {
        return None;
    }
    // A mode of the table near the mains is broad: only as fine as the recording is long does it come apart from a line.
    let fine = spectra(samples, samples, run.dt, samples.len().min((20.0 / run.dt) as usize));
    let lines = mains_lines().filter_map(|mains| {
        let folded = fold(mains, 1.0 / run.dt);
        let line = Line::at(&power, folded)?;
        let also_driven = driven.as_ref().and_then(|d| Line::at(d, folded)).is_some_and(|d| d.ratio > 10.0);
        let narrow = || Line::at(&fine, folded).is_some_and(|line| line.ratio > STANDS_OUT);
        (line.ratio > STANDS_OUT && !also_driven && narrow() && lasts(run, samples, folded))
            .then_some((mains, folded, line))
    });
    lines.max_by(|a, b| a.2.amplitude.total_cmp(&b.2.amplitude))
}

fn finding(run: &Run, channel: Channel) -> Option<Finding> {
    let (true_hz, seen_hz, line) = strongest(run, channel)?;
    let folded = if (true_hz - seen_hz).abs() < 1e-6 {
        format!("{seen_hz:.1} Hz")
    } else {
        format!("{seen_hz:.2} Hz, where {:.1} Hz sampling folds {true_hz:.0} Hz to", 1.0 / run.dt)
    };
    let unit = match channel {
        Channel::Displacement => " m",
        Channel::Velocity => " m/s",
        Channel::Acceleration | Channel::SpecimenAcceleration => " m/s2",
        _ => "",
    };
    let remedy = match channel {
        Channel::Acceleration => "check shields and earths, filter before sampling, or let the model carry `mains_hum`",
        _ => "check shields and earths, or filter before sampling",
    };
    let problem = format!("{channel} carries hum at {folded}, amplitude {:.2e}{unit}", line.amplitude);
    Some(Finding::whole(run, channel, Fault::Hum, Severity::Remark).saying(problem, remedy))
}

/// Frequencies of the mains and of their harmonics, Hz.
pub(crate) fn mains_lines() -> impl Iterator<Item = f64> {
    [50.0, 60.0].into_iter().flat_map(|mains| HARMONICS.map(|harmonic| mains * harmonic))
}

/// Where sampling puts a frequency, Hz.
pub(crate) fn fold(frequency: f64, rate: f64) -> f64 {
    (frequency - rate * (frequency / rate).round()).abs()
}

/// Whether a line is there all the time, whatever the table does.
fn lasts(run: &Run, samples: &[f64], frequency: f64) -> bool {
    let motion = [Channel::Displacement, Channel::Reference].into_iter().find_map(|c| run.channel(c));
    let motion = curved(motion.unwrap_or(samples));
    let (samples, length) = (curved(samples), samples.len() / STRETCHES);
    if length < 8 {
        return true;
    }
    let parts = samples.chunks_exact(length).zip(motion.chunks_exact(length));
    let mut stretches: Vec<(f64, f64)> =
        parts.map(|(s, m)| (m.iter().map(|x| x * x).sum(), line_power(s, frequency * run.dt))).collect();
    stretches.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mean = |part: &[(f64, f64)]| part.iter().map(|(_, power)| power).sum::<f64>() / part.len().max(1) as f64;
    let (all, quiet) = (mean(&stretches), mean(&stretches[..stretches.len() / 4]));
    quiet >= LASTING.0 * all && stretches.iter().all(|(_, power)| *power <= LASTING.1 * all)
}

/// Second differences: what is slow and large must not leak into a line; gaps are bridged.
fn curved(samples: &[f64]) -> Vec<f64> {
    filled(samples).windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect()
}

/// Power at so many turns a sample, through a Hann window.
fn line_power(samples: &[f64], turns: f64) -> f64 {
    let n = samples.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (k, x) in samples.iter().enumerate() {
        let window = 1.0 - (TAU * (k as f64 + 0.5) / n).cos();
        let (sine, cosine) = (TAU * turns * k as f64).sin_cos();
        re += window * x * cosine;
        im += window * x * sine;
    }
    re * re + im * im
}

/// A narrow line of a spectrum.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Peak power over the median of the neighbours.
    ratio: f64,
    /// Amplitude of the sine that would make it.
    amplitude: f64,
}

impl Line {
    /// The line at a frequency; none where the spectrum does not reach there, or the bin next to it is not the peak of
    /// its surroundings.
    fn at(power: &Spectra, frequency: f64) -> Option<Self> {
        let width = power.frequency.get(1)?;
        let middle = (frequency / width).round() as usize;
        if middle < 12 || middle + 12 >= power.input.len() {
            return None;
        }
        let peak = (middle - 1..=middle + 1).max_by(|a, b| power.input[*a].total_cmp(&power.input[*b]))?;
        let around: Vec<f64> =
            (middle - 12..=middle + 12).filter(|k| k.abs_diff(peak) > 3).map(|k| power.input[k]).collect();
        let (floor, tallest) = (quantile(&around, 0.5), quantile(&around, 1.0));
        let above: f64 = (peak - 2..=peak + 2).map(|k| (power.input[k] - floor).max(0.0)).sum();
        let ratio =
            if tallest * 3.0 > power.input[peak] { 0.0 } else { power.input[peak] / floor.max(f64::MIN_POSITIVE) };
        Some(Self { ratio, amplitude: (2.0 * above * width).sqrt() })
    }
}

#[cfg(test)]
mod tests;
