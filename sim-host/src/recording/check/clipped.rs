//! A signal cut off at the end of a range: flat at its extreme, entered and left at full speed.
//!
//! A table that rests at the end of a motion is flat at an extreme too, but it comes to rest first; so a flat counts
//! only where the signal runs into it and out of it about as fast as it runs elsewhere, or where its noise, which never rests,
//! stops for it.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::{quantile, rms, scatter};
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

/// Samples on either side of a flat that say how noisy the signal is; a flat of half as many is long enough to ask them.
const BESIDE: usize = 32;

/// Noise, in the steps' root mean square, from which it would have moved the signal: of white noise alone 0.7, of a motion next to none.
const NOISY: f64 = 0.1;

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
        falls(samples, *flat, least) || noisy_beside(samples, *flat, step)
    };
    let at = |extreme: f64| -> Vec<(usize, usize)> { flats(samples, extreme).into_iter().filter(abrupt).collect() };
    let flats: Vec<(usize, usize)> = [at(high), at(low)].concat();
    let longest = flats.iter().map(|(from, to)| to - from + 1).max().unwrap_or(0);
    if flats.len() < 2 && longest < 8 { Vec::new() } else { flats }
}

/// True where the noise on both sides, however fast the signal goes there, would have moved a sensor within its range.
fn noisy_beside(samples: &[f64], (from, to): (usize, usize), step: f64) -> bool {
    // What is cut off between them is no part of the noise.
    let within = |x: &&f64| x.is_finite() && **x != samples[from];
    let noisy = |side: Vec<f64>| {
        let steps = side.windows(2).map(|w| w[1] - w[0]);
        let noise = scatter(&side);
        side.len() == BESIDE && noise > step && noise > NOISY * rms(steps)
    };
    let before = samples[..from].iter().rev().filter(within).take(BESIDE).copied().collect();
    let after = samples[to + 1..].iter().filter(within).take(BESIDE).copied().collect();
    to - from >= BESIDE / 2 && noisy(before) && noisy(after)
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// A slow motion in a noise that is small beside the range, over its end for half a second in the middle.
    fn noisy(range: f64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        let motion = |k: u32| 1.5 * (2.0 * std::f64::consts::PI * f64::from(k) / 2000.0).sin();
        (0..1000).map(|k| (motion(k) + 0.05 * uniform()).min(range)).collect()
    }

    #[test]
    fn a_noisy_peak_that_the_range_cuts_off_is_seen_however_slowly_it_is_entered() {
        let cut = stretches(&noisy(1.3));
        assert!(cut.iter().any(|(from, to)| to - from > 200), "{cut:?}");
        assert!(stretches(&noisy(9.0)).is_empty());
    }

    /// A single peak, entered slower than the signal is elsewhere and faster than its noise goes up and down.
    #[test]
    fn one_peak_that_the_range_cuts_off_is_seen_beside_faster_motion() {
        let mut random = ChaCha8Rng::seed_from_u64(11);
        let mut uniform = || f64::from(random.next_u32()) / f64::from(u32::MAX) - 0.5;
        let swing = |k: u32| match k {
            0..600 => 0.25 * (f64::from(k) / 3.0).sin(),
            _ => 0.4 * (f64::from(k - 600) / 30.0).sin().max(-0.5),
        };
        let mut peaks = |range: f64| (0..750).map(|k| (swing(k) + 0.02 * uniform()).min(range)).collect::<Vec<f64>>();
        assert_eq!(stretches(&peaks(0.3)).len(), 1);
        assert!(stretches(&peaks(9.0)).is_empty());
    }

    #[test]
    fn a_pause_at_the_end_of_a_motion_without_noise_is_no_cut() {
        let smooth = |k: i32| (f64::from(k) / 300.0).clamp(-1.0, 1.0);
        let eased: Vec<f64> = (-900..900).map(|k| 1.5 * smooth(k) - 0.5 * smooth(k).powi(3)).collect();
        assert!(stretches(&eased[..1500]).is_empty());
    }
}
