//! Whether a curve or an equation that knows no physics outdoes the effects that were named: what they leave is then not the
//! difference between two forms of the same physics, and the names are not what it is.

use super::judged::{Decision, ScoredModel};
use super::remainder::remainder;
use super::split::Weighing;
use super::term::{self, Modelled};
use crate::plant::simulate::SimulateError;

/// chi2 on the hold-out runs from which what the named effects leave is worth another look.
const DOUBTFUL: f64 = 1.3;
/// Share of the stated model's excess from which it is: a simple form leaves a hundredth or two of a gross effect, whatever
/// its shape.
const SHARE: f64 = 0.03;
/// Share of what they leave that a curve or an equation may leave to outdo them, on the hold-out runs and on those fitted.
pub(super) const OUTDONE: f64 = 0.3;
/// Belief in what lies outside the library where a curve or an equation outdoes it.
pub(super) const BELIEF: f64 = 0.9;

/// Calls the mismatch unlisted, and gives the curve or the equation, where one outdoes the effects named.
pub(super) fn reject_for_curve(
    weighing: &Weighing,
    decision: &mut Decision,
) -> Result<Option<Modelled>, SimulateError> {
    let doubtful = !decision.unlisted && !decision.accepted.added.is_empty() && decision.accepted.hold.chi2 > DOUBTFUL;
    if !doubtful || decision.left() < SHARE {
        return Ok(None);
    }
    // What several effects explain alike, none of which is named, the library holds.
    let library = decision.in_full.as_ref().unwrap_or(&decision.accepted);
    let curve = remainder(weighing, &decision.stated, &decision.stated)?.map(Modelled::from);
    let equation = term::alone(weighing, &decision.stated)?;
    let best = [curve, equation].into_iter().flatten().filter(|modelled| outdoes(modelled, library));
    let Some(best) = best.min_by(|a, b| a.judged.hold.chi2.total_cmp(&b.judged.hold.chi2)) else { return Ok(None) };
    decision.give_up_names(BELIEF, Some(decision.accepted.clone()));
    Ok(Some(best))
}

/// Whether a curve or an equation leaves far less than names, on both kinds of runs.
pub(super) fn outdoes(modelled: &Modelled, named: &ScoredModel) -> bool {
    let leaves = |chi2: f64, named: f64| chi2 - 1.0 < OUTDONE * (named - 1.0);
    let judged = &modelled.judged;
    leaves(judged.hold.chi2, named.hold.chi2) && leaves(judged.fit.chi2(), named.fit.chi2())
}

#[cfg(test)]
pub(super) mod tests;
