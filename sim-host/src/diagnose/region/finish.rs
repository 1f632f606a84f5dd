//! Brings a form that acts in a region to its end, and holds it against what it is mistaken for.

use super::super::judged::ScoredModel;
use super::super::rivals::alike;
use super::super::search::{CHANCE, Search};
use super::super::split::{Weighing, stretch_length};
use super::ends::{Window, beyond, in_region_of};
use super::fitted;
use super::promised::strength;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit, squares};
use crate::identify::model::{Model, ModelEffect, SignalScales, Value};
use crate::plant::effects::Entry;
use crate::plant::effects::regional::Along;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Width of sharper ends over that of softer ones, and how often they are sharpened.
const SHARPER: f64 = 0.2;
const SHARPENED: usize = 3;
/// Widths of a window's end by which it is shifted, and how often all are tried.
const SHIFTS: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];
const ROUNDS: usize = 4;
/// Places on either side of an end, within the length of a stretch, at which it may lie unseen.
const UNSEEN: i32 = 8;
/// Shares of its start from which what a double has, and the other does not, is begun.
const FRESH: [f64; 3] = [0.3, 1.0, 3.0];
/// Share of the way from another law to a start of one that holds it.
const NEAR: f64 = 0.1;
/// How far the best are taken.
const FULL: Effort = Effort { steps: 14, tolerance: 1e-5 };

/// A form fitted to the end, a window once its ends are near where they belong: first with soft ends, along which a fit finds its
/// way, then with sharper ones as long as these leave less.
pub(super) fn finished(weighing: &Weighing, fit: Fit) -> Result<ScoredModel, SimulateError> {
    let runs = weighing.fitted();
    let mut best = settled(fit, runs)?;
    let Some(Window { effect, width, .. }) = Window::of(&best.model) else { return ScoredModel::of(best, weighing) };
    for _ in 0..SHARPENED {
        let mut model = best.model.clone();
        model.effects[effect].values[width].value *= SHARPER;
        let sharp = settled(Fit::resume(model, best.locals.clone(), runs)?, runs)?;
        if sharp.squares >= best.squares {
            break;
        }
        best = sharp;
    }
    unseen(endless(best, runs)?, weighing)
}

/// A form in the window of one that was finished: the ends need no more sharpening.
fn finished_as_sharp(weighing: &Weighing, fit: Fit) -> Result<ScoredModel, SimulateError> {
    let runs = weighing.fitted();
    unseen(endless(settled(fit, runs)?, runs)?, weighing)
}

/// A form fitted to the end with its window's ends as sharp as they are.
fn settled(fit: Fit, runs: &[Run]) -> Result<Fit, SimulateError> {
    let mut best = shifted(fit, runs)?;
    best.improve(runs, FULL)?;
    Ok(best)
}

/// The form with one open end only, where the other takes away no more than chance does: what was seen ends there, and not the effect.
fn endless(fit: Fit, runs: &[Run]) -> Result<Fit, SimulateError> {
    let Some(Window { effect, ends, .. }) = Window::of(&fit.model) else { return Ok(fit) };
    let own = ends.map(|end| fit.model.effects[effect].values[end]);
    if own.iter().any(|value| !value.free) {
        return Ok(fit);
    }
    let without = |(end, value): (usize, Value)| -> Result<(f64, Model), SimulateError> {
        let mut model = fit.model.clone();
        model.effects[effect].values[end] = value;
        Ok((squares(&model, &fit.locals, runs)?, model))
    };
    let each = ends.into_iter().zip(beyond(own)).map(without).collect::<Result<Vec<_>, _>>()?;
    let best = each.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    match best.filter(|(left, _)| *left < fit.squares + CHANCE) {
        Some((_, model)) => Fit::resume(model, fit.locals, runs),
        None => Ok(fit),
    }
}

/// The form with each open end where it predicts best among places that the runs fitted do not tell apart: what is held out of them lies
/// in stretches, and an end within one is a choice that the stretches held out make, as they make every other.
fn unseen(best: Fit, weighing: &Weighing) -> Result<ScoredModel, SimulateError> {
    let runs = weighing.fitted();
    let mut judged = ScoredModel::of(best, weighing)?;
    let Some(window) = Window::of(&judged.fit.model).filter(|window| window.along == Along::Time) else {
        return Ok(judged);
    };
    let length = runs.iter().map(|run| stretch_length(run) as f64 * run.dt).fold(0.0, f64::max);
    let least = judged.fit.squares;
    for end in window.ends {
        let Value { value, low, high, free, .. } = judged.fit.model.effects[window.effect].values[end];
        let places = (-UNSEEN..=UNSEEN).map(|i| value + length * f64::from(i) / f64::from(UNSEEN));
        for place in places.filter(|place| free && (low..=high).contains(place)) {
            let mut model = judged.fit.model.clone();
            model.effects[window.effect].values[end].value = place;
            if squares(&model, &judged.fit.locals, runs)? > least + CHANCE {
                continue;
            }
            let fit = Fit::resume(model, judged.fit.locals.clone(), runs)?;
            let other = ScoredModel::of(fit, weighing)?;
            if other.hold.chi2 < judged.hold.chi2 {
                judged = other;
            }
        }
    }
    Ok(judged)
}

/// The fit with each open end of its window where it leaves least among places nearby: only the samples at an end say where it
/// is to be, and a step that looks at these alone halts at the first that it would lose.
fn shifted(fit: Fit, runs: &[Run]) -> Result<Fit, SimulateError> {
    let mut model = fit.model.clone();
    let Some(Window { effect: own, width, ends, .. }) = Window::of(&model) else { return Ok(fit) };
    let width = model.effects[own].values[width].value;
    let mut least = squares(&model, &fit.locals, runs)?;
    let first = least;
    for _ in 0..ROUNDS {
        let before = least;
        for end in ends {
            let Value { value, low, high, free, .. } = model.effects[own].values[end];
            let places = SHIFTS.iter().flat_map(|shift| [-shift, *shift]).map(|shift| value + shift * width);
            let places: Vec<f64> = places.filter(|place| free && (low..=high).contains(place)).collect();
            let tried = places.into_par_iter().map(|place| -> Result<(f64, f64), SimulateError> {
                let mut moved = model.clone();
                moved.effects[own].values[end].value = place;
                Ok((squares(&moved, &fit.locals, runs)?, place))
            });
            let tried = tried.collect::<Result<Vec<_>, _>>()?;
            if let Some(&(left, place)) = tried.iter().min_by(|a, b| a.0.total_cmp(&b.0)).filter(|t| t.0 < least) {
                (least, model.effects[own].values[end].value) = (left, place);
            }
        }
        if least >= before {
            break;
        }
    }
    if least < first { Fit::resume(model, fit.locals, runs) } else { Ok(fit) }
}

/// What the best of what was found in a region is mistaken for, in the same region, but for what was found itself: what explains little of
/// whole runs, and was not looked at for that, may be the law of a part. What holds the best as a case of its own is looked at again:
/// begun far from it, it may have ended where it is no more than that.
pub(super) fn doubles(
    weighing: &Weighing,
    search: &Search,
    (leader, found): (&ScoredModel, &[ScoredModel]),
) -> Result<Vec<ScoredModel>, SimulateError> {
    let stated = search.baseline.model.ids();
    let own = leader.fit.model.effects.iter().find(|p| !stated.contains(&p.entry.id));
    let Some(own) = own else { return Ok(Vec::new()) };
    let holds = |other: &Entry| other.contains.contains(&own.entry.id);
    // The rest of the model is where the best has brought it.
    let rest = Fit::resume(leader.fit.model.without(own.entry.id), leader.fit.locals.clone(), weighing.fitted())?;
    let double = |entry: &'static Entry| -> Result<Option<ScoredModel>, SimulateError> {
        let from_afar = (0..).map_while(|i| ModelEffect::start(entry, i, &search.signal_scales));
        let starts = from_afar.filter(|_| !holds(entry)).chain(after(own, entry, &search.signal_scales));
        let starts: Vec<ModelEffect> = starts.filter_map(|plain| in_region_of(own, plain)).collect();
        let look = |placed| fitted(weighing, &rest, placed);
        let looks = starts.into_par_iter().map(look).collect::<Result<Vec<_>, _>>()?;
        let best = looks.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
        let half = search.baseline.squares - 0.5 * (search.baseline.squares - search.baseline.rows as f64);
        best.filter(|fit| fit.squares < half).map(|fit| finished_as_sharp(weighing, fit)).transpose()
    };
    let known = search.baseline.model.candidates();
    let unknown = |other: &Entry| found.iter().all(|judged| !judged.added.contains(&other.id));
    let new = |other: &&Entry| alike(own.entry, other) && (holds(other) || unknown(other));
    let doubles: Vec<&'static Entry> = known.into_iter().filter(new).collect();
    let fits = doubles.into_par_iter().map(double).collect::<Result<Vec<_>, _>>()?;
    Ok(fits.into_iter().flatten().collect())
}

/// A double with the values of what another has too, and what is of its strength's unit in the proportion of a start: one law goes on
/// from where the other has come to. What the other does not have is begun from smaller values and from larger ones too; a law that
/// holds the other as a case of its own begins near that case, for from further away it may not find the way to the other's fit.
pub(super) fn after(other: &ModelEffect, entry: &'static Entry, scales: &SignalScales) -> Vec<ModelEffect> {
    let near = if entry.contains.contains(&other.entry.id) { NEAR } else { 1.0 };
    let Some(plain) = ModelEffect::start(entry, 0, scales) else { return Vec::new() };
    let strongest = || {
        let first = strength(&plain)?;
        Some((first, known(other, entry.parameters[first].key)?))
    };
    let Some((first, size)) = strongest() else { return Vec::new() };
    let (unit, of_start) = (entry.parameters[first].unit, plain.values[first].value);
    let begun = |share: f64| {
        let mut placed = plain.clone();
        for (value, parameter) in placed.values.iter_mut().zip(entry.parameters).filter(|(value, _)| value.free) {
            let like_strength = unit != "1" && parameter.unit == unit;
            let fresh =
                if like_strength { size * (1.0 + near * (value.value / of_start - 1.0)) } else { share * value.value };
            value.value = known(other, parameter.key).unwrap_or(fresh).clamp(value.low, value.high);
        }
        placed
    };
    let mut starts: Vec<ModelEffect> = FRESH.into_iter().map(begun).collect();
    starts.dedup_by(|a, b| a.numbers() == b.numbers());
    starts
}

/// The value of that parameter.
fn known(effect: &ModelEffect, key: &str) -> Option<f64> {
    effect.entry.parameters.iter().position(|p| p.key == key).map(|i| effect.values[i].value)
}
