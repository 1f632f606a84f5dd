//! Grows the stated model by effects of the library: one look at every effect from all its starting values, a few steps
//! for those that promise most, the best to the end; then pairs around the best singles, then triples around the best pairs where
//! these leave less than singles do.

mod brief;
mod candidate_starts;
mod details;
mod ringing;

use super::Options;
use super::calibration::CALIBRATION;
use super::departure::Departure;
use super::split::Weighing;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::identify::stated::{fit_from_near, fit_near, fit_stated};
use crate::plant::simulate::SimulateError;
pub(super) use brief::{beginning, beginnings, brief};
pub(super) use candidate_starts::{CandidateStart, candidate_starts};
use candidate_starts::{screen_by_fit, screen_by_secant};
use details::detail;
pub(super) use details::{detailed, refined};
use rayon::prelude::*;

/// Everything the search found.
#[derive(Debug, Clone)]
pub(crate) struct Search {
    /// The stated model, refitted where the experiment allows it.
    pub baseline: Fit,
    /// Every model tried to some depth, best squares first, by number of effects added: singles, pairs, triples.
    pub grown: Vec<Vec<Fit>>,
    /// Sizes of the signals, with the strongest line of the accelerometer's residual found.
    pub signal_scales: SignalScales,
}

/// Most effects added to the stated model.
pub(super) const MOST: usize = 3;
/// Models of each size that are grown further.
const BEAM: usize = 3;
/// Models of each size that are fitted to the end.
const FINALISTS: usize = 7;
/// Models beyond those that are fitted to the end too because they promise most.
const HOPEFUL: usize = 4;
/// Effects that may be the double of another: those that alone explain most.
const DOUBLES: usize = 8;
/// A gain of squares no larger than this is nothing: chance over the whole library.
pub(super) const CHANCE: f64 = 30.0;
/// What is left of the baseline's excess when growing stops.
const SETTLED: f64 = 0.008;
/// The same on the stretches that weigh.
const FORESEEN: f64 = 0.03;
/// Share of what single effects leave beyond the noise that pairs must leave at most for triples to be worth a search: of three effects
/// the second takes away more.
const FUTILE: f64 = 0.7;

/// Searches for what the stated model lacks.
pub(crate) fn search(weighing: &Weighing, options: &Options) -> Result<Search, SimulateError> {
    let (prepared, runs) = (weighing.training.prepared(), weighing.fitted());
    options.say("fitting the stated model", 0.02);
    let baseline = fit_stated(prepared)?;
    let signal_scales = SignalScales { line: super::line::strongest_line(runs, &baseline)?, ..prepared.signal_scales };
    let stated = prepared.model.ids();
    let mut search = Search { baseline, grown: Vec::new(), signal_scales };
    let mut parents = vec![search.baseline.clone()];
    let held_back = Foresight::of(weighing, &search.baseline)?;
    // A refit bends a model far from the truth to hide what is missing, and may hide it whole: values near those stated are a
    // second start, and the only one where it hid all.
    let bent = |fit: &Fit| Departure::of(weighing.model(), fit).disbelief() > CHANCE;
    if explains(&search.baseline) && (bent(&search.baseline) || !held_back.reaches(&search.baseline)?) {
        parents = fit_near(prepared, &search.baseline)?.map_or(parents, |near| vec![near]);
    } else {
        parents.extend(fit_from_near(prepared, &search.baseline)?);
    }
    for size in 0..MOST {
        options.say(["trying single effects", "trying pairs", "trying triples"][size], [0.1, 0.4, 0.7][size]);
        let singles = search.grown.first().cloned().unwrap_or_default();
        search.grown.push(if size == 0 {
            grow_each(&parents, runs, &search.signal_scales)?
        } else {
            grow(&parents, &singles, runs, &search.signal_scales)?
        });
        detail(&mut search.grown, runs)?;
        eliminate(&mut search.grown, &stated, runs)?;
        swap(&mut search.grown, &stated, runs)?;
        let Some(grown) = search.grown.last() else { break };
        let (Some(best), Some(parent)) = (grown.first(), parents.last()) else { break };
        let gain = parent.squares - best.squares;
        let left = (best.chi2() - 1.0) / (search.baseline.chi2() - 1.0).max(1e-9);
        let settled = left < SETTLED && best.chi2() < 1.0 + CALIBRATION.hidden;
        let done = !bent(best) && (explains(best) || settled) && held_back.reaches(best)?;
        let smaller = size.checked_sub(1).and_then(|size| search.grown[size].first());
        let futile = smaller.is_some_and(|fit| best.chi2() - 1.0 > FUTILE * (fit.chi2() - 1.0)) && !explains(best);
        if gain < CHANCE || done || (futile && !bent(best)) {
            break;
        }
        parents = grown.iter().take(BEAM).cloned().collect();
        if explains(best) {
            // The runs fitted are explained, by values far from what was stated or unlike the hold-out runs: the values may have
            // taken in what is missing. Held near, they cannot. Where none is far, a noise that was stated too large hides it.
            let near = parents.iter().map(|fit| fit_near(prepared, fit)).collect::<Result<Vec<_>, _>>()?;
            let near: Vec<Fit> = near.into_iter().flatten().collect();
            if !near.is_empty() {
                parents = near;
            }
        }
    }
    Ok(search)
}

/// Takes effects out of the best models of the last size, one at a time: a companion may have led the other to where it
/// belongs. What does better than before without it takes its place among the smaller models.
fn eliminate(grown: &mut [Vec<Fit>], stated: &[&'static str], runs: &[Run]) -> Result<(), SimulateError> {
    let Some(([.., smaller], larger)) = grown.split_last_mut().map(|(larger, rest)| (rest, larger)) else {
        return Ok(());
    };
    let Some(least) = smaller.first().map(|best| best.squares) else { return Ok(()) };
    let out = |fit: &Fit| fit.model.ids_beside(stated).into_iter().map(|id| (fit.clone(), id)).collect::<Vec<_>>();
    let pairs: Vec<_> = larger.iter().take(BEAM).flat_map(out).collect();
    let refit = |(fit, id): (Fit, &str)| -> Result<Fit, SimulateError> {
        let mut fit = Fit::resume(fit.model.without(id), fit.locals, runs)?;
        fit.improve(runs, Effort { steps: 6, tolerance: 1e-4 })?;
        Ok(fit)
    };
    let refitted = pairs.into_par_iter().map(refit).collect::<Result<Vec<_>, _>>()?;
    smaller.extend(refitted.into_iter().filter(|fit| fit.squares < least));
    best_of_each_set(smaller);
    Ok(())
}

/// Puts each effect of the best model out for one that explained about as much alone: what was taken up first may be the
/// double of what is there. Goes on from a better model while there is one.
fn swap(grown: &mut [Vec<Fit>], stated: &[&'static str], runs: &[Run]) -> Result<(), SimulateError> {
    let Some(([singles, ..], larger)) = grown.split_last_mut().map(|(larger, rest)| (rest, larger)) else {
        return Ok(());
    };
    for _ in 0..MOST {
        let Some(best) = larger.first().filter(|best| !explains(best)) else { return Ok(()) };
        let begun = |model: Model| Fit::resume(model, best.locals.clone(), runs);
        let mut fits =
            single_swaps(best, singles, larger, stated).into_par_iter().map(begun).collect::<Result<Vec<_>, _>>()?;
        fits.sort_by(|a, b| a.promised().total_cmp(&b.promised()));
        fits.truncate(HOPEFUL);
        further(&mut fits, HOPEFUL, Effort { steps: 4, tolerance: 1e-4 }, runs)?;
        further(&mut fits, 1, Effort { steps: 12, tolerance: 1e-5 }, runs)?;
        let better = fits.first().is_some_and(|fit| fit.squares < best.squares - CHANCE);
        larger.extend(fits);
        best_of_each_set(larger);
        if !better {
            return Ok(());
        }
    }
    Ok(())
}

/// The model with each of its effects in turn put out for one of the best alone, but for sets that are known.
fn single_swaps(best: &Fit, singles: &[Fit], known: &[Fit], stated: &[&'static str]) -> Vec<Model> {
    let new = |p: &&ModelEffect| !best.model.ids().contains(&p.entry.id);
    let others = || singles.iter().take(DOUBLES).filter_map(|single| single.model.effects.iter().find(new));
    let swapped = |id| {
        let rest = best.model.without(id);
        others().map(move |placed| rest.with(placed.clone()))
    };
    let unknown = |model: &Model| known.iter().all(|fit| fit.model.ids() != model.ids());
    best.model.ids_beside(stated).into_iter().flat_map(swapped).filter(unknown).collect()
}

/// True where no more is left than noise leaves.
fn explains(fit: &Fit) -> bool {
    fit.squares < fit.rows as f64 + 3.0 * (2.0 * fit.rows as f64).sqrt()
}

/// Whether a model leaves little on the hold-out runs too: what shows there alone is worth another effect.
struct Foresight<'a> {
    weighing: &'a Weighing,
    /// Excess of chi2 over one that is little.
    little: f64,
}

impl<'a> Foresight<'a> {
    fn of(weighing: &'a Weighing, baseline: &Fit) -> Result<Self, SimulateError> {
        let foresight = Self { weighing, little: 0.02 };
        Ok(Self { little: (FORESEEN * foresight.excess(baseline)?).max(foresight.little), ..foresight })
    }

    fn excess(&self, fit: &Fit) -> Result<f64, SimulateError> {
        Ok(self.weighing.score(fit)?.chi2 - 1.0)
    }

    fn reaches(&self, fit: &Fit) -> Result<bool, SimulateError> {
        Ok(self.weighing.weighed().is_empty() || self.excess(fit)? < self.little)
    }
}

/// A model that no search grew, with one effect of the library more.
pub(super) fn grow_beside(parent: &Fit, runs: &[Run], signal_scales: &SignalScales) -> Result<Vec<Fit>, SimulateError> {
    grow(std::slice::from_ref(parent), &[], runs, signal_scales)
}

/// The same as the search grows a model, from what is known of single effects, with the details of the forms of those that promise most
/// fitted too, best first.
pub(super) fn grow_onward(parent: &Fit, search: &Search, runs: &[Run]) -> Result<Vec<Fit>, SimulateError> {
    let singles = search.grown.first().map_or(&[][..], Vec::as_slice);
    let mut grown = vec![grow(std::slice::from_ref(parent), singles, runs, &search.signal_scales)?];
    detail(&mut grown, runs)?;
    Ok(grown.pop().unwrap_or_default())
}

/// Single effects on every fit of the stated model, each grown to its end: a fit that hides what is missing leaves so little that
/// an honest one would never be seen beside it half way.
fn grow_each(parents: &[Fit], runs: &[Run], signal_scales: &SignalScales) -> Result<Vec<Fit>, SimulateError> {
    let mut all = Vec::new();
    for parent in parents {
        all.extend(grow(std::slice::from_ref(parent), &[], runs, signal_scales)?);
    }
    best_of_each_set(&mut all);
    Ok(all)
}

/// Models with one effect more than their parents, best first; each set of effects once. Where the runs are long they are looked at on
/// the beginnings of these and fitted to all from there.
fn grow(
    parents: &[Fit],
    singles: &[Fit],
    runs: &[Run],
    signal_scales: &SignalScales,
) -> Result<Vec<Fit>, SimulateError> {
    let beginnings = parents.first().map_or(Ok(None), |parent| brief(parent, runs))?;
    let seen = beginnings.as_deref().unwrap_or(runs);
    let parents = match beginnings {
        Some(_) => &parents.par_iter().map(|parent| parent.on(seen)).collect::<Result<Vec<_>, _>>()?,
        None => parents,
    };
    let (mut fits, finalists) = looked_at(parents, singles, seen, signal_scales)?;
    if beginnings.is_some() {
        fits = fits.par_iter().map(|fit| fit.on(runs)).collect::<Result<Vec<_>, _>>()?;
        further(&mut fits, finalists, Effort { steps: 1, tolerance: 1e-4 }, runs)?;
    }
    if finalists > 0 {
        further(&mut fits, BEAM, Effort { steps: 12, tolerance: 1e-5 }, runs)?;
    }
    Ok(fits)
}

/// The same with a few steps of those that promise most; and how many these are, none where chance gains as much.
fn looked_at(
    parents: &[Fit],
    singles: &[Fit],
    runs: &[Run],
    signal_scales: &SignalScales,
) -> Result<(Vec<Fit>, usize), SimulateError> {
    let candidate_starts = candidate_starts(parents, singles, signal_scales, runs)?;
    let candidate_starts = screen_by_secant(candidate_starts, parents, runs, singles.is_empty())?;
    let begun = |s: &CandidateStart| Fit::resume(s.model(), s.parent.locals.clone(), runs);
    let fits = candidate_starts.par_iter().map(begun).collect::<Result<Vec<_>, _>>()?;
    let mut fits = screen_by_fit(fits, &candidate_starts, singles.is_empty());
    fits.par_iter_mut().try_for_each(|fit| fit.improve(runs, Effort { steps: 2, tolerance: 1e-4 }))?;
    best_of_each_set(&mut fits);
    let floor = parents.iter().map(|parent| parent.squares).fold(f64::NEG_INFINITY, f64::max) - CHANCE;
    if fits.first().is_some_and(|best| best.squares > floor && best.promised() > floor) {
        return Ok((fits, 0));
    }
    let finalists = seed(&mut fits);
    further(&mut fits, finalists, Effort { steps: 4, tolerance: 1e-4 }, runs)?;
    Ok((fits, finalists))
}

/// Puts those first that deserve more steps: the best so far, and those that promise most; says how many.
fn seed(fits: &mut [Fit]) -> usize {
    let best = FINALISTS.min(fits.len());
    fits[best..].sort_by(|a, b| a.promised().total_cmp(&b.promised()));
    (best + HOPEFUL).min(fits.len())
}

/// Takes the best `count` fits further and puts all in order again.
fn further(fits: &mut [Fit], count: usize, effort: Effort, runs: &[Run]) -> Result<(), SimulateError> {
    let count = count.min(fits.len());
    fits[..count].par_iter_mut().try_for_each(|fit| fit.improve(runs, effort))?;
    fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    Ok(())
}

/// Sorts by squares and keeps the best start of each set of effects.
fn best_of_each_set(fits: &mut Vec<Fit>) {
    fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    let mut seen: Vec<Vec<&'static str>> = Vec::new();
    fits.retain(|fit| {
        let set = fit.model.ids();
        let new = !seen.contains(&set);
        if new {
            seen.push(set);
        }
        new
    });
}
