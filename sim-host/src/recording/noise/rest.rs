//! Finding the longest stretch in which the table rests.

use super::differences;
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::{detrended, deviation, filled, quantile};
use crate::recording::steps::quantisation_step;

/// Length of the windows that are looked at, s.
const WINDOW: f64 = 0.25;

/// Shortest stretch that is used, s.
const SHORTEST: f64 = 0.5;

/// Factor by which coloured noise swings wider than its differences say.
const SLOWER: f64 = 10.0;

/// How many times as wide a stretch swings in its first half while it still settles.
const SETTLING: f64 = 1.5;

/// The longest stretch at rest, as first sample and the one after the last; none where the table always moves.
///
/// The table rests where the reference stands still and the displacement, averaged over the window, stays where it is.
pub(super) fn rest(run: &Run) -> Option<(usize, usize)> {
    let window = ((WINDOW / run.dt) as usize).max(8);
    let count = run.len() / window;
    if count < 4 {
        return None;
    }
    if never_moves(run) {
        return Some((0, run.len()));
    }
    let still: Vec<Vec<bool>> = [Channel::Reference, Channel::Displacement, Channel::Acceleration]
        .into_iter()
        .filter_map(|c| Some((c, run.channel(c)?)))
        .map(|(channel, samples)| standing(channel, &filled(samples), window, count))
        .collect();
    if still.is_empty() {
        return None;
    }
    let at_rest: Vec<bool> = (0..count).map(|k| still.iter().all(|s| s[k])).collect();
    let (from, length) = crate::recording::check::longest_stretch(&at_rest);
    if length == 0 {
        return None;
    }
    // The first and the last window may hold the end of a motion.
    let (from, to) = (if from == 0 { 0 } else { from * window + window / 2 }, (from + length) * window);
    let to = if to < count * window { to - window / 2 } else { to };
    (to > from && (to - from) as f64 * run.dt >= SHORTEST).then(|| (settled(run, from, to), to))
}

/// Where a stretch at rest begins once the motion before it has died away: a tail of it swings wider in the stretch's first half than
/// in its second.
fn settled(run: &Run, mut from: usize, to: usize) -> usize {
    let Some(displacement) = run.channel(Channel::Displacement) else { return from };
    let size = |part: &[f64]| deviation(&detrended(part));
    loop {
        let middle = from + (to - from) / 2;
        let shorter = (to - middle) as f64 * run.dt < SHORTEST;
        if shorter || size(&displacement[from..middle]) <= SETTLING * size(&displacement[middle..to]) {
            return from;
        }
        from = middle;
    }
}

/// True where the reference stands still from end to end and the displacement with it: its deviation is at most [`SLOWER`] times what its
/// differences, or its converter's step, say of the noise.
fn never_moves(run: &Run) -> bool {
    let still = |reference: &[f64]| reference.iter().all(|x| *x == reference[0]);
    let shakes = |displacement: &[f64]| {
        let least = quantisation_step(displacement).map_or(0.0, |step| step / 12f64.sqrt());
        differences(displacement).is_some_and(|noise| deviation(&filled(displacement)) < SLOWER * noise.max(least))
    };
    run.channel(Channel::Reference).is_some_and(still) && run.channel(Channel::Displacement).is_some_and(shakes)
}

/// The windows in which a channel stands still.
fn standing(channel: Channel, samples: &[f64], window: usize, count: usize) -> Vec<bool> {
    let part = |k: usize| &samples[k * window..(k + 1) * window];
    if channel == Channel::Acceleration {
        // Its noise hides slow motion, so only shaking well above the quietest windows counts.
        let sizes: Vec<f64> = (0..count).map(|k| deviation(part(k))).collect();
        let quiet = quantile(&sizes, 0.02);
        return sizes.iter().map(|s| *s <= 1.5 * quiet).collect();
    }
    let means: Vec<f64> = (0..count).map(|k| part(k).iter().sum::<f64>() / window as f64).collect();
    let travel = quantile(samples, 1.0) - quantile(samples, 0.0);
    let limit = 1e-3 * travel;
    let moved = |a: usize, b: usize| (means[a] - means[b]).abs() > limit;
    (0..count)
        .map(|k| {
            let slides = (k > 0 && moved(k - 1, k)) || (k + 1 < count && moved(k, k + 1));
            let (first, second) = part(k).split_at(window / 2);
            let mean = |half: &[f64]| half.iter().sum::<f64>() / half.len() as f64;
            !slides && (mean(first) - mean(second)).abs() <= limit && deviation(part(k)) <= 0.02 * travel
        })
        .collect()
}
