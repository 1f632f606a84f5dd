//! When a larger model stands against a smaller one, and when what a model leaves lies outside the library.

use super::calibration::CALIBRATION;
use super::judged::{ScoredModel, explains_a_channel, parameters};
use super::search::{CHANCE, Search};
use crate::identify::fit::Fit;
use crate::identify::judge::{Score, gains};
use crate::identify::model::Model;
use crate::plant::simulate::SimulateError;

/// Gain of squares on the hold-out runs that chance does not give a model fitted elsewhere.
pub(super) const SURE: f64 = 16.0;
/// Gain there that needs no other on the runs fitted.
const OVERWHELMING: f64 = 600.0;
/// Most of that gain that blocks may lose elsewhere.
const LOST: f64 = 0.5;
/// Excess of chi2 on the runs fitted that speaks for itself where the hold-out runs are silent.
const SHOWN: f64 = 1.0;
/// Share of the mismatch that a stand-in for what is missing leaves at least.
const SLIGHT: f64 = 0.005;
/// Least gain of chi2 for a further effect: less than this is not distinguished from noise that is not quite white.
pub(super) const LEAST_GAIN: f64 = 0.015;

/// How much of what the stated model leaves each effect explains alone.
pub(super) struct Alone(Vec<(&'static str, f64)>);

impl Alone {
    pub(super) fn of(search: &Search, stated: &[&'static str]) -> Self {
        let excess = search.baseline.squares - search.baseline.rows as f64;
        let explained = |fit: &Fit| (search.baseline.squares - fit.squares) / excess.max(1e-9);
        let singles = search.grown.first().into_iter().flatten();
        let known = singles.filter_map(|fit| Some((*fit.model.ids_beside(stated).first()?, explained(fit))));
        Self(known.collect())
    }

    /// Of shares that are known.
    #[cfg(test)]
    pub(super) fn of_shares(shares: &[(&'static str, f64)]) -> Self {
        Self(shares.to_vec())
    }

    /// True where nothing that the larger set adds to the smaller explains much alone.
    pub(super) fn tell_apart(&self, smaller: &[&'static str], larger: &[&'static str]) -> bool {
        let share = |id: &str| self.0.iter().find(|(known, _)| *known == id).map_or(0.0, |(_, share)| *share);
        larger.iter().filter(|id| !smaller.contains(id)).all(|id| share(id) < CALIBRATION.distinct)
    }
}

/// Whether a larger model stands against the present one; `distinct` where what it adds is nothing like what is there.
pub(super) fn is_justified(before: &ScoredModel, present: &ScoredModel, larger: &ScoredModel, distinct: bool) -> bool {
    let added = parameters(larger) - parameters(present);
    let gained = present.fit.squares - larger.fit.squares;
    let held_gain = present.hold.chi2 - larger.hold.chi2;
    let left = (present.hold.chi2 - 1.0).max(0.0);
    let excess = (before.hold.chi2 - 1.0).max(0.0);
    let kept = kept(present, larger);
    let (better, worse) = gains(&present.hold.blocks, &larger.hold.blocks);
    let colour = larger.colour_of_noise();
    // What values far from those stated hide on the runs fitted shows on the hold-out runs.
    let shown_there = gained > -CHANCE && better - worse > OVERWHELMING * colour;
    // One that explains as much with values near those stated stands against one that bends them.
    let beliefs = present.disbelief() - larger.disbelief() - CALIBRATION.parameter_price * added;
    if beliefs > CHANCE && worse - better < SURE * colour {
        return true;
    }
    // What one channel lacks far beyond its noise is explained there: a pressure shows a force that the loop hides from the motion.
    if gained > OVERWHELMING && explains_a_channel(present, larger).is_some() {
        return better - worse > SURE * colour && worse < LOST * better;
    }
    if silent(present, larger) {
        return gained > OVERWHELMING && worse - better < SURE * colour;
    }
    (gained > (CHANCE + 4.0 * added) * colour || shown_there)
        && better - worse > SURE * colour
        && worse < LOST * better
        && (present.added.is_empty()
            || (held_gain > LEAST_GAIN
                && (held_gain > CALIBRATION.worth * left || kept < (1.0 - CALIBRATION.worth).powi(2))))
        && (held_gain > CALIBRATION.noticeable * excess
            || (shown(before, present, larger) > CALIBRATION.telling && kept < CALIBRATION.told.powi(2))
            || (distinct && held_gain > CALIBRATION.hidden && completes(present, larger))
            || settles(present, larger))
        && held_gain > CALIBRATION.credible * (larger.hold.chi2 - 1.0)
}

/// Share that a larger model keeps of what the present one leaves beyond the noise: of the runs fitted times of the others, for what shows
/// little on the one may show clearly on the other, and a stranger takes little on either.
pub(super) fn kept(present: &ScoredModel, larger: &ScoredModel) -> f64 {
    let share = |present: f64, larger: f64| (larger - 1.0).max(LEAST_GAIN) / (present - 1.0).max(LEAST_GAIN);
    share(present.fit.chi2(), larger.fit.chi2()) * share(present.hold.chi2, larger.hold.chi2)
}

/// Share of the stated model's excess that a larger model takes away, on the kind of runs that shows it better.
fn shown(before: &ScoredModel, present: &ScoredModel, larger: &ScoredModel) -> f64 {
    let share = |stated: f64, present: f64, larger: f64| (present - larger) / (stated - 1.0).max(f64::MIN_POSITIVE);
    let fitted = share(before.fit.chi2(), present.fit.chi2(), larger.fit.chi2());
    fitted.max(share(before.hold.chi2, present.hold.chi2, larger.hold.chi2))
}

/// True where a larger model explains nearly all that the present one leaves, on both kinds of runs.
fn completes(present: &ScoredModel, larger: &ScoredModel) -> bool {
    leaves_at_most(1.0 - CALIBRATION.explained, present, larger)
}

/// True where the present model leaves more than any noise and a larger one a tenth of that at most on either kind of runs and a
/// thousandth of both together: what a simple form leaves is not another effect's to that extent, however much of the mismatch that
/// explains alone.
fn settles(present: &ScoredModel, larger: &ScoredModel) -> bool {
    present.hold.chi2 > CALIBRATION.modest
        && completes(present, larger)
        && kept(present, larger) < (1.0 - CALIBRATION.explained).powi(3)
}

/// True where effects leave a hundredth of the mismatch at most, on both kinds of runs, and the noise of so many samples hides no tenth of it;
/// `quiet` of chi2 is the noise of channels of which nothing follows the motion, and no part of either.
pub(super) fn explains_all(before: &ScoredModel, after: &ScoredModel, quiet: f64) -> bool {
    let floor = 1.0 + quiet;
    all((before.hold.chi2, after.hold.chi2), floor, after.hold.samples)
        && all((before.fit.chi2(), after.fit.chi2()), floor, after.fit.rows)
}

/// The same on the runs that judge.
pub(super) fn explains_all_held(before: &ScoredModel, after: &ScoredModel) -> bool {
    all((before.hold.chi2, after.hold.chi2), 1.0, after.hold.samples)
}

fn all((before, after): (f64, f64), floor: f64, samples: usize) -> bool {
    let (blur, excess) = (blur(samples), before - floor);
    blur < (1.0 - CALIBRATION.explained) * excess
        && after - floor < (1.0 - CALIBRATION.explained).powi(2) * excess + blur
}

/// True where names leave so little of the mismatch on the stretches that weigh that nothing else looks so much like them.
pub(super) fn leaves_next_to_nothing(before: &ScoredModel, after: &ScoredModel) -> bool {
    after.hold.chi2 - 1.0 < SLIGHT * (before.hold.chi2 - 1.0)
}

/// What chance makes of the chi2 of so many samples, three standard deviations.
fn blur(samples: usize) -> f64 {
    3.0 * (2.0 / samples.max(1) as f64).sqrt()
}

/// Whether a larger model leaves less than this share of what the present one leaves beyond the noise, on both kinds of runs.
fn leaves_at_most(share: f64, present: &ScoredModel, larger: &ScoredModel) -> bool {
    let done = |before: f64, after: f64| after - 1.0 < share * (before - 1.0);
    done(present.hold.chi2, larger.hold.chi2) && done(present.fit.chi2(), larger.fit.chi2())
}

/// True where the hold-out runs cannot say: they lack nothing without an effect that explains nearly all that the runs
/// fitted lack.
fn silent(present: &ScoredModel, larger: &ScoredModel) -> bool {
    let lacks = |judged: &ScoredModel| (judged.fit.chi2() - 1.0).max(0.0);
    present.hold.chi2 < 1.0 + CALIBRATION.negligible
        && lacks(present) > SHOWN
        && lacks(larger) < (1.0 - CALIBRATION.explained) * lacks(present)
}

/// True where an added effect fits only at an end of what makes sense, one that stands for no simpler form of it.
pub(super) fn at_bound(judged: &ScoredModel) -> bool {
    let names = judged.fit.model.effects.iter().flat_map(|p| p.entry.parameters.iter().map(|q| (p.entry.id, q)));
    let own = judged.fit.model.values().count() - names.clone().count();
    let pushed = judged.fit.pushed().into_iter().skip(own);
    let values = judged.fit.model.values().skip(own);
    names.zip(values).zip(pushed).any(|(((id, parameter), value), cost)| {
        let at_low = value.value - value.low < value.high - value.value;
        judged.added.contains(&id) && cost > CHANCE && parameter.simple.strained(at_low)
    })
}

/// Excess of chi2 that the effects of a model account for: what the stated model leaves once it is fitted, or, where that fit goes
/// further from what was stated than the model with the effects does, what this model would leave without them. A fit that bends
/// the stated values hides most of a delay; how much of it a simple equation may leave is a share of all that it does.
pub(super) fn accounted(
    before: &ScoredModel,
    after: &ScoredModel,
    score: impl Fn(Model) -> Result<Score, SimulateError>,
) -> Result<f64, SimulateError> {
    let excess = before.hold.chi2 - 1.0;
    if after.added.is_empty() || after.departure.disbelief() >= before.departure.disbelief() {
        return Ok(excess);
    }
    let without = score(after.model_without(&after.added))?.chi2 - 1.0;
    Ok(if without.is_finite() { excess.max(without) } else { excess })
}

/// Whether what is left lies outside the library, and how probable that is.
pub(super) fn outside(before: &ScoredModel, after: &ScoredModel) -> (bool, f64) {
    beyond(before.hold.chi2 - 1.0, after, 0.0)
}

/// The same where the effects account for an `excess` of chi2, and `quiet` of it is the noise of channels that follow nothing.
pub(super) fn beyond(excess: f64, after: &ScoredModel, quiet: f64) -> (bool, f64) {
    let left = after.hold.chi2 - 1.0 - quiet;
    let noise = noise(after);
    let allowed = if at_bound(after) { noise } else { noise.max((1.0 - CALIBRATION.explained) * (excess - quiet)) };
    let ratio = (left / allowed).max(1e-3);
    (left > allowed, 1.0 / (1.0 + (-3.0 * ratio.ln()).exp()) * if ratio < 0.3 { 0.5 } else { 1.0 })
}

/// Excess of chi2 that a noise which is not known better, and chance, leave at most on the stretches that weigh.
fn noise(judged: &ScoredModel) -> f64 {
    CALIBRATION.negligible + blur(judged.hold.samples)
}

/// True where a model leaves no more than that.
pub(super) fn is_within_noise(judged: &ScoredModel) -> bool {
    judged.hold.chi2 - 1.0 <= noise(judged)
}

/// True where a model explains the mismatch with values that make sense.
pub(super) fn sound(before: &ScoredModel, judged: &ScoredModel) -> bool {
    !at_bound(judged) && !outside(before, judged).0
}

#[cfg(test)]
mod tests;
