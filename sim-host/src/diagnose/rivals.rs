//! What the accepted model is mistaken for, fitted as thoroughly as it: a double that a short look left half way must not lose
//! for that.

use super::search::{Search, detailed};
use super::split::Weighing;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::{Model, Placed};
use crate::plant::effects::Entry;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// A look at a start of a double, and how far the best is taken.
const LOOK: Effort = Effort { steps: 6, tolerance: 1e-3 };
const FULL: Effort = Effort { steps: 12, tolerance: 1e-4 };
/// The accepted model with each of its added effects in turn put out for one that it is mistaken for, by the library's own
/// word.
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
    Ok(fits.into_iter().flatten().collect())
}

/// True where the library says that one is mistaken for the other.
fn alike(a: &Entry, b: &Entry) -> bool {
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
    for placed in (0..).map_while(|i| Placed::start(double, i, &search.yardsticks)) {
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
