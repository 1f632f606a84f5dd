//! The noise of a channel by what the best of all models leaves of it: a figure that was stated too large hides whatever leaves less.

use super::judged::{Decision, ScoredModel};
use super::split::Weighing;
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Fit;
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;

/// Share of a noise's power that a model must leave at most for the noise to be smaller: less is within what chance and the colour of
/// a noise do to it.
const LESS: f64 = 0.87;
/// Share of the power of a noise as it was stated beyond which more than that noise is left.
const MORE: f64 = 1.02;
/// Models that are asked.
const ASKED: usize = 4;

/// Power that a model leaves of the channels that judge, in that of their noise.
type Powers = Vec<(Channel, f64)>;

/// What the accepted model leaves, where it names something and leaves less than noise of a channel.
pub(super) fn by_names(weighing: &Weighing, decision: &Decision) -> Option<Powers> {
    let named = !decision.unlisted && !decision.accepted.added.is_empty();
    let powers = powers(&decision.accepted);
    (named && is_less(&powers) && !as_stated(&powers, weighing.weighed())).then_some(powers)
}

/// True where what is left of each channel is the noise that was stated of it, though more was believed of it: it was raised to what
/// the stated model leaves between neighbouring samples, and what the names take away there was no noise.
fn as_stated(powers: &Powers, runs: &[Run]) -> bool {
    let measured = |channel: Channel| runs.iter().find_map(|run| run.channel(channel));
    powers.iter().filter(|(_, power)| *power < LESS).all(|(channel, power)| {
        let raised = measured(*channel).and_then(|m| Some((m.noise / m.stated?).powi(2)));
        raised.is_some_and(|raised| (LESS..MORE).contains(&(power * raised)))
    })
}

/// The least that any of the best models leaves, where that is less than noise of a channel.
pub(super) fn by_any(weighing: &Weighing, fits: &[Fit]) -> Result<Option<Powers>, SimulateError> {
    let mut least: Powers = Vec::new();
    for fit in fits.iter().take(ASKED) {
        for (channel, power) in powers(&ScoredModel::of(fit.clone(), weighing)?) {
            match least.iter_mut().find(|(of, _)| *of == channel) {
                Some((_, known)) => *known = known.min(power),
                None => least.push((channel, power)),
            }
        }
    }
    Ok(is_less(&least).then_some(least))
}

/// Sets the noise of the channels of which less is left to what is.
pub(super) fn lower(prepared: &mut Prepared, powers: &Powers) {
    for measured in prepared.fit.iter_mut().chain(&mut prepared.holdout).flat_map(|run| &mut run.measured) {
        let power = powers.iter().find(|(channel, _)| *channel == measured.channel);
        if let Some((_, power)) = power.filter(|(_, power)| *power < LESS) {
            measured.noise *= power.sqrt();
        }
    }
}

fn powers(judged: &ScoredModel) -> Powers {
    judged.hold.channels.iter().map(|&(channel, chi2, _)| (channel, chi2)).collect()
}

fn is_less(powers: &Powers) -> bool {
    powers.iter().any(|(_, power)| *power < LESS)
}

#[cfg(test)]
mod tests;
