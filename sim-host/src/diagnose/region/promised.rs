//! What one linear step promises of every form that an effect may have in a region.

use super::super::search::Search;
use super::Start;
use super::cut::Cut;
use super::ends::{parted, sloped, spans, window};
use crate::identify::data::Run;
use crate::identify::evaluate::predict;
use crate::identify::fit::secant::Base;
use crate::identify::model::{Model, ModelEffect};
use crate::plant::effects::regional::{Along, Shape, regional};
use crate::plant::effects::{Parameter, Role};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Effects that are looked at, those that alone explain most first: all of short runs, fewer of long ones.
const LOOKED_AT: usize = 28;
/// Samples of which all are looked at.
const SHORT: usize = 40_000;
/// Parts that are one in a first look, and how many pairs of an effect and a variable get a second look at each part.
const COARSE: usize = 2;
const FINE: usize = 16;
/// Effects that are fitted, each in the forms that promise about as much as its best.
const FITTED: usize = 6;
const AS_GOOD: f64 = 0.9;
/// Share of the squares beyond the noise that an effect must explain everywhere for its values there to be worth starting from.
const TELLING: f64 = 0.1;
/// Share of the squares beyond the noise that a form must promise to take away to be fitted.
const PROMISING: f64 = 0.3;

/// An effect that may act in a region.
struct Candidate {
    placed: ModelEffect,
    /// Whether it explains enough everywhere for its values there to be worth starting from. What so much of it does is simulated part by
    /// part; of what explains little, what a little of it does is enough.
    telling: bool,
}

/// An effect, along what it may act in a region, and where the parts of that end.
type Task<'a> = (&'a Candidate, Along, &'a [f64]);

/// The forms that are worth a fit: of the effects that promise most, those that promise about as much as an effect's best.
pub(super) fn promising(runs: &[Run], search: &Search) -> Result<Vec<ModelEffect>, SimulateError> {
    let mut starts = starts(runs, search)?;
    starts.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    starts.retain(|start| start.gain > PROMISING * excess(search));
    let mut best: Vec<(&'static str, f64)> = Vec::new();
    for start in &starts {
        if best.iter().all(|(id, _)| *id != start.placed.entry.id) {
            best.push((start.placed.entry.id, start.gain));
        }
    }
    best.truncate(FITTED);
    let near =
        |start: &Start| best.iter().any(|&(id, gain)| id == start.placed.entry.id && start.gain > AS_GOOD * gain);
    Ok(starts.into_iter().filter(near).map(|start| start.placed).collect())
}

/// Every form of every effect looked at, with what a linear step promises of it.
fn starts(runs: &[Run], search: &Search) -> Result<Vec<Start>, SimulateError> {
    let Some(base) = Base::of(&search.baseline, runs)? else { return Ok(Vec::new()) };
    let samples: usize = runs.iter().map(Run::len).sum();
    let looks = (LOOKED_AT * SHORT / samples.max(1)).clamp(4, LOOKED_AT);
    let stated = |(run, local)| predict(&search.baseline.model, run, local);
    let shown = runs.iter().zip(&search.baseline.locals).map(stated).collect::<Result<Vec<_>, _>>()?;
    let cuts: Vec<Cut> = Along::ALL.into_iter().filter_map(|along| Cut::of(along, runs, &shown)).collect();
    let singles = search.grown.first().map_or(&[][..], Vec::as_slice);
    let known = search.baseline.model.ids();
    let placed = singles.iter().filter_map(|fit| {
        // Details that were fitted everywhere hide that it acts in a part.
        let (plain, _) = fit.model.plain(&fit.model.ids_beside(&known));
        let own = plain.effects.into_iter().find(|p| !known.contains(&p.entry.id))?;
        // What explains little everywhere has values there that say little.
        let telling = search.baseline.squares - fit.squares > TELLING * excess(search);
        let possible = !per_run(&own) && regional(own.entry, Along::Time, Shape::Window).is_some();
        let typical = || ModelEffect::start(own.entry, 0, &search.signal_scales);
        let placed = possible.then(|| if telling { Some(own.clone()) } else { typical() })??;
        Some(Candidate { placed, telling })
    });
    let looked_at: Vec<Candidate> = placed.take(looks).collect();
    let along = |candidate| {
        cuts.iter().map(move |cut| {
            let (along, ends) = cut.ends();
            (candidate, along, ends)
        })
    };
    let tasks = looked_at.iter().flat_map(along).collect();
    let look = |task: &Task, step| looked(&base, (&search.baseline.model, runs), task, step);
    let fine = most_promising(tasks, |task| look(task, COARSE))?;
    let each = fine.par_iter().map(|task| look(task, 1));
    let mut starts: Vec<Start> = each.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let sized = search.baseline.model.candidates().into_iter();
    for placed in sized.filter_map(|entry| ModelEffect::start(entry, 0, &search.signal_scales)).filter(per_run) {
        let whole = super::per_run::chords(&base, (&search.baseline.model, runs), &placed)?;
        for cut in &cuts {
            starts.extend(super::per_run::start(&base, &placed, &whole, cut));
        }
    }
    Ok(starts)
}

/// What one linear step promises of an effect in a region whose ends are among every so many of those given.
fn looked(
    base: &Base,
    (model, runs): (&Model, &[Run]),
    (Candidate { placed, telling }, along, ends): &Task,
    step: usize,
) -> Result<Vec<Start>, SimulateError> {
    if let Some(parted) = parted(placed, *along, ends).filter(|_| !telling) {
        let products = base.products_of_new(&model.with(parted), runs)?;
        return Ok(products.map_or_else(Vec::new, |products| promised(placed, *along, ends, &products)));
    }
    let ends: Vec<f64> = ends.iter().copied().step_by(step).collect();
    let part = |i: usize| window(placed, *along, (ends[i], ends[i + 1]), &ends);
    let Some(parts) = (0..ends.len() - 1).map(part).collect::<Option<Vec<_>>>() else { return Ok(Vec::new()) };
    let chord = |part| base.chord(&model.with(part), runs);
    let chords = parts.into_iter().map(chord).collect::<Result<Vec<_>, _>>()?;
    Ok(base.products(&chords).map_or_else(Vec::new, |products| promised(placed, *along, &ends, &products)))
}

/// The tasks that promise most at a coarse look.
fn most_promising<'a>(
    tasks: Vec<Task<'a>>,
    look: impl Fn(&Task<'a>) -> Result<Vec<Start>, SimulateError> + Sync,
) -> Result<Vec<Task<'a>>, SimulateError> {
    let most = |task: &Task<'a>| Ok(look(task)?.iter().map(|start| start.gain).fold(0.0, f64::max));
    let gains = tasks.par_iter().map(most).collect::<Result<Vec<f64>, SimulateError>>()?;
    let mut ranked: Vec<(f64, Task<'a>)> = gains.into_iter().zip(tasks).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.truncate(FINE);
    Ok(ranked.into_iter().map(|(_, task)| task).collect())
}

/// Squares that the stated model, refitted, leaves beyond the noise.
fn excess(search: &Search) -> f64 {
    search.baseline.squares - search.baseline.rows as f64
}

/// True where the size belongs to each run.
fn per_run(placed: &ModelEffect) -> bool {
    placed.entry.parameters.iter().any(|p| p.role == Role::PerRun)
}

/// The best window and the best slope by the products of what each part changes, with each other and with what is left.
fn promised(
    placed: &ModelEffect,
    along: Along,
    ends: &[f64],
    (gram, along_left): &(Vec<Vec<f64>>, Vec<f64>),
) -> Vec<Start> {
    let parts = along_left.len();
    let of = |weights: &[f64], other: &[f64]| -> f64 {
        (0..parts).map(|i| (0..parts).map(|j| weights[i] * other[j] * gram[i][j]).sum::<f64>()).sum()
    };
    let with_left = |weights: &[f64]| weights.iter().zip(along_left).map(|(weight, left)| weight * left).sum::<f64>();
    let mut starts = Vec::new();
    let inner = |first: usize, last: usize| -> Vec<f64> {
        (0..parts).map(|i| f64::from((first..=last).contains(&i))).collect()
    };
    let windows = spans(parts).map(|(first, last)| {
        let weights = inner(first, last);
        let (own, c) = (of(&weights, &weights), with_left(&weights));
        let strength = c / own.max(f64::MIN_POSITIVE);
        (if strength > 0.0 || either_sign(placed) { c * strength } else { 0.0 }, first, last)
    });
    if let Some((gain, first, last)) = windows.filter(|(gain, ..)| gain.is_finite()).max_by(|a, b| a.0.total_cmp(&b.0))
    {
        let weights = inner(first, last);
        let placed = &strengthened(placed, with_left(&weights) / of(&weights, &weights));
        let (from, to) = (ends[first], ends[last + 1]);
        starts.extend(window(placed, along, (from, to), ends).map(|placed| Start { placed, gain }));
        // It may end within the outermost part as well as beyond it.
        let within = (
            if first == 0 { 0.5 * (ends[0] + ends[1]) } else { from },
            if last + 1 == parts { 0.5 * (ends[last] + ends[parts]) } else { to },
        );
        if within != (from, to) {
            starts.extend(window(placed, along, within, ends).map(|placed| Start { placed, gain }));
        }
    }
    let scale = ends[parts].abs().max(ends[0].abs()).max(f64::MIN_POSITIVE);
    let even = vec![1.0; parts];
    let rising: Vec<f64> = ends.windows(2).map(|end| 0.5 * (end[0] + end[1]) / scale).collect();
    let (a, b, d) = (of(&even, &even), of(&even, &rising), of(&rising, &rising));
    let (p, q, det) = (with_left(&even), with_left(&rising), a * d - b * b);
    if det > 1e-9 * a * d {
        let (level, slope) = ((d * p - b * q) / det, (a * q - b * p) / det);
        let gain = level * p + slope * q;
        let change = (slope / level).clamp(-3.0, 10.0);
        if (level > 0.0 || either_sign(placed)) && gain.is_finite() && change.is_finite() {
            let placed = &strengthened(placed, level);
            starts.extend(sloped(placed, along, change, scale).map(|placed| Start { placed, gain }));
        }
    }
    starts
}

/// The parameter that says how strong an effect is: its first free one.
pub(super) fn strength(placed: &ModelEffect) -> Option<usize> {
    placed.values.iter().position(|value| value.free)
}

/// True where an effect may be turned round: found over the whole of a run it may have the sign that it has not in a part.
pub(super) fn either_sign(placed: &ModelEffect) -> bool {
    strength(placed).is_some_and(|first| !placed.values[first].positive && placed.values[first].low < 0.0)
}

/// An effect with a strength so many times as large: what it does is in proportion to the distance of its first parameter from
/// none, but for a frequency, to which it is in proportion the other way. What is of the same unit grows with it.
pub(super) fn strengthened(placed: &ModelEffect, factor: f64) -> ModelEffect {
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
