//! What the accepted model is mistaken for, fitted as thoroughly as it: a double that a short look left half way must not lose
//! for that.

use super::search::{CandidateStart, Search, brief, candidate_starts, detailed};
use super::split::Weighing;
use crate::identify::data::Run;
use crate::identify::fit::secant::Base;
use crate::identify::fit::{Effort, Fit, squares};
use crate::identify::model::{Model, ModelEffect, SignalScales};
use crate::plant::effects::Entry;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// A look at a start of a double, and how far the best is taken.
const LOOK: Effort = Effort { steps: 6, tolerance: 1e-3 };
const FULL: Effort = Effort { steps: 12, tolerance: 1e-4 };
/// Strangers that are looked at in the place of each effect of several, and how many of them are taken further.
const STRANGERS: usize = 4;
const NEAREST: usize = 2;
/// Share of what the accepted effect explains that another in its place may leave of it and still matter.
const MATTERS: f64 = 0.1;

/// The accepted model with each of its added effects in turn put out for one that it is mistaken for, by the library's own
/// word; of several effects, for what else promises most in its place too: what looks like an effect alone may not beside
/// another, and what does not may.
pub(super) fn rivals(weighing: &Weighing, accepted: &Fit, search: &Search) -> Result<Vec<Fit>, SimulateError> {
    let added = accepted.model.ids_beside(&weighing.model().ids());
    let ours = accepted.model.effects.iter().filter(|p| added.contains(&p.entry.id));
    let vacancies = ours.map(|placed| Vacancy::of(accepted, placed.entry, weighing.fitted()));
    let vacancies = vacancies.collect::<Result<Vec<_>, _>>()?;
    let known = accepted.model.candidates();
    let mut tasks: Vec<(&Vacancy, &'static Entry)> = Vec::new();
    for vacancy in &vacancies {
        tasks.extend(known.iter().filter(|double| alike(vacancy.out, double)).map(|double| (vacancy, *double)));
    }
    let fitted = |(vacancy, double): (&Vacancy, &'static Entry)| vacancy.thorough(double, search);
    let fits = tasks.into_par_iter().map(fitted).collect::<Result<Vec<_>, _>>()?;
    let mut fits: Vec<Fit> = fits.into_iter().flatten().collect();
    if added.len() > 1 {
        for vacancy in &vacancies {
            fits.extend(vacancy.strangers(&search.signal_scales)?);
        }
    }
    Ok(fits)
}

/// The place of one effect of the accepted model, to be filled by others.
struct Vacancy<'a> {
    accepted: &'a Fit,
    out: &'static Entry,
    runs: &'a [Run],
    rest: Model,
    /// The beginnings of the runs on which others are looked at, where these are long.
    beginnings: Option<Vec<Run>>,
    /// Squares near which another must come to matter, on all runs and on what others are looked at on.
    goal: f64,
    goal_seen: f64,
}

impl<'a> Vacancy<'a> {
    fn of(accepted: &'a Fit, out: &'static Entry, runs: &'a [Run]) -> Result<Self, SimulateError> {
        let without = Fit::resume(accepted.model.without(out.id), accepted.locals.clone(), runs)?;
        let near = |with: f64, without: f64| with + MATTERS * (without - with);
        let goal = near(accepted.squares, without.squares);
        let beginnings = brief(&without, runs)?;
        let goal_seen = match &beginnings {
            Some(seen) => {
                let on_seen = |fit: &Fit| squares(&fit.model, &fit.locals, seen);
                near(on_seen(accepted)?, on_seen(&without)?)
            }
            None => goal,
        };
        Ok(Self { beginnings, rest: without.model, accepted, out, runs, goal, goal_seen })
    }

    /// What others are looked at on.
    fn seen(&self) -> &[Run] {
        self.beginnings.as_deref().unwrap_or(self.runs)
    }

    /// A fit to what was seen taken on to all runs, as far as it may matter there.
    fn on_all(&self, fit: Fit) -> Result<Fit, SimulateError> {
        let mut fit = if self.beginnings.is_some() { fit.on(self.runs)? } else { fit };
        fit.improve_towards(self.runs, FULL, self.goal)?;
        Ok(fit)
    }

    /// What promises most in this place, but for what its effect is mistaken for.
    fn strangers(&self, signal_scales: &SignalScales) -> Result<Vec<Fit>, SimulateError> {
        let seen = self.seen();
        let mut rest = Fit::resume(self.rest.clone(), self.accepted.locals.clone(), seen)?;
        rest.improve(seen, LOOK)?;
        let Some(base) = Base::of(&rest, seen)? else { return Ok(Vec::new()) };
        let mut starts = candidate_starts(std::slice::from_ref(&rest), &[], signal_scales, seen)?;
        starts.retain(|start| start.placed.entry.id != self.out.id && !alike(self.out, start.placed.entry));
        let look = |start: CandidateStart| Ok(start.look(&base, seen)?.map(|promised| (promised, start.placed)));
        let looks = starts.into_par_iter().map(look).collect::<Result<Vec<_>, SimulateError>>()?;
        let mut looks: Vec<(f64, ModelEffect)> = looks.into_iter().flatten().collect();
        looks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        let mut known: Vec<&str> = Vec::new();
        looks.retain(|(_, placed)| {
            let new = !known.contains(&placed.entry.id);
            known.push(placed.entry.id);
            new && known.len() <= STRANGERS
        });
        let begun = |(_, placed): (f64, ModelEffect)| -> Result<Fit, SimulateError> {
            let mut fit = Fit::resume(rest.model.with(placed), self.accepted.locals.clone(), seen)?;
            fit.improve(seen, LOOK)?;
            Ok(fit)
        };
        let mut fits = looks.into_par_iter().map(begun).collect::<Result<Vec<_>, _>>()?;
        fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
        fits.truncate(NEAREST);
        fits.into_par_iter().map(|fit| self.on_all(fit)).collect()
    }

    /// The double's best fit: on from where the search left it, or from its most promising start.
    fn thorough(&self, double: &'static Entry, search: &Search) -> Result<Option<Fit>, SimulateError> {
        let seen = self.seen();
        let placed = (0..).map_while(|i| ModelEffect::start(double, i, &search.signal_scales));
        let starts = placed.map(|placed| Fit::resume(self.rest.with(placed), self.accepted.locals.clone(), seen));
        let mut starts = starts.collect::<Result<Vec<_>, _>>()?;
        // What a linear step promises from far away is little: every start is taken some way.
        starts.iter_mut().try_for_each(|start| start.improve(seen, LOOK))?;
        let Some(mut fresh) = starts.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares)) else {
            return Ok(None);
        };
        let set = fresh.model.ids();
        fresh.improve_towards(seen, FULL, self.goal_seen)?;
        let fresh = detailed(&fresh, seen, FULL)?.unwrap_or(fresh);
        // What was fitted to all runs is at its end.
        let mut best = if self.beginnings.is_some() { self.on_all(fresh)? } else { fresh };
        if let Some(mut known) = search.grown.iter().flatten().find(|fit| fit.model.ids() == set).cloned() {
            known.improve_towards(self.runs, FULL, self.goal)?;
            if known.squares < best.squares {
                best = known;
            }
        }
        Ok(Some(best))
    }
}

/// True where the library says that one is mistaken for the other.
pub(super) fn alike(a: &Entry, b: &Entry) -> bool {
    a.mistaken_for.contains(&b.id) || b.mistaken_for.contains(&a.id)
}
