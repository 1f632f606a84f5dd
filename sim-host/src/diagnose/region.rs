//! Whether what the library's effects leave as they stand is one of them in a part of the runs or of the state alone, or with a
//! strength that changes along it.
//!
//! Of every effect that explains something alone, what it would do in each fifth of a run's time, stroke or speed is simulated, and
//! in each tenth where that promises most; of one that explains little alone, what a little of it would do in every tenth is told by one
//! simulation with derivatives. The sums over neighbouring parts say in one linear step which window, and which slope,
//! takes most away; the best few are fitted to the end and weighed as every other hypothesis is, their ends and slopes being
//! parameters with a price.

mod cut;
mod ends;
mod finish;
mod per_run;
mod promised;

use super::calibration::CALIBRATION;
use super::decide::weigh;
use super::judged::{Decision, ScoredModel};
use super::ranking::Ranking;
use super::search::Search;
use super::split::Weighing;
use super::standing::{is_justified, leaves_next_to_nothing, outside};
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::ModelEffect;
use crate::plant::effects::regional::{Along, form};
use crate::plant::simulate::SimulateError;
use finish::{doubles, finished};
use promised::promising;
use rayon::prelude::*;

/// Effects of which forms are fitted to the end, and along how many variables each: what fits well along one before its ends are
/// where they belong may be the double of the same along another.
const FINISHED: usize = 3;
const VARIABLES: usize = 2;
/// How many times as much as what was accepted a form may leave once it was looked at, for finishing it to matter.
const FINISHING: f64 = 3.0;
/// How far a form is taken from its start.
const LOOK: Effort = Effort { steps: 8, tolerance: 1e-4 };

/// A form that one linear step promises something of.
struct Start {
    placed: ModelEffect,
    /// Squares that it takes away.
    gain: f64,
}

/// The decision with an effect that acts in a region in the place of what was accepted, where that explains more for its price.
pub(super) fn region(weighing: &Weighing, search: &Search, decision: Decision) -> Result<Decision, SimulateError> {
    if !is_open(&decision) {
        return Ok(decision);
    }
    let starts = promising(weighing.fitted(), search)?;
    let fits = starts.into_par_iter().map(|placed| fitted(weighing, &search.baseline, placed));
    let mut fits = fits.collect::<Result<Vec<_>, _>>()?;
    keep_best(&mut fits);
    let beyond = |fit: &Fit| fit.chi2() - 1.0;
    let accepted = beyond(&decision.accepted.fit).max(left(&decision.accepted));
    let within_reach = FINISHING * accepted.max(CALIBRATION.hidden);
    fits.retain(|fit| beyond(fit) < within_reach);
    let best = fits.into_par_iter().map(|fit| finished(weighing, fit));
    let mut found = best.collect::<Result<Vec<_>, _>>()?;
    let ranking = Ranking::new(&decision.stated, &found);
    if let Some(leader) = found.iter().min_by(|a, b| ranking.cost(a).total_cmp(&ranking.cost(b))) {
        found.extend(doubles(weighing, search, (leader, &found))?);
    }
    accept(weighing, decision, &mut found)
}

/// Keeps the best form along each variable, of the variables and effects that leave least.
fn keep_best(fits: &mut Vec<Fit>) {
    fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    let mut kept: Vec<(Vec<&'static str>, Vec<Along>)> = Vec::new();
    fits.retain(|fit| {
        let along = fit.model.effects.iter().find_map(|p| form(p.entry, &p.numbers())).map(|(_, along, _)| along);
        let (Some(along), set) = (along, fit.model.ids()) else { return false };
        if let Some((_, variables)) = kept.iter_mut().find(|(known, _)| *known == set) {
            let new = variables.len() < VARIABLES && !variables.contains(&along);
            variables.extend(new.then_some(along));
            return new;
        }
        let room = kept.len() < FINISHED;
        kept.extend(room.then(|| (set, vec![along])));
        room
    });
}

/// False where several names leave next to nothing of the mismatch, or one so little that nothing else could be seen beneath it.
fn is_open(decision: &Decision) -> bool {
    let accepted = &decision.accepted;
    let nothing = match accepted.added.len() {
        0 | 1 => left(accepted) <= CALIBRATION.hidden,
        _ => leaves_next_to_nothing(&decision.stated, accepted),
    };
    decision.unlisted || decision.more_missing || !nothing
}

/// True where one name, or none, is enough.
fn stands(decision: &Decision) -> bool {
    !decision.unlisted && !decision.more_missing && decision.accepted.added.len() < 2
}

/// Excess of chi2 on the stretches that weigh.
fn left(judged: &ScoredModel) -> f64 {
    (judged.hold.chi2 - 1.0).max(0.0)
}

/// Weighs what was found with all others, and accepts the best of it where it stands and costs less.
fn accept(weighing: &Weighing, decision: Decision, found: &mut Vec<ScoredModel>) -> Result<Decision, SimulateError> {
    let before = &decision.stated;
    let present = &decision.accepted;
    let ranking = Ranking::new(before, found.iter().chain([present]));
    ranking.sort(found);
    let mut seen: Vec<Vec<&'static str>> = Vec::new();
    found.retain(|judged| {
        let new = !seen.contains(&judged.added);
        seen.push(judged.added.clone());
        new
    });
    let Some(best) = found.first() else { return Ok(decision) };
    let most = if stands(&decision) { CALIBRATION.region_of_a_name } else { CALIBRATION.region };
    let better = ranking.cost(best) < ranking.cost(present) && left(best) < most * left(present);
    if !better || !is_justified(before, before, best, false) || outside(before, best).0 {
        return Ok(decision);
    }
    let (best, others) = (best.clone(), found.iter().skip(1).cloned());
    let known = decision.candidates.into_iter().filter(|c| !c.added.is_empty() && !seen.contains(&c.added));
    let sizes = vec![others.chain(known).collect()];
    weigh(weighing, decision.stated, best, sizes)
}

/// A form beside the stated model, taken some way.
fn fitted(weighing: &Weighing, baseline: &Fit, placed: ModelEffect) -> Result<Fit, SimulateError> {
    let runs = weighing.fitted();
    let mut fit = Fit::resume(baseline.model.with(placed), baseline.locals.clone(), runs)?;
    fit.improve(runs, LOOK)?;
    Ok(fit)
}

#[cfg(test)]
mod tests;
