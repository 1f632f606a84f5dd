//! Why names that were selected do not stand on the runs that judge.

use super::super::calibration::CALIBRATION;
use super::super::judged::{ScoredModel, explains_a_channel};
use super::super::leftover::{Followed, LARGER_PART};
use super::super::standing::SURE;
use super::LAST;
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Fit;
use crate::identify::judge::{Score, gains, score_beside};
use crate::identify::prepare::Prepared;
use crate::identify::quantity::quantities;
use crate::plant::effects::remainder as curves;
use crate::plant::simulate::SimulateError;
use serde::Serialize;

/// Standard errors by which a channel may be worse by chance.
const CHANCE: f64 = 4.0;
/// R2 of a channel, its noise apart, that a model must reach for names to be believed.
const LEAST_SKILL: f64 = 0.5;
/// R2 of the command below which a model is another machine's: noise that the loop passes on leaves about none, a prediction that is wrong by
/// more than all there is less.
const ANOTHER: f64 = -1.0;
/// Share of a channel's power from which it is too noisy to be asked.
const NOISY: f64 = 0.5;
/// Deviations that an effect's size must be away from none.
const SIZE: f64 = 2.0;

/// Why names that were selected do not stand on the runs held out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "check")]
#[non_exhaustive]
pub enum Refusal {
    /// A judged channel is predicted worse than by the stated model.
    Worse {
        /// The channel.
        channel: &'static str,
        /// Its residual power over that of the stated model.
        ratio: f64,
    },
    /// A judged channel is predicted little better than by its own mean.
    NoSkill {
        /// The channel.
        channel: &'static str,
        /// 1 - nrmse^2.
        r2: f64,
    },
    /// What the runs held out lack is not explained there.
    NoGain {
        /// Share of the stated model's excess that is left.
        share_left: f64,
    },
    /// An effect's size is not significantly different from zero.
    NotTold {
        /// The effect.
        id: &'static str,
    },
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Worse { channel, ratio } => {
                write!(f, "the residual of {channel} has {ratio:.2} times the power that the stated model's has")
            }
            Self::NoSkill { channel, r2 } => {
                write!(f, "{channel} is predicted little better than by its mean, R2 {r2:.3}")
            }
            Self::NoGain { share_left } => write!(f, "it leaves {:.0} % of the excess", 100.0 * share_left),
            Self::NotTold { id } => write!(f, "the size of {id} is not significantly different from zero"),
        }
    }
}

/// Whether a model leaves more of the runs that judge than noise does.
pub(super) fn rest_beyond_noise(judged: &ScoredModel) -> bool {
    let blur = CHANCE * (2.0 / judged.hold.samples.max(1) as f64).sqrt();
    judged.hold.chi2 - 1.0 > CALIBRATION.negligible + blur
}

/// What is known of names before they are judged.
#[derive(Debug, Clone, Copy)]
pub(super) struct Before {
    /// More is missing beside them.
    pub(super) beside_more: bool,
    /// They are likelier wrong than right.
    pub(super) doubtful: bool,
}

/// Why these names cannot stand; those beside which more is missing, or of which enough is left to hide it, need to explain the larger part
/// alone, or nearly all of one channel; doubtful ones that leave more than any noise need to explain most.
pub(super) fn refusal(
    before: &ScoredModel,
    named: &ScoredModel,
    judging: &[Run],
    Before { beside_more, doubtful }: Before,
) -> Option<Refusal> {
    let channel_explained =
        explains_a_channel(before, named).filter(|_| beside_more && named.hold.chi2 < before.hold.chi2);
    let channels = judging.iter().flat_map(|run| run.measured.iter().filter(|m| m.judged).map(|m| m.channel));
    let mut channels: Vec<Channel> = channels.collect();
    channels.sort_unstable();
    channels.dedup();
    let nrmse = |score: &Score, channel| score.nrmse.iter().find(|(c, _)| *c == channel).map(|&(_, value)| value);
    let ratio = |channel: Channel| {
        let ratio = (nrmse(&named.hold, channel)? / nrmse(&before.hold, channel)?).powi(2);
        ratio.is_finite().then_some((channel, ratio))
    };
    let ratios: Vec<(Channel, f64)> = channels.iter().filter_map(|&channel| ratio(channel)).collect();
    // Each channel has its say: what predicts one far better may be a little wrong about another.
    let worse_in_all = ratios.iter().map(|(_, ratio)| ratio.max(f64::MIN_POSITIVE).ln()).sum::<f64>() > 0.0;
    for (channel, ratio) in ratios {
        let samples: usize = judging.iter().filter_map(|r| r.channel(channel)).map(|m| m.values.len()).sum();
        let chance = CHANCE * (2.0 * named.hold.colour / samples.max(1) as f64).sqrt();
        if ratio > 1.0 + chance && worse_in_all && channel_explained.is_none() {
            return Some(Refusal::Worse { channel: channel.name(), ratio });
        }
        // Share of the channel's power that is noise: what it leaves of the rest is what a model can be asked for.
        let found = nrmse(&named.hold, channel).unwrap_or(0.0);
        let misfit = named.hold.chi2_of(channel).unwrap_or(1.0);
        let noise = found * found / misfit.max(f64::MIN_POSITIVE);
        let lack = (found * found - noise) / (1.0 - noise);
        if noise < NOISY && lack > 1.0 - LEAST_SKILL {
            return Some(Refusal::NoSkill { channel: channel.name(), r2: 1.0 - found * found });
        }
    }
    // What predicts the command far worse than nothing would is the model of another machine, whatever its names explain.
    let commanded = nrmse(&named.hold, Channel::Command).map(|found| 1.0 - found * found);
    if let Some(r2) = commanded.filter(|r2| *r2 < ANOTHER) {
        return Some(Refusal::NoSkill { channel: Channel::Command.name(), r2 });
    }
    if !rest_beyond_noise(before) {
        return None;
    }
    // The noise of channels that nothing is left of but noise was stated too small: it is no excess that names could explain.
    let noise = if is_needed(before, named) { Followed::of(judging, &named.hold.predicted).noise(named) } else { 0.0 };
    let left = named.hold.chi2 - 1.0 - noise;
    let in_all = left / (before.hold.chi2 - 1.0 - noise).max(1e-9);
    let share_left = channel_explained.map_or(in_all, |(_, left)| left.min(in_all));
    // Where what is left could hide another effect the names have to explain the larger part.
    let hides = left > CALIBRATION.hidden;
    let most_left = match beside_more || hides {
        true if doubtful && named.hold.chi2 > CALIBRATION.modest => 1.0 - CALIBRATION.most,
        true => LARGER_PART,
        false => 1.0 - CALIBRATION.credible,
    };
    (share_left > most_left).then_some(Refusal::NoGain { share_left })
}

/// The first effect that nothing shows to be there: none of its parameters is significantly different from zero, and the runs that
/// judge are predicted as well without it.
pub(super) fn untold(
    before: &ScoredModel,
    named: &ScoredModel,
    whole: &Prepared,
    judging: &[Run],
) -> Result<Option<Refusal>, SimulateError> {
    // Beside a curve an effect's size is not distinguished from the curve's: that it is needed was.
    if named.fit.model.effects.iter().any(|p| curves::entries().any(|e| e.id == p.entry.id)) {
        return Ok(None);
    }
    for id in indistinct(named) {
        let needed = if let [_] = named.added[..] {
            is_needed(before, named)
        } else {
            let mut fit = Fit::resume(named.fit.model.without(id), named.fit.locals.clone(), &whole.fit)?;
            fit.improve(&whole.fit, LAST)?;
            is_needed(&ScoredModel { hold: score_beside(&fit, &whole.fit, judging)?, fit, ..named.clone() }, named)
        };
        if !needed {
            return Ok(Some(Refusal::NotTold { id }));
        }
    }
    Ok(None)
}

/// Whether the runs that judge are predicted better with an effect than without by more than chance.
pub(super) fn is_needed(without: &ScoredModel, with: &ScoredModel) -> bool {
    let (better, worse) = gains(&without.hold.blocks, &with.hold.blocks);
    better - worse > SURE * with.colour_of_noise()
}

/// The effects none of whose fitted parameters is significantly different from zero.
fn indistinct(named: &ScoredModel) -> Vec<&'static str> {
    let quantities = quantities(&named.fit);
    let told = |id: &str| {
        let prefix = format!("{id}.");
        let own = quantities.iter().filter(|(key, _)| key.starts_with(&prefix));
        let mut sizes = own.filter_map(|(_, q)| Some(q.value.abs() / q.std?)).peekable();
        sizes.peek().is_none() || sizes.any(|size| size > SIZE)
    };
    named.added.iter().copied().filter(|id| !told(id)).collect()
}

#[cfg(test)]
pub(super) mod tests;
