//! Where a region begins and ends.

use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Predicted;
use crate::identify::model::{Model, ModelEffect, Value};
use crate::plant::effects::parts as shares;
use crate::plant::effects::regional::{Along, Shape, code, form, regional};

/// Parts that the range of a variable is cut into.
pub(super) const PARTS: usize = 10;
/// Width of a window's ends, as a share of the range.
const EDGE: f64 = 0.01;
/// Ranges beyond what was seen at which a window that has no end there ends: other runs move farther.
const BEYOND: f64 = 10.0;
/// Ranges outside what was seen to which an open end may go.
const OUTSIDE: f64 = 0.2;

fn fixed(value: f64) -> Value {
    Value { free: false, ..open(value, f64::NEG_INFINITY, f64::INFINITY) }
}

fn open(value: f64, low: f64, high: f64) -> Value {
    Value { value, low, high, positive: false, free: true, prior: None }
}

/// An effect with the values found for it alone, in a window. One that reaches an end of what was seen has no end there: it lies beyond,
/// where nothing could fit it.
pub(super) fn window(placed: &ModelEffect, along: Along, (from, to): (f64, f64), ends: &[f64]) -> Option<ModelEffect> {
    let entry = regional(placed.entry, along, Shape::Window)?;
    let (low, high) = (*ends.first()?, *ends.last()?);
    let range = high - low;
    let end = |value| open(value, low - OUTSIDE * range, high + OUTSIDE * range);
    let from = if from <= low { fixed(low - BEYOND * range) } else { end(from) };
    let to = if to >= high { fixed(high + BEYOND * range) } else { end(to) };
    let further = [fixed(code(along, Shape::Window)), fixed(EDGE * range), from, to];
    Some(ModelEffect { entry, values: placed.values.iter().copied().chain(further).collect() })
}

/// Open ends of a window as they are where the effect goes on beyond what was seen.
pub(super) fn beyond([from, to]: [Value; 2]) -> [Value; 2] {
    let range = (from.high - from.low) / (1.0 + 2.0 * OUTSIDE);
    let far = (BEYOND - OUTSIDE) * range;
    [fixed(from.low - far), fixed(to.high + far)]
}

/// An effect with a share of nothing in each part of those seen; none for one whose shares one simulation cannot tell of.
pub(super) fn parted(placed: &ModelEffect, along: Along, ends: &[f64]) -> Option<ModelEffect> {
    let (low, high, inner) = (*ends.first()?, *ends.last()?, ends.get(1..ends.len() - 1)?);
    let (given, count) = shares::parameters(along, EDGE * (high - low), inner);
    let entry = shares::in_parts(placed.entry, along, count)?;
    let own = placed.values.iter().map(|value| fixed(value.value)).chain(given.into_iter().map(fixed));
    let shares = (0..count).map(|_| open(0.0, f64::NEG_INFINITY, f64::INFINITY));
    Some(ModelEffect { entry, values: own.chain(shares).collect() })
}

pub(super) fn sloped(placed: &ModelEffect, along: Along, change: f64, scale: f64) -> Option<ModelEffect> {
    let entry = regional(placed.entry, along, Shape::Slope)?;
    let further = [fixed(code(along, Shape::Slope)), fixed(scale), open(change, -30.0, 100.0)];
    Some(ModelEffect { entry, values: placed.values.iter().copied().chain(further).collect() })
}

/// Where the parts of a variable's range begin and end: of time even ones, of states such as hold a tenth of the samples each.
pub(super) fn parts(along: Along, runs: &[Run], predicted: &[Predicted]) -> Option<Vec<f64>> {
    let share = |i: usize| i as f64 / PARTS as f64;
    if along == Along::Time {
        let first = runs.iter().map(|run| run.elapsed).fold(f64::INFINITY, f64::min);
        let last = runs.iter().map(|run| run.elapsed + run.len() as f64 * run.dt).fold(0.0, f64::max);
        return Some((0..=PARTS).map(|i| first + (last - first) * share(i)).collect());
    }
    let each = runs.iter().zip(predicted).map(|(run, predicted)| seen(along, run, predicted));
    let mut values: Vec<f64> = each.collect::<Option<Vec<_>>>()?.concat();
    values.retain(|v| v.is_finite());
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let mut ends: Vec<f64> = (0..=PARTS).map(|i| values[(share(i) * last as f64) as usize]).collect();
    let least = 1e-3 * (ends[PARTS] - ends[0]);
    for i in 1..=PARTS {
        ends[i] = ends[i].max(ends[i - 1] + least);
    }
    (least > 0.0).then_some(ends)
}

/// What a run passes through of a variable, sample by sample, no number where it was not recorded; none where a run has no such variable.
pub(super) fn seen(along: Along, run: &Run, predicted: &Predicted) -> Option<Vec<f64>> {
    let x = &predicted.displacement;
    let velocity = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(x.len() - 1));
        (x[after] - x[before]) / ((after - before).max(1) as f64 * run.dt)
    };
    match along {
        Along::Time => Some((0..run.len()).map(|k| run.elapsed + k as f64 * run.dt).collect()),
        Along::Displacement => Some(x.clone()),
        Along::Velocity => Some((0..x.len()).map(velocity).collect()),
        Along::Speed => Some((0..x.len()).map(|k| velocity(k).abs()).collect()),
        // A prescribed motion has no command of its own.
        Along::Command if run.motion.is_some() => None,
        Along::Command => {
            let unknown = || vec![f64::NAN; run.len()];
            Some(run.channel(Channel::Command).map_or_else(unknown, |command| command.values.clone()))
        }
    }
}

/// The first and the last part of every row of neighbouring parts but the whole.
pub(super) fn spans(parts: usize) -> impl Iterator<Item = (usize, usize)> {
    let all = (0..parts).flat_map(move |first| (first..parts).map(move |last| (first, last)));
    all.filter(move |(first, last)| last - first + 1 < parts)
}

/// Where a model's effect that acts in a window has what says so.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Which of the model's effects it is.
    pub(super) effect: usize,
    /// Along what it acts.
    pub(super) along: Along,
    /// Which of its values is the width of the ends.
    pub(super) width: usize,
    /// Which are the ends.
    pub(super) ends: [usize; 2],
}

impl Window {
    /// The first of a model's; none where no effect acts in one.
    pub(super) fn of(model: &Model) -> Option<Self> {
        model.effects.iter().enumerate().find_map(|(effect, placed)| {
            let (place, along, shape) = form(placed.entry, &placed.numbers())?;
            let ends = [place + 2, place + 3];
            (shape == Shape::Window).then_some(Self { effect, along, width: place + 1, ends })
        })
    }
}

/// An effect in the region of another.
pub(super) fn in_region_of(other: &ModelEffect, plain: ModelEffect) -> Option<ModelEffect> {
    let (place, along, shape) = form(other.entry, &other.numbers())?;
    let entry = regional(plain.entry, along, shape)?;
    Some(ModelEffect { entry, values: plain.values.into_iter().chain(other.values[place..].iter().copied()).collect() })
}
