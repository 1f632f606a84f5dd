//! An equation for what the library does not hold: sparse regression over a grammar of terms.
//!
//! Every term (place x state x form x memory, [`grammar`]) is an effect of the user's own that is still at zero; the sensitivity
//! of the whole closed loop to its coefficient is a column, and what the best model so far leaves is regressed on it with that
//! model's own parameters projected out (`identify::fit::tangents`). The best few are fitted to the training, chosen on the validation, and
//! grown by one more term of the same place while the validation says so. The verdict judges the result on the test.
//!
//! Sources: S. L. Brunton, J. L. Proctor, J. N. Kutz, "Discovering governing equations from data by sparse identification of
//! nonlinear dynamical systems", PNAS 113 (2016) 3932-3937, for the library of terms; the regression is on simulation-error
//! tangents in place of derivatives of noisy signals. J. A. Tropp, A. C. Gilbert, "Signal recovery from random measurements via
//! orthogonal matching pursuit", IEEE Transactions on Information Theory 53 (2007) 4655-4666, for its greedy choice.

mod grammar;
mod naming;
mod placing;
pub(crate) mod report;
mod screening;
mod sizes;
mod writing;

use super::departure::Departure;
use super::judged::ScoredModel;
use super::remainder::{Curved, ResidualCurve, names_needed, remainder};
use super::split::Weighing;
use super::standing::SURE;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::{gains, score};
use crate::identify::quantity::quantities;
use crate::plant::simulate::SimulateError;
use placing::{Piece, model_with};
use rayon::prelude::*;
use screening::{Candidate, screen};

/// An equation with the model that holds it.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    id: &'static str,
    place: &'static str,
    words: String,
    stability: f64,
    pieces: Vec<Piece>,
    reach: grammar::Reach,
    judged: ScoredModel,
}

/// A model of what the library does not hold, as judged on the validation: with an equation, or with a curve.
#[derive(Debug, Clone)]
pub(crate) struct Modelled {
    /// What is reported of the curve; none where there is an equation alone.
    pub remainder: Option<ResidualCurve>,
    /// The equation, where it is the model.
    pub term: Option<Found>,
    /// The model.
    pub judged: ScoredModel,
    /// True where the effects beside it cannot be left to it: without them the best leaves far more.
    pub names_needed: bool,
    /// The model that came second, for the test that would tell the two apart.
    pub rival: Option<Fit>,
}

impl From<Curved> for Modelled {
    fn from(curve: Curved) -> Self {
        let Curved { remainder, judged, names_needed, rival } = curve;
        Self { remainder: Some(remainder), term: None, judged, names_needed, rival }
    }
}

impl Modelled {
    /// The same with effects of the library beside it that cannot be left to it.
    pub(super) fn beside(mut self, judged: ScoredModel) -> Self {
        if let Some(term) = &mut self.term {
            term.judged = judged.clone();
        }
        if let Some(curve) = &mut self.remainder {
            curve.beside.clone_from(&judged.added);
        }
        Self { judged, names_needed: true, ..self }
    }
}

/// Most parameters of an equation.
const MOST: usize = 4;
/// Equations that are fitted at each size, and of those that are fitted to the end.
const FITTED: usize = 5;
const FINALISTS: usize = 3;
/// How far.
const LOOK: Effort = Effort { steps: 4, tolerance: 1e-3 };
const FULL: Effort = Effort { steps: 12, tolerance: 1e-4 };
/// Share of what a name explains that a linear step must promise of an equation in its place.
const PROMISING: f64 = 0.5;
/// Share of what is left that an equation must take away on the validation, and one more term of it.
const WORTH: f64 = 0.3;
const MORE: f64 = 0.35;
/// Most of its gain that blocks may lose elsewhere.
const LOST: f64 = 0.5;
/// Least share of halves of the training that choose the same place.
const STABLE: f64 = 0.5;
/// Deviations from zero of at least one coefficient of each term.
const SIZE: f64 = 3.0;
/// Misfit that an equation may leave, as a share of what a curve through nine knots leaves, and in chi2, to be preferred to it.
const SIMPLER: f64 = 1.25;
const NEAR: f64 = 0.05;

/// Models what the library does not hold: by an equation, or by a curve where that predicts better.
pub(super) fn unlisted(
    weighing: &Weighing,
    before: &ScoredModel,
    beside: &ScoredModel,
) -> Result<Option<Modelled>, SimulateError> {
    let curve = remainder(weighing, before, beside)?;
    let parents = [beside, before].into_iter().take(if beside.added.is_empty() { 1 } else { 2 });
    let mut found = parents.map(|parent| equation(weighing, parent, &|_| true)).collect::<Result<Vec<_>, _>>()?;
    let alone = found.last().and_then(|f| f.as_ref()).map_or_else(|| before.clone(), |f| f.judged.clone());
    found.sort_by(|a, b| chi2(a.as_ref()).total_cmp(&chi2(b.as_ref())));
    let Some(term) = found.into_iter().flatten().next() else { return Ok(curve.map(Into::into)) };
    let left = |chi2: f64| (chi2 - 1.0).max(0.0);
    if let Some(curve) = &curve
        && left(term.judged.hold.chi2) > SIMPLER * left(curve.judged.hold.chi2) + NEAR
    {
        return Ok(Some(curve.clone().into()));
    }
    let names_needed = names_needed(weighing, &term.judged, &alone)?;
    let (remainder, rival) = curve.map_or((None, None), |c| (Some(c.remainder), Some(c.judged.fit)));
    Ok(Some(Modelled { remainder, judged: term.judged.clone(), term: Some(term), names_needed, rival }))
}

/// Models it by an equation in the place of any name.
pub(super) fn alone(weighing: &Weighing, before: &ScoredModel) -> Result<Option<Modelled>, SimulateError> {
    let modelled = |term: Found| {
        let judged = term.judged.clone();
        Modelled { remainder: None, term: Some(term), judged, names_needed: false, rival: None }
    };
    Ok(equation(weighing, before, &|_| true)?.map(modelled))
}

/// Models it by an equation of the valve beside the effects of a model, where a linear step promises at least half of what `named`, which
/// has one effect more, explains.
pub(super) fn of_the_valve(
    weighing: &Weighing,
    less: &ScoredModel,
    named: &ScoredModel,
) -> Result<Option<Modelled>, SimulateError> {
    let explained = (less.fit.squares - named.fit.squares) / (less.fit.squares - less.fit.rows as f64).max(1e-9);
    let likely = |c: &Candidate| c.piece.term.is_of_the_valve() && c.promised > PROMISING * explained;
    // Terms of the valve alone are a part of all; where none of them is likely, the others need not be looked at.
    if !screen(&less.fit, weighing, &|term| term.is_of_the_valve())?.iter().any(likely) {
        return Ok(None);
    }
    let modelled = |term: Found| {
        let judged = term.judged.clone();
        let names_needed = !judged.added.is_empty();
        Modelled { remainder: None, term: Some(term), judged, names_needed, rival: None }
    };
    Ok(equation(weighing, less, &likely)?.map(modelled))
}

fn chi2(found: Option<&Found>) -> f64 {
    found.map_or(f64::INFINITY, |f| f.judged.hold.chi2)
}

/// The equation that predicts best beside a model, begun with a term that is `likely`; none where none is worth it.
fn equation(
    weighing: &Weighing,
    parent: &ScoredModel,
    likely: &dyn Fn(&Candidate) -> bool,
) -> Result<Option<Found>, SimulateError> {
    let mut best: Option<Found> = None;
    loop {
        let base = best.as_ref().map_or(parent, |found| &found.judged);
        let pieces = best.as_ref().map_or_else(Vec::new, |found| found.pieces.clone());
        let used: usize = pieces.iter().map(|p| p.term.parameters()).sum();
        let sense = pieces.first().map(|p| p.term.sense);
        let candidates = screen(&base.fit, weighing, &|term| sense.is_none_or(|sense| term.sense == sense))?;
        let new = |c: &Candidate| {
            let known = pieces.iter().any(|p| p.term == c.piece.term);
            !known && used + c.piece.term.parameters() <= MOST && (best.is_some() || likely(c))
        };
        let candidates: Vec<Candidate> = candidates.into_iter().filter(new).take(FITTED).collect();
        let share = if best.is_some() { MORE } else { WORTH };
        let Some(found) = fitted(weighing, parent, (base, &pieces), candidates, share)? else { return Ok(best) };
        let full = found.pieces.iter().map(|p| p.term.parameters()).sum::<usize>() >= MOST;
        // What is left of noise alone needs no further term.
        let done = full || found.judged.hold.chi2 < 1.0 + NEAR;
        best = Some(found);
        if done {
            return Ok(best);
        }
    }
}

/// Fits candidates beside what an equation has already and gives the one that predicts best, where that is worth it.
fn fitted(
    weighing: &Weighing,
    parent: &ScoredModel,
    (base, pieces): (&ScoredModel, &[Piece]),
    candidates: Vec<Candidate>,
    share: f64,
) -> Result<Option<Found>, SimulateError> {
    let reach = placing::reach(weighing);
    let look = |candidate: Candidate| -> Result<Option<(Fit, Vec<Piece>, Candidate)>, SimulateError> {
        let mut all = pieces.to_vec();
        all.push(candidate.piece.clone());
        let Some(model) = model_with(&parent.fit.model, &base.fit.model, &all, &reach) else { return Ok(None) };
        let mut fit = Fit::resume(model, base.fit.locals.clone(), weighing.fitted())?;
        fit.improve(weighing.fitted(), LOOK)?;
        Ok(Some((fit, all, candidate)))
    };
    let looks = candidates.into_par_iter().map(look).collect::<Result<Vec<_>, _>>()?;
    let mut looks: Vec<_> = looks.into_iter().flatten().collect();
    looks.sort_by(|a, b| a.0.squares.total_cmp(&b.0.squares));
    looks.truncate(FINALISTS);
    let full = |(mut fit, pieces, candidate): (Fit, Vec<Piece>, Candidate)| -> Result<_, SimulateError> {
        fit.improve(weighing.fitted(), FULL)?;
        let hold = score(&fit.model, weighing.weighed())?;
        let departure = Departure::of(weighing.model(), &fit);
        Ok((
            ScoredModel { fit, hold, added: parent.added.clone(), probability: 0.0, plainer: None, departure },
            pieces,
            candidate,
        ))
    };
    let mut all = looks.into_par_iter().map(full).collect::<Result<Vec<_>, _>>()?;
    all.sort_by(|a, b| a.0.hold.chi2.total_cmp(&b.0.hold.chi2));
    for (judged, pieces, candidate) in all {
        if let Some(found) = worth(base, judged, pieces, &candidate, share) {
            return Ok(Some(Found { reach, ..found }));
        }
    }
    Ok(None)
}

/// A fitted equation, where it predicts enough more than what it was added to, everywhere, and is what halves of the data choose.
fn worth(
    base: &ScoredModel,
    judged: ScoredModel,
    pieces: Vec<Piece>,
    candidate: &Candidate,
    share: f64,
) -> Option<Found> {
    let left = (base.hold.chi2 - 1.0).max(0.0);
    let (better, worse) = gains(&base.hold.blocks, &judged.hold.blocks);
    let sure = better - worse > SURE * judged.hold.colour;
    if base.hold.chi2 - judged.hold.chi2 < share * left || !sure || worse > LOST * better {
        return None;
    }
    if candidate.stability < STABLE {
        return None;
    }
    let placed = judged.fit.model.effects.iter().find(|p| p.entry.id == placing::id(&pieces).unwrap_or_default())?;
    let (id, place) = (placed.entry.id, placed.entry.stage.name());
    let quantities = quantities(&judged.fit);
    let told = |piece: &Piece| {
        let mut own = piece.coefficients().into_iter().filter_map(|key| quantities.get(&format!("{id}.{key}")));
        own.any(|q| q.std.is_some_and(|std| q.value.abs() > SIZE * std))
    };
    if !pieces.iter().all(told) {
        return None;
    }
    let words = words(place, &pieces);
    let reach = grammar::Reach::default();
    Some(Found { id, place, words, stability: candidate.stability, pieces, reach, judged })
}

/// The sentence that says what an equation is.
fn words(place: &str, pieces: &[Piece]) -> String {
    let gives = match pieces.first().map(|p| p.term.sense) {
        Some(crate::plant::effects::own::Sense::Gain) => "a change of the flow gain",
        Some(crate::plant::effects::own::Sense::Command) => "an addition to the command",
        Some(crate::plant::effects::own::Sense::Displacement) => "an error of the displacement sensor",
        Some(crate::plant::effects::own::Sense::Acceleration) => "an error of the accelerometer",
        _ => "a force against positive motion",
    };
    let each: Vec<String> = pieces.iter().map(|p| p.term.words()).collect();
    format!("At the {place}, {gives}: {}.", each.join("; and "))
}

#[cfg(test)]
pub(super) mod tests;
