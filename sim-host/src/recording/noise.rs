//! The noise floor of each channel: what no model can explain, against which every residual is judged.
//!
//! Sources in the order they are trusted: the experiment's own figure (the whole effective standard deviation, step
//! included); the scatter between repeats of one reference; stretches where the table rests; the step of the converter;
//! and, where the table never rests, what high differences leave of a smooth motion. No floor is ever below
//! step/sqrt(12). The colour is an autoregression fitted to a stretch at rest.

use super::channel::{Channel, PerChannel};
use super::run::Run;
use super::signal::{detrended, deviation, scatter};
use super::steps::quantisation_step;
use rest::rest;

mod autoregression;
mod rest;

pub(crate) use autoregression::Autoregression;

/// Where a floor comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Origin {
    /// The experiment states it.
    Stated,
    /// Scatter between this many runs of one reference.
    Repeats(usize),
    /// The table rests from the first to the second time, s by the file's clock.
    Rest(f64, f64),
    /// The converter's step is larger than anything else that was seen.
    Step,
    /// The table never rests: high differences of the samples, which a slow motion leaves untouched.
    Differences,
}

/// Whether neighbouring errors know of each other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Colour {
    /// There was no stretch at rest to tell.
    Unknown,
    /// They do not.
    White,
    /// They do, like this.
    Coloured(Autoregression),
}

/// The noise floor of one channel of one run.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Floor {
    /// Standard deviation, SI.
    pub std: f64,
    /// Where it comes from.
    pub origin: Origin,
    /// What was measured, whatever is stated, SI.
    pub measured: Option<f64>,
    /// Step of the converter, SI.
    pub step: Option<f64>,
    /// Its colour.
    pub colour: Colour,
}

/// The floors of every channel of a run; `others` are searched for repeats of the same reference.
pub(crate) fn floors(run: &Run, others: &[Run]) -> PerChannel<Floor> {
    let rest = rest(run);
    let mut floors = PerChannel::default();
    for (channel, samples) in run.channels.iter() {
        if matches!(channel, Channel::Reference | Channel::Disturbance) {
            continue;
        }
        if let Some(floor) = floor(run, channel, samples, rest, others) {
            floors.set(channel, floor);
        }
    }
    floors
}

fn floor(run: &Run, channel: Channel, samples: &[f64], rest: Option<(usize, usize)>, others: &[Run]) -> Option<Floor> {
    let step = quantisation_step(samples);
    let least = step.map_or(0.0, |s| s / 12f64.sqrt());
    let at_rest = rest.map(|(from, to)| {
        let part = still(run, channel, samples, (from, to));
        (deviation(&part), part, Origin::Rest(run.time[from], run.time[to - 1]))
    });
    let measured = repeats(run, channel, samples, others)
        .or_else(|| at_rest.as_ref().map(|(std, _, origin)| (*std, *origin)))
        .or_else(|| differences(samples).map(|std| (std, Origin::Differences)));
    let measured = match measured {
        Some((std, _)) if std <= least => step.map(|_| (least, Origin::Step)),
        other => other,
    };
    let (std, origin) = match run.noise.get(channel) {
        Some(&stated) => (stated, Origin::Stated),
        None => measured.filter(|m| m.0 > 0.0)?,
    };
    let colour = at_rest.map_or(Colour::Unknown, |(_, part, _)| colour(&part));
    Some(Floor { std, origin, measured: measured.map(|m| m.0), step, colour })
}

/// What a channel shows of a stretch at rest, its trend taken off: a displacement that still follows a slow reference, less that.
fn still(run: &Run, channel: Channel, samples: &[f64], (from, to): (usize, usize)) -> Vec<f64> {
    let own = detrended(&samples[from..to]);
    let Some(reference) = run.channel(Channel::Reference).filter(|_| channel == Channel::Displacement) else {
        return own;
    };
    let less: Vec<f64> = samples[from..to].iter().zip(&reference[from..to]).map(|(x, r)| x - r).collect();
    let less = detrended(&less);
    if deviation(&less) < deviation(&own) { less } else { own }
}

fn colour(rest: &[f64]) -> Colour {
    if deviation(rest) <= 0.0 {
        return Colour::Unknown;
    }
    let best = Autoregression::fit(rest, (rest.len() / 20).min(20));
    if best.coefficients.is_empty() { Colour::White } else { Colour::Coloured(best) }
}

/// Scatter between this run and those with the same reference, sample by sample, the common part taken off.
fn repeats(run: &Run, channel: Channel, samples: &[f64], others: &[Run]) -> Option<(f64, Origin)> {
    let reference = run.channel(Channel::Reference)?;
    let same = |other: &&Run| {
        other.name != run.name
            && other.dt == run.dt
            && other.law == run.law
            && other.channel(Channel::Reference).is_some_and(|r| r == reference)
    };
    let twins: Vec<&[f64]> = others.iter().filter(same).filter_map(|o| o.channel(channel)).collect();
    if twins.is_empty() {
        return None;
    }
    let count = twins.len() as f64 + 1.0;
    let scatter: Vec<f64> = (0..samples.len())
        .map(|k| {
            let all = || std::iter::once(samples[k]).chain(twins.iter().map(|t| t[k]));
            let mean = all().sum::<f64>() / count;
            all().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0)
        })
        .filter(|v| v.is_finite())
        .collect();
    let std = (scatter.iter().sum::<f64>() / scatter.len().max(1) as f64).sqrt();
    Some((std, Origin::Repeats(twins.len() + 1)))
}

/// Noise from fourth differences; none for too few samples.
pub(super) fn differences(samples: &[f64]) -> Option<f64> {
    Some(scatter(samples)).filter(|noise| samples.len() > 68 && noise.is_finite())
}

#[cfg(test)]
mod tests;
