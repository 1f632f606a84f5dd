//! A signal cut off at the end of a range: flat at its extreme, entered and left at full speed.
//!
//! A table that rests at the end of a motion is flat at an extreme too, but it comes to rest first; so a flat counts
//! only where the signal runs into it and out of it about as fast as it runs elsewhere.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::quantile;
use crate::recording::steps::quantisation_step;

/// Sensors that can be cut off.
const SENSORS: [Channel; 5] = [
    Channel::Displacement,
    Channel::Velocity,
    Channel::Acceleration,
    Channel::PressureDifference,
    Channel::SpecimenAcceleration,
];

/// Samples over which the speed into and out of a flat is measured.
const REACH: usize = 4;

/// Fewest equal samples of a flat.
const FLAT: usize = 3;

/// Looks at both extremes of every sensor.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    SENSORS.into_iter().filter_map(|channel| finding(run, channel)).collect()
}

fn finding(run: &Run, channel: Channel) -> Option<Finding> {
    let samples = run.channel(channel)?;
    let flats = stretches(samples);
    let (low, high) = ends(samples);
    let longest = flats.iter().map(|(from, to)| to - from + 1).max()?;
    let (from, to) = flats.iter().fold((usize::MAX, 0), |(from, to), f| (from.min(f.0), to.max(f.1)));
    Some(Finding::whole(run, channel, Fault::Clipped, Severity::BadData).between(run, from, to).saying(
        format!(
            "{channel} is cut off {} times at its extremes ({low:.6} and {high:.6}, SI), for up to {:.4} s",
            flats.len(),
            longest as f64 * run.dt
        ),
        format!("raise the range of {channel} or lower the motion, and record again"),
    ))
}

/// Smallest and largest sample.
fn ends(samples: &[f64]) -> (f64, f64) {
    let finite = samples.iter().filter(|x| x.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
}

/// Stretches that are cut off, first and last sample each; none where a flat may be chance.
pub(crate) fn stretches(samples: &[f64]) -> Vec<(usize, usize)> {
    let (low, high) = ends(samples);
    let steps: Vec<f64> = samples.windows(REACH + 1).map(|w| (w[REACH] - w[0]).abs()).filter(|d| *d > 0.0).collect();
    let ordinary = quantile(&steps, 0.75);
    let step = quantisation_step(samples).unwrap_or(0.0);
    let abrupt = |flat: &(usize, usize)| {
        let least = (0.3 * ordinary).max(1.5 * step).max(3.0 * rounded_fall(flat.1 - flat.0 + 1, step));
        falls(samples, *flat, least)
    };
    let at = |extreme: f64| -> Vec<(usize, usize)> { flats(samples, extreme).into_iter().filter(abrupt).collect() };
    let flats: Vec<(usize, usize)> = [at(high), at(low)].concat();
    let longest = flats.iter().map(|(from, to)| to - from + 1).max().unwrap_or(0);
    if flats.len() < 2 && longest < 8 { Vec::new() } else { flats }
}

/// Stretches of at least [`FLAT`] samples at the extreme: first and last sample.
fn flats(samples: &[f64], extreme: f64) -> Vec<(usize, usize)> {
    let mut flats = Vec::new();
    let mut start = None;
    for (k, &x) in samples.iter().chain([&f64::NAN]).enumerate() {
        match (x == extreme, start) {
            (true, None) => start = Some(k),
            (false, Some(from)) => {
                if k - from >= FLAT {
                    flats.push((from, k - 1));
                }
                start = None;
            }
            _ => {}
        }
    }
    flats
}

/// How far a round peak falls within [`REACH`] samples beside a flat that the converter's step alone makes: a parabola
/// stays within half a step of its peak over half the flat.
fn rounded_fall(length: usize, step: f64) -> f64 {
    let half = length as f64 / 2.0;
    0.5 * step * ((1.0 + REACH as f64 / half).powi(2) - 1.0)
}

/// True where the signal falls by more than `least` on both sides of a flat.
fn falls(samples: &[f64], (from, to): (usize, usize), least: f64) -> bool {
    let before = from.checked_sub(REACH).and_then(|k| samples.get(k));
    let after = samples.get(to + REACH);
    match (before, after) {
        (Some(before), Some(after)) => (samples[from] - before).abs() > least && (samples[to] - after).abs() > least,
        _ => false,
    }
}
