//! Whether the set-up was stated wrong, instead of physics being left out: what the recordings alone do not show.
//!
//! Without a recorded command nothing but the model tells a controller's gain or a channel that was recorded a sample late; and values of
//! the model that `fit` does not list are held as they were stated. A gain that is stated two per cent wrong looks like friction, one
//! sample like a sensor that lags, an integral gain like a payload. A laboratory's set-up is always a little wrong. So wherever a mismatch
//! was found, the stated model without any effect is asked whether it explains the recordings by another reading of the set-up.

mod reading;
mod trial;

use super::SEARCHED;
use super::calibration::CALIBRATION;
use super::concluded::{Concluded, FAR_LESS};
use super::decide::{EVEN, one_story};
use super::far::{ValueBesideStated, fitted_beside_stated};
use crate::identify::data::{Channel, Run};
use crate::identify::fit::Fit;
use crate::identify::model::ModelEffect;
use crate::identify::quantity::quantities;
use crate::plant::effects::{Entry, acceleration_lag, displacement_lag};
use crate::plant::simulate::SimulateError;
use crate::recording::{Experiment, SetUpFinding};
use rayon::prelude::*;
use reading::Reading;
use trial::{Base, Tried, gain, tried};

/// Samples by which a channel may have been recorded late or early.
const SHIFTS: [i32; 4] = [1, -1, 2, -2];
/// Share by which a table that never came to its limit is said to be faster than stated.
const FAST: f64 = 0.1;
/// Rows beyond which this is not asked: it costs as much as the search.
const MOST_ROWS: usize = 2 * SEARCHED;
/// How well a lag must be known to be a whole number of samples, and how far it may be from one beside that, samples.
const WHOLE: f64 = 0.2;
const ROUNDED: f64 = 0.02;

/// Sensors' lags, and the channels that are late by them.
const LAGS: [(&Entry, Channel); 2] =
    [(&displacement_lag::ENTRY, Channel::Displacement), (&acceleration_lag::ENTRY, Channel::Acceleration)];

/// What another reading of the set-up does.
pub(super) enum Instead {
    /// Nothing to speak of.
    Nothing,
    /// Other values of the model explain the recordings to within their noise, as what was found does: the data do not tell which it is.
    AsWell(Vec<SetUpFinding>),
    /// A reading explains them, and what was found does not, or is no likelier.
    Better(Other),
}

/// An experiment by another reading of its set-up.
pub(super) struct Other {
    pub(super) experiment: Experiment,
    /// What is said of it; values of the model say it by themselves.
    pub(super) finding: Option<SetUpFinding>,
}

/// Asks that of what was concluded of `experiment`.
pub(super) fn instead(experiment: &Experiment, concluded: &Concluded) -> Result<Instead, SimulateError> {
    let conclusion = &concluded.conclusion;
    let rows: usize = concluded.whole.fit.iter().map(Run::len).sum();
    if conclusion.consistent() || rows > MOST_ROWS {
        return Ok(Instead::Nothing);
    }
    if let Some(reading) = sample_for_a_lag(concluded)? {
        return Ok(better(experiment, &reading));
    }
    if let Some(reading) = gain_for_one_of_several(concluded)? {
        return Ok(better(experiment, &reading));
    }
    let all = all(&readings(experiment, concluded), &Base::stated(concluded), concluded)?;
    let (explaining, rest): (Vec<_>, Vec<_>) = all.into_iter().partition(|tried| tried.left < CALIBRATION.negligible);
    // Of readings that explain alike the one that takes least from the data.
    let cost = |tried: &Tried| tried.fit.squares + CALIBRATION.parameter_price * tried.reading.parameters() as f64;
    let Some(best) = explaining.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b))) else {
        if let Some(gain) = rest.iter().find(|tried| is_nearly_all(tried, concluded)) {
            return Ok(better(experiment, &gain.reading));
        }
        let beside = beside(experiment, concluded)?;
        return Ok(beside.map_or(Instead::Nothing, |reading| better(experiment, &reading)));
    };
    let found = conclusion.accepted.hold.chi2 - 1.0;
    let doubtful = conclusion.accepted.added.iter().all(|id| conclusion.decision.probability(id) < EVEN);
    let no_name = conclusion.unlisted || (doubtful && !one_story(&conclusion.decision));
    let as_well = found <= best.left.max(0.0) + CALIBRATION.negligible;
    let others = others(experiment, &best.fit);
    let price = CALIBRATION.parameter_price * taken(concluded) as f64;
    let cheaper = best.fit.squares < conclusion.accepted.fit.squares + price;
    Ok(match best.reading {
        // Of two accounts that explain alike the one that takes less from the data; of two that take as much, the one that leaves alone
        // what was stated.
        Reading::Values(_) if as_well && !no_name && taken(concluded) <= others.len() => Instead::AsWell(others),
        Reading::LateReference(_) | Reading::Late(..) if as_well && !no_name && !cheaper => Instead::Nothing,
        reading => better(experiment, &reading),
    })
}

/// Every reading tried on a model, that of a gain among them.
fn all(readings: &[Reading], base: &Base<'_>, concluded: &Concluded) -> Result<Vec<Tried>, SimulateError> {
    let mut all = readings.par_iter().map(|reading| tried(reading, base, concluded)).collect::<Result<Vec<_>, _>>()?;
    all.extend(gain(base, concluded)?);
    Ok(all)
}

/// Whether a gain explains nearly all of a mismatch that no name explains, and more than a curve does: what it leaves is asked once more.
fn is_nearly_all(tried: &Tried, concluded: &Concluded) -> bool {
    let conclusion = &concluded.conclusion;
    matches!(tried.reading, Reading::Gain(_))
        && conclusion.unlisted
        && tried.left < (1.0 - CALIBRATION.explained).powi(2) * (conclusion.stated.hold.chi2 - 1.0)
        && tried.left < conclusion.accepted.hold.chi2 - 1.0
}

/// A reading beside the effects that explain a part: one by which they leave far less.
fn beside(experiment: &Experiment, concluded: &Concluded) -> Result<Option<Reading>, SimulateError> {
    let conclusion = &concluded.conclusion;
    let part = match (conclusion.unlisted, conclusion.more_missing) {
        (true, _) => conclusion.partial.as_ref(),
        (false, true) => Some(&conclusion.accepted),
        (false, false) => None,
    };
    let Some(part) = part else { return Ok(None) };
    let mut readings = readings(experiment, concluded);
    readings.retain(|reading| reading.parameters() == 0);
    let tried = all(&readings, &Base::fitted(part.fit.model.clone(), &part.fit), concluded)?;
    let best = tried.into_iter().min_by(|a, b| a.left.total_cmp(&b.left));
    Ok(best.filter(|best| best.left < FAR_LESS * (part.hold.chi2 - 1.0)).map(|best| best.reading))
}

/// Numbers that the effects found take from the data.
fn taken(concluded: &Concluded) -> usize {
    let after = &concluded.conclusion.accepted;
    taken_by(&after.fit, &after.added)
}

/// Numbers that these effects take.
fn taken_by(fit: &Fit, ids: &[&'static str]) -> usize {
    let placed = fit.model.effects.iter().filter(|placed| ids.contains(&placed.entry.id));
    placed.flat_map(|placed| &placed.values).filter(|value| value.free).count()
}

fn better(experiment: &Experiment, reading: &Reading) -> Instead {
    Instead::Better(Other { experiment: reading.put_into(experiment), finding: reading.finding(experiment) })
}

/// Every reading but that of a gain.
fn readings(experiment: &Experiment, concluded: &Concluded) -> Vec<Reading> {
    let given = experiment.model.baseline.parameters();
    let held: Vec<&'static str> =
        given.into_iter().map(|(name, _)| name).filter(|name| !experiment.model.fits(name)).collect();
    let mut readings = Vec::new();
    if !held.is_empty() {
        readings.push(Reading::Values(held));
    }
    let runs = &concluded.whole.fit;
    if unrecorded(runs) {
        readings.extend(SHIFTS.map(Reading::LateReference));
    }
    // What looks like a controller that acts late may be its command that was recorded late.
    let late = runs.first().map_or(0, |run| run.shaping.late_command);
    if late > 0 && runs.iter().all(|run| run.shaping.late_command == late) {
        readings.push(Reading::Late(Channel::Command, late as i32));
    }
    for channel in [Channel::Displacement, Channel::Acceleration] {
        if runs.iter().all(|run| run.channel(channel).is_some_and(|measured| measured.judged)) {
            readings.extend(SHIFTS.map(|by| Reading::Late(channel, by)));
        }
    }
    readings
}

/// Whether the loops are closed by laws whose commands nobody recorded.
fn unrecorded(runs: &[Run]) -> bool {
    runs.iter().all(|run| run.law.simulates_reference() && run.channel(Channel::Command).is_none())
}

/// A sensor that lags by a whole number of samples is one that was recorded so many samples late, where that explains as much without a
/// number from the data.
fn sample_for_a_lag(concluded: &Concluded) -> Result<Option<Reading>, SimulateError> {
    let after = &concluded.conclusion.accepted;
    let runs = &concluded.whole.fit;
    let Some(dt) = runs.first().map(|run| run.dt) else { return Ok(None) };
    let quantities = quantities(&after.fit);
    for (lag, channel) in LAGS {
        let id = lag.id;
        let Some(placed) = after.fit.model.effects.iter().find(|p| p.entry.id == id) else { continue };
        let time = time_of(placed);
        let late = (time / dt).round();
        let std = quantities.get(&format!("{id}.time")).and_then(|q| q.std).unwrap_or(f64::INFINITY);
        let whole = std < WHOLE * dt && (time - late * dt).abs() < 2.0 * std + ROUNDED * dt;
        if !whole || !(1.0..=3.0).contains(&late) || !after.added.contains(&id) {
            continue;
        }
        let reading = Reading::Late(channel, late as i32);
        let Tried { fit, left, .. } =
            tried(&reading, &Base::fitted(after.fit.model.without(id), &after.fit), concluded)?;
        let price = CALIBRATION.parameter_price * (after.fit.model.values().filter(|v| v.free).count() as f64);
        if left < after.hold.chi2 - 1.0 + 0.5 * CALIBRATION.negligible && fit.squares < after.fit.squares + price {
            return Ok(Some(reading));
        }
    }
    Ok(None)
}

/// A gain that was stated wrong, in the place of one of several effects that explain all: what looks like a weak spring beside a
/// droop may be that, and is what a laboratory states wrong every week.
fn gain_for_one_of_several(concluded: &Concluded) -> Result<Option<Reading>, SimulateError> {
    let conclusion = &concluded.conclusion;
    let after = &conclusion.accepted;
    if after.added.len() < 2 || conclusion.unlisted || conclusion.more_missing {
        return Ok(None);
    }
    let as_well = |id: &&'static str| -> Result<Option<Tried>, SimulateError> {
        let tried = gain(&Base::fitted(after.fit.model.without(id), &after.fit), concluded)?;
        let price = CALIBRATION.parameter_price * taken_by(&after.fit, &[*id]) as f64;
        Ok(tried.filter(|tried| {
            tried.left < after.hold.chi2 - 1.0 + 0.5 * CALIBRATION.negligible
                && tried.fit.squares < after.fit.squares + price
        }))
    };
    let tried = after.added.par_iter().map(as_well).collect::<Result<Vec<_>, _>>()?;
    let best = tried.into_iter().flatten().min_by(|a, b| a.fit.squares.total_cmp(&b.fit.squares));
    Ok(best.map(|best| best.reading))
}

/// The whole time by which a lag comes late, s.
fn time_of(placed: &ModelEffect) -> f64 {
    let keys = placed.entry.parameters.iter().zip(&placed.values);
    keys.filter(|(p, _)| p.unit == "s").map(|(_, value)| value.value).sum()
}

/// The values of a fit that are others than those stated, of those that the experiment holds.
pub(super) fn others(experiment: &Experiment, fit: &Fit) -> Vec<SetUpFinding> {
    let other = |value: &ValueBesideStated| {
        if value.is_another() {
            return Some(value.finding(value.fitted.std));
        }
        // A table that never came to its limit says that it is faster, and not by how much.
        let faster = value.name == "velocity_limit" && value.fitted.value > (1.0 + FAST) * value.stated;
        faster.then(|| value.finding(None))
    };
    fitted_beside_stated(experiment, fit).iter().filter(|value| !value.listed).filter_map(other).collect()
}
