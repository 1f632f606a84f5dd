//! A channel that repeats one value while the table moves.
//!
//! A table at rest repeats values too, and so does a coarse converter near a turning point, so a stretch of equal
//! values is a fault only where another channel moves meanwhile, and where either the channel jumps when it comes back
//! (a table cannot), or it never comes back, or its noise would not have let it repeat at all.

use super::missing::stretches;
use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::{deviation, filled, quantile};

/// Sensors that can stick.
const SENSORS: [Channel; 6] = [
    Channel::Displacement,
    Channel::Velocity,
    Channel::Acceleration,
    Channel::PressureDifference,
    Channel::SupplyPressure,
    Channel::SpecimenAcceleration,
];

/// Channels that show whether the table moves, or should; those that show it plainly are asked first.
const WITNESSES: [&[Channel]; 2] = [
    &[Channel::Reference, Channel::Displacement, Channel::Velocity],
    &[Channel::Command, Channel::Acceleration, Channel::PressureDifference],
];

/// A shorter stretch of equal values is not looked at, samples.
const SHORTEST: usize = 16;

/// A longer stretch counts even where the channel comes back without a jump, s.
const LONG: f64 = 0.25;

/// Looks at every stretch of equal values of every sensor.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    SENSORS.into_iter().filter_map(|channel| finding(run, channel)).collect()
}

fn finding(run: &Run, channel: Channel) -> Option<Finding> {
    let samples = run.channel(channel)?;
    let equal: Vec<bool> = samples.windows(2).map(|w| w[0] == w[1]).collect();
    let mut long: Vec<(usize, usize)> = stretches(&equal).into_iter().filter(|s| s.1 + 1 >= SHORTEST).collect();
    long.sort_by_key(|s| std::cmp::Reverse(s.1));
    let (from, length) = long.into_iter().find(|&stretch| is_stuck(run, channel, stretch, &equal))?;
    let seconds = length as f64 * run.dt;
    Some(Finding::whole(run, channel, Fault::Stuck, Severity::BadData).between(run, from, from + length).saying(
        format!(
            "{channel} repeats {} (SI) for {seconds:.3} s ({} samples) while the table moves",
            samples[from],
            length + 1
        ),
        format!("check the sensor and wiring of {channel}; leave the stretch out with `from_s` and `to_s`"),
    ))
}

fn is_stuck(run: &Run, channel: Channel, (from, length): (usize, usize), equal: &[bool]) -> bool {
    let Some(samples) = run.channel(channel) else { return false };
    let to = from + length;
    let moving = movement(run, channel, from, to);
    let long = length as f64 * run.dt > LONG;
    let to_the_end = to + 1 >= samples.len();
    (jumps(samples, to) && moving > 0.03)
        || (moving > 0.1 && noisy_around(equal, from, length))
        || (long && moving > if to_the_end { 0.5 } else { 0.8 })
}

/// True where the values beside the stretch hardly ever repeat, so that noise would not have let this one do so. Beside
/// a turning point they do: a coarse converter steps the slower the nearer it is.
fn noisy_around(equal: &[bool], from: usize, length: usize) -> bool {
    let before = &equal[from.saturating_sub(length)..from];
    let after = &equal[(from + length).min(equal.len())..(from + 2 * length).min(equal.len())];
    let repeats = before.iter().chain(after).filter(|e| **e).count();
    let count = before.len() + after.len();
    count > 0 && repeats * 5 < count
}

/// True where the first sample after the stretch is further away than the table goes in one step.
fn jumps(samples: &[f64], to: usize) -> bool {
    let (Some(last), Some(next)) = (samples.get(to), samples.get(to + 1)) else { return false };
    let steps: Vec<f64> = samples.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).collect();
    (next - last).abs() > 4.0 * quantile(&steps, 0.99)
}

/// How much the liveliest other channel moves within the stretch, against its movement over the run; noise is averaged
/// away first.
fn movement(run: &Run, channel: Channel, from: usize, to: usize) -> f64 {
    let reach = (0.05 / run.dt).ceil() as usize;
    let moves = |witness: &Channel| {
        let samples = averaged(&filled(run.channel(*witness)?), reach);
        let all = deviation(&samples);
        (all > 0.0).then(|| deviation(&samples[from..=to.min(samples.len() - 1)]) / all)
    };
    WITNESSES
        .into_iter()
        .map(|group| group.iter().filter(|w| **w != channel).filter_map(moves).collect::<Vec<f64>>())
        .find(|group| !group.is_empty())
        .map_or(0.0, |group| group.into_iter().fold(0.0, f64::max))
}

/// Mean over `reach` samples to either side.
fn averaged(samples: &[f64], reach: usize) -> Vec<f64> {
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(samples.iter().scan(0.0, |sum, x| {
            *sum += x;
            Some(*sum)
        }))
        .collect();
    (0..samples.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(reach), (k + reach + 1).min(samples.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}
