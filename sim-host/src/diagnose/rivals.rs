//! What the accepted model is mistaken for, fitted as thoroughly as it: a double that a short look left half way must not lose
//! for that.

use super::search::Search;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::{Model, Placed};
use crate::identify::prepare::Prepared;
use crate::plant::effects::Entry;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// How far a double is taken.
const FULL: Effort = Effort { steps: 12, tolerance: 1e-4 };
/// The accepted model with each of its added effects in turn put out for one that it is mistaken for, by the library's own
/// word.
pub(super) fn rivals(prepared: &Prepared, accepted: &Fit, search: &Search) -> Result<Vec<Fit>, SimulateError> {
    let added = accepted.model.ids_beside(&prepared.model.ids());
    let ours = accepted.model.effects.iter().filter(|p| added.contains(&p.entry.id));
    let mut tasks = Vec::new();
    for placed in ours {
        let rest = accepted.model.without(placed.entry.id);
        for double in accepted.model.candidates().into_iter().filter(|double| alike(placed.entry, double)) {
            tasks.push((rest.clone(), double));
        }
    }
    let fitted = |(rest, double): (Model, &'static Entry)| thorough(&prepared.fit, accepted, &rest, double, search);
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
    let fresh = starts.into_iter().min_by(|a, b| a.promised().total_cmp(&b.promised()));
    let Some(mut fresh) = fresh else { return Ok(None) };
    let set = fresh.model.ids();
    let seen = search.grown.iter().flatten().find(|fit| fit.model.ids() == set);
    fresh.improve(runs, FULL)?;
    let mut best = fresh;
    if let Some(seen) = seen {
        let mut seen = seen.clone();
        seen.improve(runs, FULL)?;
        if seen.squares < best.squares {
            best = seen;
        }
    }
    Ok(Some(best))
}
