//! Brings what was accepted to its end: fitted thoroughly, with the details of its forms, held against what it is mistaken for,
//! less what it does without.

use super::calibration::CALIBRATION;
use super::judged::ScoredModel;
use super::ranking::Ranking;
use super::search::{self, CHANCE};
use super::split::Weighing;
use super::standing::{Alone, SURE, at_bound, is_justified, is_within_noise, sound};
use crate::identify::fit::{Effort, Fit};
use crate::identify::model::Model;
use crate::identify::stated::fit_from_near;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// The accepted model fitted to the end: corners leave a search in hollows that a fresh start of the fit climbs out of.
pub(super) fn polished(after: ScoredModel, weighing: &Weighing) -> Result<ScoredModel, SimulateError> {
    if after.added.is_empty() {
        return Ok(after);
    }
    let mut fit = after.fit.on(weighing.fitted())?;
    fit.improve(weighing.fitted(), Effort { steps: 10, tolerance: 1e-6 })?;
    let polished = ScoredModel { plainer: after.plainer.clone(), ..ScoredModel::of(fit, weighing)? };
    refined(if polished.total() < after.total() { polished } else { after }, weighing)
}

/// Those of several models whose stated values went far, fitted again from values near those stated: an equation may leave as little in
/// another hollow, where it asks less to be believed.
pub(super) fn unbent(models: &[ScoredModel], weighing: &Weighing) -> Result<Vec<ScoredModel>, SimulateError> {
    let bent = models.par_iter().filter(|judged| judged.departure.disbelief() > CHANCE);
    let near = |judged: &ScoredModel| -> Result<Option<ScoredModel>, SimulateError> {
        let Some(mut fit) = fit_from_near(weighing.training.prepared(), &judged.fit)? else { return Ok(None) };
        fit.improve(weighing.fitted(), Effort { steps: 15, tolerance: 1e-5 })?;
        ScoredModel::of(fit, weighing).map(Some)
    };
    Ok(bent.map(near).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// The accepted model with the details of its effects' forms fitted too, where both kinds of runs bear them out.
pub(super) fn refined(after: ScoredModel, weighing: &Weighing) -> Result<ScoredModel, SimulateError> {
    let Some(fit) = search::refined(&after.fit, weighing.fitted(), Effort { steps: 10, tolerance: 1e-6 })? else {
        return Ok(after);
    };
    let refined = ScoredModel::of(fit, weighing)?;
    let better =
        after.fit.squares - refined.fit.squares > CHANCE && after.hold.squares() - refined.hold.squares() > SURE;
    Ok(if better { ScoredModel { plainer: Some(Box::new(after)), ..refined } } else { after })
}

/// Puts models whose details of form cost more than they explain back to the simplest forms: a search that only fits finds every
/// detail worth its while. Only those are looked at that would lead at no price of their details.
pub(super) fn simplify(
    before: &ScoredModel,
    models: &mut [ScoredModel],
    weighing: &Weighing,
) -> Result<(), SimulateError> {
    let ranking = Ranking::new(before, models.iter());
    let least = models.iter().map(|judged| ranking.cost(judged)).fold(f64::INFINITY, f64::min) + 2.0 * CALIBRATION.tie;
    models.par_iter_mut().try_for_each(|judged| {
        let (whole, details) = judged.fit.model.plain(&judged.added);
        if details == 0 || ranking.cost(judged) - CALIBRATION.parameter_price * details as f64 > least {
            return Ok(());
        }
        let each = judged.added.iter().map(|id| judged.fit.model.plain(&[*id])).filter(|(_, details)| *details > 0);
        let parts: Vec<Model> = each.map(|(model, _)| model).collect();
        let several = parts.len() > 1;
        for model in std::iter::once(whole).chain(parts.into_iter().filter(|_| several)) {
            let plain = refitted(judged, model, weighing)?;
            if ranking.cost(&plain) < ranking.cost(judged) {
                *judged = plain;
            }
        }
        Ok(())
    })
}

/// The accepted model, or a rival that does better with no more parameters' worth; and the rest. One whose values make sense
/// comes before those whose do not, but for one that alone explains the mismatch to the noise: there an end is what another form of the
/// same physics asks for.
pub(super) fn best_of(
    before: &ScoredModel,
    accepted: ScoredModel,
    rivals: Vec<ScoredModel>,
) -> (ScoredModel, Vec<ScoredModel>) {
    let mut all: Vec<ScoredModel> = std::iter::once(accepted).chain(rivals).collect();
    let ranking = Ranking::new(before, &all);
    ranking.sort(&mut all);
    // Nor do two effects make sense of which one is a case of the other: they stand for something beside the one.
    let redundant = |judged: &ScoredModel| judged.fit.model.is_redundant();
    let strange = all.first().is_some_and(|first| at_bound(first) || redundant(first));
    let alone = all.first().is_some_and(|first| is_within_noise(first) && !redundant(first));
    let makes_sense =
        |judged: &ScoredModel| sound(before, judged) && !redundant(judged) && (!alone || is_within_noise(judged));
    let first = all.iter().position(|judged| !strange || makes_sense(judged)).unwrap_or(0);
    let best = all.remove(first);
    (best, all)
}

/// The accepted model less what it does without: a companion may have led an effect to where it belongs and stands no more
/// against that effect alone.
pub(super) fn needed(
    before: &ScoredModel,
    after: ScoredModel,
    weighing: &Weighing,
    alone: &Alone,
) -> Result<ScoredModel, SimulateError> {
    if after.added.len() < 2 {
        return Ok(after);
    }
    let smaller = after.added.iter().map(|id| without(&after, &[id], weighing)).collect::<Result<Vec<_>, _>>()?;
    let enough = smaller
        .into_iter()
        .filter(|less| !is_justified(before, less, &after, alone.tell_apart(&less.added, &after.added)));
    Ok(enough.min_by(|a, b| a.total().total_cmp(&b.total())).unwrap_or(after))
}

/// A model fitted again without some of its effects.
pub(super) fn without(judged: &ScoredModel, ids: &[&str], weighing: &Weighing) -> Result<ScoredModel, SimulateError> {
    refitted(judged, judged.model_without(ids), weighing)
}

/// A simpler model fitted on from where a larger one ended.
fn refitted(judged: &ScoredModel, model: Model, weighing: &Weighing) -> Result<ScoredModel, SimulateError> {
    let mut fit = Fit::resume(model, judged.fit.locals.clone(), weighing.fitted())?;
    fit.improve(weighing.fitted(), Effort { steps: 10, tolerance: 1e-5 })?;
    ScoredModel::of(fit, weighing)
}

#[cfg(test)]
mod tests;
