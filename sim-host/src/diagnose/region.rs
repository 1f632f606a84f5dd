//! Whether what the library's effects leave as they stand is one of them in a part of the runs or of the state alone, or with a
//! strength that changes along it.
//!
//! Of every effect that explains something alone, what it would do in each tenth of a run's time, stroke or speed is simulated. The
//! sums over neighbouring tenths say in one linear step which window, and which slope, takes most away; the best few are fitted
//! to the end and weighed as every other hypothesis is, their ends and slopes being parameters with a price.

use super::calibration::CALIBRATION;
use super::decide::weigh;
use super::judged::{Decision, Judged};
use super::ranking::Ranking;
use super::residual::{judged_channels, residual};
use super::search::Search;
use super::split::Weighing;
use super::standing::{outside, stands};
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::{Predicted, predict};
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::{Model, Placed, Value};
use crate::plant::effects::regional::{Along, Shape, code, regional};
use crate::plant::effects::{Parameter, Role};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Parts that the range of a variable is cut into.
const PARTS: usize = 10;
/// Effects that are looked at, those that alone explain most first: all of short runs, fewer of long ones.
const LOOKED_AT: usize = 20;
/// Samples of which all are looked at.
const SHORT: usize = 40_000;
/// Forms that are fitted.
const FITTED: usize = 5;
/// Share of the squares beyond the noise that a form must promise to take away to be fitted.
const PROMISING: f64 = 0.3;
/// Width of a window's ends, as a share of the range.
const EDGE: f64 = 0.01;
/// Ranges beyond what was seen at which a window that has no end there ends: other runs move farther.
const BEYOND: f64 = 10.0;
/// How far the best are taken.
const LOOK: Effort = Effort { steps: 8, tolerance: 1e-4 };
const FULL: Effort = Effort { steps: 14, tolerance: 1e-5 };

/// A form that one linear step promises something of.
struct Start {
    placed: Placed,
    /// Squares that it takes away.
    gain: f64,
}

/// The decision with an effect that acts in a region in the place of what was accepted, where that explains more for its price.
pub(super) fn region(weighing: &Weighing, search: &Search, decision: Decision) -> Result<Decision, SimulateError> {
    if !is_open(&decision) {
        return Ok(decision);
    }
    let mut starts = starts(weighing.fitted(), search)?;
    starts.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let excess = search.baseline.squares - search.baseline.rows as f64;
    starts.retain(|start| start.gain > PROMISING * excess);
    starts.truncate(FITTED);
    let fits = starts.into_par_iter().map(|start| fitted(weighing, &search.baseline, start));
    let mut fits = fits.collect::<Result<Vec<_>, _>>()?;
    fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    let best = fits.into_par_iter().take(3).map(|mut fit| {
        fit.improve(weighing.fitted(), FULL)?;
        Judged::of(fit, weighing)
    });
    let mut found = best.collect::<Result<Vec<_>, _>>()?;
    accept(weighing, decision, &mut found)
}

/// True where names are few and leave nothing: there is then nothing to look for.
fn is_open(decision: &Decision) -> bool {
    decision.unlisted || decision.more_missing || decision.after.added.len() > 1
}

/// Weighs what was found with all others, and accepts the best of it where it stands and costs less.
fn accept(weighing: &Weighing, decision: Decision, found: &mut Vec<Judged>) -> Result<Decision, SimulateError> {
    let before = &decision.before;
    let present = &decision.after;
    let ranking = Ranking::new(before, found.iter().chain([present]));
    found.sort_by(|a, b| ranking.cost(a).total_cmp(&ranking.cost(b)));
    let mut seen: Vec<Vec<&'static str>> = Vec::new();
    found.retain(|judged| {
        let new = !seen.contains(&judged.added);
        seen.push(judged.added.clone());
        new
    });
    let Some(best) = found.first() else { return Ok(decision) };
    let left = |judged: &Judged| (judged.hold.chi2 - 1.0).max(0.0);
    let better = ranking.cost(best) < ranking.cost(present) && left(best) < CALIBRATION.region * left(present);
    if !better || !stands(before, before, best, false) || outside(before, best).0 {
        return Ok(decision);
    }
    let (best, others) = (best.clone(), found.iter().skip(1).cloned());
    let known = decision.candidates.into_iter().filter(|c| !c.added.is_empty() && !seen.contains(&c.added));
    let sizes = vec![others.chain(known).collect()];
    weigh(weighing, decision.before, best, sizes)
}

fn fitted(weighing: &Weighing, baseline: &Fit, start: Start) -> Result<Fit, SimulateError> {
    let runs = weighing.fitted();
    let mut fit = Fit::resume(baseline.model.with(start.placed), baseline.locals.clone(), runs)?;
    fit.improve(runs, LOOK)?;
    Ok(fit)
}

/// Every form of every effect looked at, with what a linear step promises of it.
fn starts(runs: &[Run], search: &Search) -> Result<Vec<Start>, SimulateError> {
    let predicted = |model: &Model| -> Result<Vec<Predicted>, SimulateError> {
        runs.iter().zip(&search.baseline.locals).map(|(run, local)| predict(model, run, local)).collect()
    };
    let samples: usize = runs.iter().map(Run::len).sum();
    let looks = (LOOKED_AT * SHORT / samples.max(1)).clamp(4, LOOKED_AT);
    let base = predicted(&search.baseline.model)?;
    let left = stacked(runs, &base);
    let ranges: Vec<(Along, Vec<f64>)> =
        Along::ALL.into_iter().filter_map(|along| Some((along, ends(along, runs, &base)?))).collect();
    let singles = search.grown.first().map_or(&[][..], Vec::as_slice);
    let placed = singles.iter().filter_map(|fit| {
        let own = fit.model.effects.iter().find(|p| !search.baseline.model.ids().contains(&p.entry.id))?;
        let per_run = own.entry.parameters.iter().any(|p| p.role == Role::PerRun);
        (!per_run && regional(own.entry, Along::Time, Shape::Window).is_some()).then_some(own)
    });
    let looked_at: Vec<&Placed> = placed.take(looks).collect();
    let tasks: Vec<(&Placed, &(Along, Vec<f64>))> =
        looked_at.iter().flat_map(|placed| ranges.iter().map(move |range| (*placed, range))).collect();
    let each = tasks.into_par_iter().map(|(placed, (along, ends))| -> Result<Vec<Start>, SimulateError> {
        let parts = (0..PARTS).map(|i| {
            let Some(inside) = window(placed, *along, (ends[i], ends[i + 1]), ends) else { return Ok(Vec::new()) };
            let seen = stacked(runs, &predicted(&search.baseline.model.with(inside))?);
            Ok(left.iter().zip(seen).map(|(left, seen)| left - seen).collect())
        });
        let parts = parts.collect::<Result<Vec<Vec<f64>>, SimulateError>>()?;
        Ok(promised(placed, *along, ends, &left, &parts))
    });
    Ok(each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// The best window and the best slope by what each part changes.
fn promised(placed: &Placed, along: Along, ends: &[f64], left: &[f64], parts: &[Vec<f64>]) -> Vec<Start> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let gram: Vec<Vec<f64>> = parts.iter().map(|a| parts.iter().map(|b| dot(a, b)).collect()).collect();
    let along_left: Vec<f64> = parts.iter().map(|part| dot(part, left)).collect();
    let of = |weights: &[f64; PARTS], other: &[f64; PARTS]| -> f64 {
        (0..PARTS).map(|i| (0..PARTS).map(|j| weights[i] * other[j] * gram[i][j]).sum::<f64>()).sum()
    };
    let with_left = |weights: &[f64; PARTS]| (0..PARTS).map(|i| weights[i] * along_left[i]).sum::<f64>();
    let mut starts = Vec::new();
    let inner = |first: usize, last: usize| std::array::from_fn(|i| f64::from((first..=last).contains(&i)));
    let spans = (0..PARTS).flat_map(|first| (first..PARTS).map(move |last| (first, last)));
    let windows = spans.filter(|(first, last)| last - first + 1 < PARTS).map(|(first, last)| {
        let weights = inner(first, last);
        let (own, c) = (of(&weights, &weights), with_left(&weights));
        let strength = c / own.max(f64::MIN_POSITIVE);
        (if strength > 0.0 || either_sign(placed) { c * strength } else { 0.0 }, first, last)
    });
    if let Some((gain, first, last)) = windows.max_by(|a, b| a.0.total_cmp(&b.0)) {
        let weights = inner(first, last);
        let placed = &strengthened(placed, with_left(&weights) / of(&weights, &weights));
        starts.extend(window(placed, along, (ends[first], ends[last + 1]), ends).map(|placed| Start { placed, gain }));
    }
    let scale = ends[PARTS].abs().max(ends[0].abs()).max(f64::MIN_POSITIVE);
    let (even, rising): ([f64; PARTS], [f64; PARTS]) =
        ([1.0; PARTS], std::array::from_fn(|i| 0.5 * (ends[i] + ends[i + 1]) / scale));
    let (a, b, d) = (of(&even, &even), of(&even, &rising), of(&rising, &rising));
    let (p, q, det) = (with_left(&even), with_left(&rising), a * d - b * b);
    if det > 1e-9 * a * d {
        let (level, slope) = ((d * p - b * q) / det, (a * q - b * p) / det);
        let gain = level * p + slope * q;
        let change = (slope / level).clamp(-3.0, 10.0);
        if (level > 0.0 || either_sign(placed)) && change.is_finite() {
            let placed = &strengthened(placed, level);
            starts.extend(sloped(placed, along, change, scale).map(|placed| Start { placed, gain }));
        }
    }
    starts
}

/// The parameter that says how strong an effect is: its first free one.
fn strength(placed: &Placed) -> Option<usize> {
    placed.values.iter().position(|value| value.free)
}

/// True where an effect may be turned round: found over the whole of a run it may have the sign that it has not in a part.
fn either_sign(placed: &Placed) -> bool {
    strength(placed).is_some_and(|first| !placed.values[first].positive && placed.values[first].low < 0.0)
}

/// An effect with a strength so many times as large: what it does is in proportion to the distance of its first parameter from
/// none, but for a frequency, to which it is in proportion the other way. What is of the same unit grows with it.
fn strengthened(placed: &Placed, factor: f64) -> Placed {
    let mut placed = placed.clone();
    let factor = factor.signum() * factor.abs().clamp(0.1, 30.0);
    let Some(first) = strength(&placed) else { return placed };
    let entry = placed.entry;
    let Parameter { key, unit, .. } = entry.parameters[first];
    let none = if key == "gain" { 1.0 } else { 0.0 };
    let factor = if key == "frequency" { 1.0 / factor } else { factor };
    for (i, (value, parameter)) in placed.values.iter_mut().zip(entry.parameters).enumerate() {
        if i == first || (value.free && unit != "1" && parameter.unit == unit) {
            value.value = (none + factor * (value.value - none)).clamp(value.low, value.high);
        }
    }
    placed
}

fn fixed(value: f64) -> Value {
    Value { free: false, ..open(value, f64::NEG_INFINITY, f64::INFINITY) }
}

fn open(value: f64, low: f64, high: f64) -> Value {
    Value { value, low, high, positive: false, free: true, prior: None }
}

/// An effect with the values found for it alone, in a window. One that reaches an end of what was seen has no end there: it lies beyond,
/// where nothing could fit it.
fn window(placed: &Placed, along: Along, (from, to): (f64, f64), ends: &[f64]) -> Option<Placed> {
    let entry = regional(placed.entry, along, Shape::Window)?;
    let (low, high) = (ends[0], ends[PARTS]);
    let range = high - low;
    let end = |value| open(value, low - 0.2 * range, high + 0.2 * range);
    let from = if from <= low { fixed(low - BEYOND * range) } else { end(from) };
    let to = if to >= high { fixed(high + BEYOND * range) } else { end(to) };
    let further = [fixed(code(along, Shape::Window)), fixed(EDGE * range), from, to];
    Some(Placed { entry, values: placed.values.iter().copied().chain(further).collect() })
}

fn sloped(placed: &Placed, along: Along, change: f64, scale: f64) -> Option<Placed> {
    let entry = regional(placed.entry, along, Shape::Slope)?;
    let further = [fixed(code(along, Shape::Slope)), fixed(scale), open(change, -30.0, 100.0)];
    Some(Placed { entry, values: placed.values.iter().copied().chain(further).collect() })
}

/// The residuals of every judged channel of every run, one after the other; zero where nothing was measured.
fn stacked(runs: &[Run], predicted: &[Predicted]) -> Vec<f64> {
    let of = |(run, predicted): (&Run, &Predicted)| {
        let channels = judged_channels(run).into_iter();
        channels.flat_map(|channel| residual(run, predicted, channel).unwrap_or_default()).collect::<Vec<f64>>()
    };
    let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
    runs.iter().zip(predicted).flat_map(of).map(finite).collect()
}

/// Where the parts of a variable's range begin and end: of time even ones, of states such as hold a tenth of the samples each.
fn ends(along: Along, runs: &[Run], predicted: &[Predicted]) -> Option<Vec<f64>> {
    let share = |i: usize| i as f64 / PARTS as f64;
    if along == Along::Time {
        let longest = runs.iter().map(|run| run.len() as f64 * run.dt).fold(0.0, f64::max);
        return Some((0..=PARTS).map(|i| longest * share(i)).collect());
    }
    let mut values: Vec<f64> = Vec::new();
    for (run, predicted) in runs.iter().zip(predicted) {
        let place = run.measured.iter().position(|m| m.channel == Channel::Displacement)?;
        let x = &predicted.channels[place];
        match along {
            Along::Displacement => values.extend(x),
            _ => values.extend(x.windows(3).map(|w| (w[2] - w[0]) / (2.0 * run.dt))),
        }
    }
    if along == Along::Speed {
        for v in &mut values {
            *v = v.abs();
        }
    }
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

#[cfg(test)]
mod tests;
