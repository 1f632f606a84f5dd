//! Whether an equation of the valve outdoes one of the effects that were named beyond it.
//!
//! What bends in the valve (its hysteresis, a gain that depends on place) reaches the recordings through the whole loop, and a payload, a
//! friction or a curved sensor bend to it: they explain most of it and leave what they cannot. Each such name is taken out in turn, and
//! an equation at the valve is looked for in its place. Where that leaves far less, on both kinds of runs, the name was a stand-in. An
//! equation of the valve that follows what moves beyond it is left out: that is a force in another place, and outdoes nothing.

use super::finish::without;
use super::judged::{Decision, ScoredModel};
use super::reject_for_curve::{BELIEF, outdoes};
use super::split::Weighing;
use super::standing::{is_justified, is_within_noise, leaves_next_to_nothing};
use super::term::{self, Modelled};
use crate::plant::effects::{Stage, entry};
use crate::plant::simulate::SimulateError;

/// Takes back the name that an equation of the valve outdoes, and gives the equation, with the other names beside it.
pub(super) fn reject_for_valve(
    weighing: &Weighing,
    decision: &mut Decision,
) -> Result<Option<Modelled>, SimulateError> {
    let named = decision.in_full.as_ref().unwrap_or(&decision.accepted);
    if decision.unlisted || is_within_noise(named) || leaves_next_to_nothing(&decision.stated, named) {
        return Ok(None);
    }
    let mut best: Option<(ScoredModel, Modelled)> = None;
    for id in named.added.iter().filter(|id| is_beyond_the_valve(id)) {
        let less = without(named, &[*id], weighing)?;
        let Some(modelled) = term::of_the_valve(weighing, &less, named)?.filter(|m| outdoes(m, named)) else {
            continue;
        };
        if best.as_ref().is_none_or(|(_, best)| modelled.judged.hold.chi2 < best.judged.hold.chi2) {
            best = Some((less, modelled));
        }
    }
    let Some((less, modelled)) = best else { return Ok(None) };
    let modelled = with_needed(weighing, &decision.stated, modelled)?;
    let added = &modelled.judged.added;
    let less = if less.added == *added { less } else { without(&less, &beside(&less.added, added), weighing)? };
    (decision.more_missing, decision.in_full) = (false, None);
    if !less.added.is_empty() && decision.weighed(&less.added).next().is_none() {
        decision.candidates.push(less.clone());
    }
    decision.give_up_names(BELIEF, Some(less).filter(|less| !less.added.is_empty()));
    Ok(Some(modelled))
}

/// The equation with those names beside it that it does not do without: what helped the name that was a stand-in may have nothing to do.
fn with_needed(weighing: &Weighing, stated: &ScoredModel, mut modelled: Modelled) -> Result<Modelled, SimulateError> {
    for id in modelled.judged.added.clone() {
        let judged = &modelled.judged;
        let added = beside(&judged.added, &[id]);
        let less = ScoredModel { added, ..without(judged, &[id], weighing)? };
        if !is_justified(stated, &less, judged, true) {
            modelled = modelled.beside(less);
        }
    }
    modelled.names_needed = !modelled.judged.added.is_empty();
    Ok(modelled)
}

/// Those names that are not among others.
fn beside(names: &[&'static str], others: &[&'static str]) -> Vec<&'static str> {
    names.iter().copied().filter(|id| !others.contains(id)).collect()
}

/// True for an effect that acts on what the valve lets through.
fn is_beyond_the_valve(id: &str) -> bool {
    entry(id).is_some_and(|entry| !matches!(entry.stage, Stage::Command | Stage::Valve | Stage::Flow))
}

#[cfg(test)]
mod tests;
