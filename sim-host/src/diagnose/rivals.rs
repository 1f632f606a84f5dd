//! What the accepted model is mistaken for, fitted as thoroughly as it: a double that a short look left half way must not lose
//! for that.

use super::search::{CandidateStart, Search, candidate_starts, detailed};
use super::split::Weighing;
use crate::identify::data::Run;
use crate::identify::fit::secant::Base;
use crate::identify::fit::{Effort, Fit};
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

/// The accepted model with each of its added effects in turn put out for one that it is mistaken for, by the library's own
/// word; of several effects, for what else promises most in its place too: what looks like an effect alone may not beside
/// another, and what does not may.
pub(super) fn rivals(weighing: &Weighing, accepted: &Fit, search: &Search) -> Result<Vec<Fit>, SimulateError> {
    let added = accepted.model.ids_beside(&weighing.model().ids());
    let ours = accepted.model.effects.iter().filter(|p| added.contains(&p.entry.id));
    let mut tasks = Vec::new();
    for placed in ours {
        let rest = accepted.model.without(placed.entry.id);
        for double in accepted.model.candidates().into_iter().filter(|double| alike(placed.entry, double)) {
            tasks.push((rest.clone(), double));
        }
    }
    let fitted = |(rest, double): (Model, &'static Entry)| thorough(weighing.fitted(), accepted, &rest, double, search);
    let fits = tasks.into_par_iter().map(fitted).collect::<Result<Vec<_>, _>>()?;
    let mut fits: Vec<Fit> = fits.into_iter().flatten().collect();
    if added.len() > 1 {
        let ours = accepted.model.effects.iter().filter(|p| added.contains(&p.entry.id));
        for placed in ours {
            fits.extend(strangers(weighing.fitted(), accepted, placed.entry, &search.signal_scales)?);
        }
    }
    Ok(fits)
}

/// What promises most in the place of one effect of the accepted model, but for what that is mistaken for.
fn strangers(
    runs: &[Run],
    accepted: &Fit,
    out: &'static Entry,
    signal_scales: &SignalScales,
) -> Result<Vec<Fit>, SimulateError> {
    let mut rest = Fit::resume(accepted.model.without(out.id), accepted.locals.clone(), runs)?;
    rest.improve(runs, LOOK)?;
    let Some(base) = Base::of(&rest, runs)? else { return Ok(Vec::new()) };
    let mut starts = candidate_starts(std::slice::from_ref(&rest), &[], signal_scales);
    starts.retain(|start| start.placed.entry.id != out.id && !alike(out, start.placed.entry));
    let look = |start: CandidateStart| Ok(start.look(&base, runs)?.map(|promised| (promised, start.placed)));
    let looks = starts.into_par_iter().map(look).collect::<Result<Vec<_>, SimulateError>>()?;
    let mut looks: Vec<(f64, ModelEffect)> = looks.into_iter().flatten().collect();
    looks.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut seen: Vec<&str> = Vec::new();
    looks.retain(|(_, placed)| {
        let new = !seen.contains(&placed.entry.id);
        seen.push(placed.entry.id);
        new && seen.len() <= STRANGERS
    });
    let begun = |(_, placed): (f64, ModelEffect)| -> Result<Fit, SimulateError> {
        let mut fit = Fit::resume(rest.model.with(placed), accepted.locals.clone(), runs)?;
        fit.improve(runs, LOOK)?;
        Ok(fit)
    };
    let mut fits = looks.into_par_iter().map(begun).collect::<Result<Vec<_>, _>>()?;
    fits.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    fits.truncate(NEAREST);
    fits.par_iter_mut().try_for_each(|fit| fit.improve(runs, FULL))?;
    Ok(fits)
}

/// True where the library says that one is mistaken for the other.
pub(super) fn alike(a: &Entry, b: &Entry) -> bool {
    a.mistaken_for.contains(&b.id) || b.mistaken_for.contains(&a.id)
}

/// The double's best fit: on from where the search left it, or from its most promising start.
fn thorough(
    runs: &[Run],
    accepted: &Fit,
    rest: &Model,
    double: &'static Entry,
    search: &Search,
) -> Result<Option<Fit>, SimulateError> {
    let mut starts = Vec::new();
    for placed in (0..).map_while(|i| ModelEffect::start(double, i, &search.signal_scales)) {
        starts.push(Fit::resume(rest.with(placed), accepted.locals.clone(), runs)?);
    }
    // What a linear step promises from far away is little: every start is taken some way.
    starts.iter_mut().try_for_each(|start| start.improve(runs, LOOK))?;
    let Some(mut fresh) = starts.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares)) else { return Ok(None) };
    let set = fresh.model.ids();
    let seen = search.grown.iter().flatten().find(|fit| fit.model.ids() == set);
    fresh.improve(runs, FULL)?;
    let mut best = fresh;
    best = detailed(&best, runs, FULL)?.unwrap_or(best);
    if let Some(seen) = seen {
        let mut seen = seen.clone();
        seen.improve(runs, FULL)?;
        if seen.squares < best.squares {
            best = seen;
        }
    }
    Ok(Some(best))
}
