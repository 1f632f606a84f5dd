//! The last fit and the only look at the runs held out: what was selected is fitted to every sample that may be fitted and
//! judged on data that nothing was chosen by. Names that do not hold there are taken back; nothing is chosen anew.

use super::calibration::CALIBRATION;
use super::judged::{Decision, ScoredModel, explains_a_channel};
use super::leftover::{Followed, more_is_missing};
use super::split::Test;
use super::standing::{SURE, accounted, beyond, outside};
use super::term::Modelled;
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::Local;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::{Score, gains, score, score_beside};
use crate::identify::prepare::Prepared;
use crate::identify::quantity::quantities;
use crate::plant::effects::remainder as curves;
use crate::plant::simulate::SimulateError;
use serde::Serialize;

/// How far the last fit goes: it starts from the values found on two thirds of its samples.
const LAST: Effort = Effort { steps: 12, tolerance: 1e-6 };
/// Standard errors by which a channel may be worse by chance.
const CHANCE: f64 = 4.0;
/// R2 of a channel, its noise apart, that a model must reach for names to be believed.
const LEAST_SKILL: f64 = 0.5;
/// Share of a channel's power from which it is too noisy to be asked.
const NOISY: f64 = 0.5;
/// Deviations that an effect's size must be away from none.
const SIZE: f64 = 2.0;
/// What is more than one half is the larger part.
const LARGER_PART: f64 = 0.5;
/// Share of the misfit on the runs held out, below which what is left of the runs fitted is nothing to speak of.
const NOTHING: f64 = 0.1;

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

/// What came out, as judged on the runs held out, or on those fitted where none is.
#[derive(Debug, Clone)]
pub struct Conclusion {
    /// The stated model.
    pub before: ScoredModel,
    /// The model that is handed on: the one with the names or the curve, the stated one where nothing was found.
    pub after: ScoredModel,
    /// The best the library can do, where that is not enough for names.
    pub partial: Option<ScoredModel>,
    /// True where no combination of the library explains the mismatch.
    pub unlisted: bool,
    /// True where effects are named and more is missing beside them.
    pub more_missing: bool,
    /// Why names that were selected are not given.
    pub refusal: Option<Refusal>,
    /// The runs that judged.
    pub judging: Vec<Run>,
    /// True where these were held out.
    pub held_out: bool,
    /// What was selected, weighed on stretches of the runs fitted.
    pub decision: Decision,
}

impl Conclusion {
    /// True where the stated model and the recordings agree.
    pub fn consistent(&self) -> bool {
        !self.unlisted && self.after.added.is_empty()
    }

    /// Share of the stated model's excess that the model handed on leaves.
    pub fn left(&self) -> f64 {
        (self.after.hold.chi2 - 1.0).max(0.0) / (self.before.hold.chi2 - 1.0).max(1e-9)
    }

    /// True where the runs held out miss what the runs fitted do not show, or refuse what those showed.
    pub(super) fn unforeseen(&self) -> bool {
        let (fit, held) = (self.after.fit.chi2() - 1.0, self.after.hold.chi2 - 1.0);
        let hidden = outside(&self.before, &self.after).0 && fit < NOTHING * held;
        let refused =
            matches!(self.refusal, Some(Refusal::Worse { .. } | Refusal::NoSkill { .. } | Refusal::NoGain { .. }));
        // However little of the mismatch it is: a form that leaves a share of what its effect does leaves it on all runs alike.
        let more = (self.more_missing || rest_beyond_noise(&self.after)) && fit < NOTHING * held;
        self.held_out && (hidden || refused || more)
    }
}

/// Judges what was selected, and the curve that stands for what is unlisted; `seen` are the runs that were fitted so far.
pub(super) fn verdict(
    whole: &Prepared,
    seen: &[Run],
    mut decision: Decision,
    modelled: Option<&Modelled>,
    test: Test,
) -> Result<Conclusion, SimulateError> {
    let (judging, held_out) = test.consume(whole);
    let last = |judged: &ScoredModel| last(judged, (whole, seen), &judging);
    let before = last(&decision.before)?;
    let mut partial = decision.partial.as_ref().map(last).transpose()?;
    let curve = modelled.map(|modelled| last(&modelled.judged)).transpose()?.filter(|c| c.hold.chi2 < before.hold.chi2);
    let selected = (!decision.after.added.is_empty()).then(|| last(&decision.after)).transpose()?;
    // Names that stand beside a curve are judged with it, and where that fails without it: the curve may be what fails.
    let beside = modelled.filter(|_| decision.more_missing && selected.is_none());
    let with_curve = if beside.is_some() { curve.clone() } else { None };
    let refused = |named: &ScoredModel| -> Result<Option<Refusal>, SimulateError> {
        let failed = refusal(&before, named, &judging, decision.more_missing);
        if failed.is_some() { Ok(failed) } else { untold(&before, named, whole, &judging) }
    };
    let mut named = selected.or(with_curve);
    let mut refusal = named.as_ref().map(refused).transpose()?.flatten();
    if (named.is_none() || refusal.is_some())
        && let Some(names) = beside.and_then(|modelled| decision.weighed(&modelled.judged.added).next())
        && let alone = last(names)?
        && refused(&alone)?.is_none()
    {
        (named, refusal) = (Some(alone), None);
    }
    let (mut unlisted, mut more_missing) = (decision.unlisted, decision.more_missing);
    let mut after = before.clone();
    match named {
        Some(named) if refusal.is_none() => after = named,
        // Nothing is missing there, and nothing there speaks for the names.
        Some(named) if matches!(refusal, Some(Refusal::NotTold { .. })) && !rest_beyond_noise(&before) => {
            (unlisted, more_missing) = (false, false);
            decision.fall_back(CALIBRATION.failed);
            partial = Some(named);
        }
        Some(named) => {
            (unlisted, more_missing) = (true, false);
            decision.take_back(CALIBRATION.failed);
            partial = Some(named);
        }
        // The curve that names were given beside predicts the runs held out worse than the stated model: neither holds there.
        None if more_missing => {
            (unlisted, more_missing) = (true, false);
            decision.take_back(CALIBRATION.failed);
        }
        None => {}
    }
    // A misfit far from the noise is physics whether or not it follows the motion.
    if !unlisted
        && let follows = Followed::of(&judging, &after.hold.predicted)
        && (!follows.is_modest(&after) || follows.is_certain())
    {
        let quiet = follows.noise(&after);
        // What shows on the runs held out alone: more than the names explain, or anything at all.
        if !after.added.is_empty() {
            let excess = accounted(&before, &after, |model| score(&model, &judging))?;
            more_missing |= more_is_missing(&before, &after, excess, quiet);
        } else if beyond(before.hold.chi2 - 1.0, &after, quiet).0 {
            unlisted = true;
            decision.take_back(CALIBRATION.failed);
        }
    }
    if !unlisted && !after.added.is_empty() && rest_beyond_noise(&after) {
        decision.take_back(CALIBRATION.mimicked);
    }
    // Without a curve the nearest that the library has predicts better than the stated model, whatever its names are worth.
    if unlisted && let Some(better) = curve.or(partial.clone().filter(|p| p.hold.chi2 < before.hold.chi2)) {
        after = better;
    }
    Ok(Conclusion { before, after, partial, unlisted, more_missing, refusal, judging, held_out, decision })
}

/// The stated model's standing, for recordings of which nothing else can be said.
pub(super) fn as_stated(whole: &Prepared, decision: Decision, test: Test) -> Result<Conclusion, SimulateError> {
    let (judging, held_out) = test.consume(whole);
    let before = ScoredModel { hold: score(&decision.before.fit.model, &judging)?, ..decision.before.clone() };
    Ok(Conclusion {
        after: before.clone(),
        before,
        partial: None,
        unlisted: false,
        more_missing: false,
        refusal: None,
        judging,
        held_out,
        decision,
    })
}

/// A model fitted to all that may be fitted, judged.
fn last(
    judged: &ScoredModel,
    (whole, seen): (&Prepared, &[Run]),
    judging: &[Run],
) -> Result<ScoredModel, SimulateError> {
    let model = judged.fit.model.clone();
    // Where an excerpt begins is not where its run does.
    let local = |((run, seen), local): ((&Run, &Run), &Local)| {
        if run.from == seen.from { local.clone() } else { Local::start(&model, run) }
    };
    let locals = whole.fit.iter().zip(seen).zip(&judged.fit.locals).map(local).collect();
    let mut fit = Fit::resume(model, locals, &whole.fit)?;
    fit.improve(&whole.fit, LAST)?;
    Ok(ScoredModel { hold: score_beside(&fit, &whole.fit, judging)?, fit, ..judged.clone() })
}

/// Whether a model leaves more of the runs that judge than noise does.
fn rest_beyond_noise(judged: &ScoredModel) -> bool {
    let blur = CHANCE * (2.0 / judged.hold.samples.max(1) as f64).sqrt();
    judged.hold.chi2 - 1.0 > CALIBRATION.negligible + blur
}

/// Why these names cannot stand; those beside which more is missing need to explain the larger part alone, or nearly all of one channel.
fn refusal(before: &ScoredModel, named: &ScoredModel, judging: &[Run], beside_more: bool) -> Option<Refusal> {
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
        let misfit = named.hold.channels.iter().find(|(c, ..)| *c == channel).map_or(1.0, |&(_, chi2, _)| chi2);
        let noise = found * found / misfit.max(f64::MIN_POSITIVE);
        let lack = (found * found - noise) / (1.0 - noise);
        if noise < NOISY && lack > 1.0 - LEAST_SKILL {
            return Some(Refusal::NoSkill { channel: channel.name(), r2: 1.0 - found * found });
        }
    }
    let lacks = rest_beyond_noise(before);
    let in_all = (named.hold.chi2 - 1.0) / (before.hold.chi2 - 1.0).max(1e-9);
    let share_left = channel_explained.map_or(in_all, |(_, left)| left.min(in_all));
    let most_left = if beside_more { LARGER_PART } else { 1.0 - CALIBRATION.credible };
    if lacks && share_left > most_left {
        return Some(Refusal::NoGain { share_left });
    }
    None
}

/// The first effect that nothing shows to be there: none of its parameters is significantly different from zero, and the runs that
/// judge are predicted as well without it.
fn untold(
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
fn is_needed(without: &ScoredModel, with: &ScoredModel) -> bool {
    let (better, worse) = gains(&without.hold.blocks, &with.hold.blocks);
    better - worse > SURE * with.colour_of_noise()
}

/// The effects none of whose parameters is significantly different from zero.
fn indistinct(named: &ScoredModel) -> Vec<&'static str> {
    let quantities = quantities(&named.fit);
    let told = |id: &str| {
        let prefix = format!("{id}.");
        let mut own = quantities.iter().filter(|(key, _)| key.starts_with(&prefix)).peekable();
        own.peek().is_none() || own.any(|(_, q)| q.std.is_none_or(|std| q.value.abs() > SIZE * std))
    };
    named.added.iter().copied().filter(|id| !told(id)).collect()
}

#[cfg(test)]
mod tests;
