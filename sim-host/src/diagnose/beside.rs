//! Names beside a model of what the library does not hold. The search for names had to bear that as well: beside an equation or a curve
//! that stands for it, an effect of the library shows that was hidden beneath it.

use super::calibration::CALIBRATION;
use super::finish::without;
use super::judged::{Decision, ScoredModel};
use super::search::grow_beside;
use super::split::Weighing;
use super::standing::{at_bound, is_justified, kept};
use super::term::{self, Modelled};
use crate::identify::fit::{Effort, Fit};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// Effects beside an equation that are weighed on the validation, and those of them beside which the equation is looked for anew.
const JUDGED: usize = 6;
const ANEW: usize = 2;
/// How far an effect is fitted alone.
const ALONE: Effort = Effort { steps: 10, tolerance: 1e-4 };

/// An effect of the library with what models the unlisted beside it, and the effect alone.
struct Proposal {
    modelled: Modelled,
    named: Option<ScoredModel>,
}

/// Gives the model of what is unlisted an effect of the library beside it where that explains most of what the model leaves alone, on
/// both kinds of runs, and no other comes near; none where there is no such effect.
pub(super) fn name_beside(
    weighing: &Weighing,
    decision: &mut Decision,
    modelled: &Modelled,
) -> Result<Option<Modelled>, SimulateError> {
    let alone = alone(weighing, modelled)?;
    if alone.hold.chi2 < 1.0 + CALIBRATION.hidden {
        return Ok(None);
    }
    let left = |proposal: &Proposal| kept(&alone, &proposal.modelled.judged);
    let mut proposals = proposals(weighing, &alone, modelled)?;
    proposals.sort_by(|a, b| left(a).total_cmp(&left(b)));
    // Found beside a second flaw, an equation or a curve bears part of that: beside what explains it, it is another.
    for proposal in proposals.iter_mut().take(ANEW) {
        proposal.look_anew(weighing, &decision.stated)?;
    }
    proposals.sort_by(|a, b| left(a).total_cmp(&left(b)));
    let mut proposals = proposals.into_iter();
    let Some(best) = proposals.next() else { return Ok(None) };
    let judged = &best.modelled.judged;
    let leads = proposals.all(|other| kept(&other.modelled.judged, judged) < CALIBRATION.lead.powi(-2));
    let told = |less: &ScoredModel| kept(less, judged) < CALIBRATION.told.powi(2);
    if at_bound(judged) || !leads || !told(&alone) || !is_justified(&decision.stated, &alone, judged, true) {
        return Ok(None);
    }
    // What was found anew may do without the effect as well.
    if !told(&without(judged, &judged.added, weighing)?) {
        return Ok(None);
    }
    decision.candidates.extend(best.named.filter(|named| decision.weighed(&named.added).next().is_none()));
    Ok(Some(best.modelled))
}

/// The model of what is unlisted with no effect of the library beside it.
fn alone(weighing: &Weighing, modelled: &Modelled) -> Result<ScoredModel, SimulateError> {
    let judged = &modelled.judged;
    if judged.added.is_empty() {
        return Ok(judged.clone());
    }
    Ok(ScoredModel { added: Vec::new(), ..without(judged, &judged.added, weighing)? })
}

/// The effects that promise most beside it.
fn proposals(weighing: &Weighing, alone: &ScoredModel, modelled: &Modelled) -> Result<Vec<Proposal>, SimulateError> {
    let known = alone.fit.model.ids();
    let mut fits = grow_beside(&alone.fit, weighing.fitted(), &weighing.signal_scales())?;
    fits.truncate(JUDGED);
    let proposal = |fit: Fit| -> Result<Proposal, SimulateError> {
        let added = fit.model.ids_beside(&known);
        let judged = ScoredModel { added, ..ScoredModel::of(fit, weighing)? };
        Ok(Proposal { modelled: modelled.clone().beside(judged), named: None })
    };
    fits.into_par_iter().map(proposal).collect()
}

impl Proposal {
    /// Fits the effect alone, and looks for an equation anew beside it.
    fn look_anew(&mut self, weighing: &Weighing, stated: &ScoredModel) -> Result<(), SimulateError> {
        let judged = &self.modelled.judged;
        let placed = judged.fit.model.effects.iter().filter(|placed| judged.added.contains(&placed.entry.id));
        let model = placed.fold(stated.fit.model.clone(), |model, placed| model.with(placed.clone()));
        let mut fit = Fit::resume(model, stated.fit.locals.clone(), weighing.fitted())?;
        fit.improve(weighing.fitted(), ALONE)?;
        let named = ScoredModel::of(fit, weighing)?;
        if let Some(anew) = term::alone(weighing, &named)?
            && anew.judged.hold.chi2 < judged.hold.chi2
        {
            self.modelled = Modelled { names_needed: true, ..anew };
        }
        self.named = Some(named);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
