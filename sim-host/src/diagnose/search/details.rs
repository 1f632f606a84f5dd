//! The details of the effects' forms, which a search leaves at their simplest until it knows which effects they belong to.

use super::{CHANCE, FINALISTS, HOPEFUL, best_of_each_set, brief, explains};
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit, squares};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Share of the squares that a form with its details fitted must leave at most to be worth them.
const DETAILED: f64 = 0.8;

/// Frees the details of the forms of the best models of the last size, and of those others that promise most with them: a right effect
/// in its simplest form may leave more than a stranger does. Where the runs are long their beginnings say which are worth it.
pub(super) fn detail(grown: &mut [Vec<Fit>], runs: &[Run]) -> Result<(), SimulateError> {
    let Some(last) = grown.last_mut() else { return Ok(()) };
    let beginnings = last.iter().find(|fit| !explains(fit)).map_or(Ok(None), |fit| brief(fit, runs))?;
    let effort = Effort { steps: 8, tolerance: 1e-4 };
    let finer = |fit: &Fit| -> Result<Option<Fit>, SimulateError> {
        let Some(seen) = beginnings.as_deref() else { return detailed(fit, runs, effort) };
        let Some(finer) = detailed(&fit.on(seen)?, seen, effort)? else { return Ok(None) };
        let mut finer = finer.on(runs)?;
        finer.improve(runs, Effort { steps: 4, ..effort })?;
        Ok(worth(finer, fit))
    };
    let (best, others) = last.split_at(FINALISTS.min(last.len()));
    let none = best.first().is_none_or(explains);
    let others = if none { Vec::new() } else { promising(others, beginnings.as_deref(), runs)? };
    let best: Vec<&Fit> = best.iter().filter(|fit| !explains(fit)).chain(&others).collect();
    let finer = best.into_par_iter().map(finer).collect::<Result<Vec<_>, _>>()?;
    last.extend(finer.into_iter().flatten());
    best_of_each_set(last);
    Ok(())
}

/// The models that promise most once the details of their forms are fitted too.
fn promising(fits: &[Fit], beginnings: Option<&[Run]>, runs: &[Run]) -> Result<Vec<Fit>, SimulateError> {
    let seen = beginnings.unwrap_or(runs);
    let promise = |fit: &Fit| -> Result<(f64, Fit), SimulateError> {
        let all = match beginnings {
            Some(_) => squares(&fit.model, &fit.locals, seen)?,
            None => fit.squares,
        };
        let mut least = f64::INFINITY;
        for model in fit.model.refined().into_iter().filter(|model| model.free_values() > fit.model.free_values()) {
            least = least.min(Fit::resume(model, fit.locals.clone(), seen)?.promised() / all);
        }
        Ok((least, fit.clone()))
    };
    let mut promises = fits.par_iter().map(promise).collect::<Result<Vec<_>, _>>()?;
    promises.retain(|(least, _)| *least < DETAILED);
    promises.sort_by(|(a, x), (b, y)| (a * x.squares).total_cmp(&(b * y.squares)));
    promises.truncate(HOPEFUL);
    Ok(promises.into_iter().map(|(_, fit)| fit).collect())
}

/// A model with the details of its effects' forms fitted too; none where it has none or they are not worth it.
pub(in crate::diagnose) fn detailed(fit: &Fit, runs: &[Run], effort: Effort) -> Result<Option<Fit>, SimulateError> {
    Ok(refined(fit, runs, effort)?.and_then(|finer| worth(finer, fit)))
}

fn worth(finer: Fit, plain: &Fit) -> Option<Fit> {
    (finer.squares < DETAILED * plain.squares - CHANCE).then_some(finer)
}

/// The same, worth it or not, from whichever start leads further.
pub(in crate::diagnose) fn refined(fit: &Fit, runs: &[Run], effort: Effort) -> Result<Option<Fit>, SimulateError> {
    let mut best: Option<Fit> = None;
    for model in fit.model.refined() {
        if model.free_values() == fit.model.free_values() {
            return Ok(None);
        }
        let mut finer = Fit::resume(model, fit.locals.clone(), runs)?;
        finer.improve(runs, effort)?;
        if best.as_ref().is_none_or(|best| finer.squares < best.squares) {
            best = Some(finer);
        }
    }
    Ok(best)
}
