//! Whether the set-up was stated wrong, instead of physics being left out: what the recordings alone do not show.
//!
//! Without a recorded command nothing but the model tells a controller's gain or a channel that was recorded a sample late; and values of
//! the model that `fit` does not list are held as they were stated. A gain that is stated two per cent wrong looks like friction, one
//! sample like a sensor that lags, an integral gain like a payload. A laboratory's set-up is always a little wrong. So wherever a mismatch
//! was found, the stated model without any effect is asked whether it explains the recordings by another reading of the set-up.

mod reading;

use super::Examined;
use super::calibration::CALIBRATION;
use crate::identify::data::{Channel, Run};
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::score_beside;
use crate::identify::model::{Model, ModelEffect};
use crate::identify::quantity::quantities;
use crate::identify::stated::expect_near_stated;
use crate::plant::effects::{Entry, acceleration_lag, displacement_lag};
use crate::plant::simulate::{Law, SimulateError};
use crate::recording::{Experiment, SetUpFinding};
use rayon::prelude::*;
use reading::Reading;

/// Standard deviations from which a fitted value is another than the stated one.
const CERTAIN: f64 = 3.0;
/// Samples by which a channel may have been recorded late or early.
const SHIFTS: [i32; 4] = [1, -1, 2, -2];
/// Trials of an integral gain, as shares of it: the first two on either side of what was stated, the others from a parabola.
const TRIALS: usize = 3;
const TRIAL: f64 = 0.05;
/// Share by which an integral gain may be stated wrong without a unit or a digit being the likelier fault.
const SLIP: f64 = 0.3;
/// How many times as fast as stated a table is tried, and the share by which one that stayed so is said to be.
const FASTER: f64 = 4.0;
const FAST: f64 = 0.1;
/// Probability below which no name is likelier right than wrong.
const EVEN: f64 = 0.5;
/// Rows beyond which this is not asked: it costs as much as the search.
const MOST_ROWS: usize = 240_000;

/// Sensors' lags, and the channels that are late by them.
const LAGS: [(&Entry, Channel); 2] =
    [(&displacement_lag::ENTRY, Channel::Displacement), (&acceleration_lag::ENTRY, Channel::Acceleration)];

/// What another reading of the set-up does.
pub(super) enum Instead {
    /// Nothing to speak of.
    Nothing,
    /// Other values of the model explain the recordings to within their noise, as what was found does: the data do not tell which it is.
    AsWell(Vec<SetUpFinding>),
    /// A reading explains them, and what was found does not, or is no likelier: the experiment by it, and what is said of it.
    Better(Box<Experiment>, Option<SetUpFinding>),
}

/// A reading with the stated model fitted by it.
struct Tried {
    reading: Reading,
    fit: Fit,
    /// chi2 on the runs that judge, less one.
    left: f64,
}

/// Asks that of a diagnosis of `experiment`.
pub(super) fn instead(experiment: &Experiment, examined: &Examined) -> Result<Instead, SimulateError> {
    let conclusion = &examined.conclusion;
    let rows: usize = examined.prepared.fit.iter().map(Run::len).sum();
    if conclusion.consistent() || rows > MOST_ROWS {
        return Ok(Instead::Nothing);
    }
    if let Some(reading) = sample_for_a_lag(examined)? {
        return Ok(better(experiment, &reading));
    }
    let readings = readings(experiment, examined);
    let tried = readings.par_iter().map(|reading| tried(reading, examined)).collect::<Result<Vec<_>, _>>()?;
    let integral = integral(examined)?;
    let explaining = tried.into_iter().chain(integral).filter(|tried| tried.left < CALIBRATION.negligible);
    // Of readings that explain alike the one that takes least from the data.
    let cost = |tried: &Tried| tried.fit.squares + CALIBRATION.parameter_price * tried.reading.parameters() as f64;
    let Some(best) = explaining.min_by(|a, b| cost(a).total_cmp(&cost(b))) else { return Ok(Instead::Nothing) };
    let found = conclusion.after.hold.chi2 - 1.0;
    let no_name = examined.diagnosis.effects.iter().all(|effect| effect.probability < EVEN);
    let as_well = found <= best.left.max(0.0) + CALIBRATION.negligible;
    let others = others(experiment, &best.fit);
    Ok(match best.reading {
        // Of two accounts that explain alike the one that takes less from the data; of two that take as much, the one that leaves alone
        // what was stated.
        Reading::Values(_) if as_well && !no_name && taken(examined) <= others.len() => Instead::AsWell(others),
        Reading::LateReference(_) | Reading::Late(..) if as_well && !no_name => Instead::Nothing,
        reading => better(experiment, &reading),
    })
}

/// Numbers that the effects found take from the data.
fn taken(examined: &Examined) -> usize {
    let after = &examined.conclusion.after;
    let found = after.fit.model.effects.iter().filter(|placed| after.added.contains(&placed.entry.id));
    found.flat_map(|placed| &placed.values).filter(|value| value.free).count()
}

fn better(experiment: &Experiment, reading: &Reading) -> Instead {
    Instead::Better(Box::new(reading.put_into(experiment)), reading.finding(experiment))
}

/// Every reading but that of the integral gain.
fn readings(experiment: &Experiment, examined: &Examined) -> Vec<Reading> {
    let given = experiment.model.baseline.parameters();
    let held: Vec<&'static str> =
        given.into_iter().map(|(name, _)| name).filter(|name| !experiment.model.fits(name)).collect();
    let mut readings = Vec::new();
    if !held.is_empty() {
        readings.push(Reading::Values(held));
    }
    let runs = &examined.prepared.fit;
    if unrecorded(runs) {
        readings.extend(SHIFTS.map(Reading::LateReference));
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

/// The stated model fitted by a reading, and what it leaves on the runs that judge.
fn tried(reading: &Reading, examined: &Examined) -> Result<Tried, SimulateError> {
    // From what was stated: without this reading the values that may be fitted have gone wherever they hide what is missing.
    let mut model = examined.prepared.model.clone();
    if let Reading::Values(names) = reading {
        for name in names {
            if let Some(value) = model.own_mut(name) {
                value.free = true;
            }
        }
        expect_near_stated(&mut model);
    }
    let mut best = fitted(reading, model.clone(), None, examined)?;
    // A limit that is far too low is not left downhill.
    if matches!(reading, Reading::Values(_))
        && let Some(limit) = model.own_mut("velocity_limit").filter(|limit| limit.free)
    {
        limit.value *= FASTER;
        let faster = fitted(reading, model, None, examined)?;
        best = if faster.0.squares + CALIBRATION.parameter_price < best.0.squares { faster } else { best };
    }
    let (fit, left) = best;
    Ok(Tried { reading: reading.clone(), fit, left })
}

fn fitted(
    reading: &Reading,
    model: Model,
    like: Option<&Fit>,
    examined: &Examined,
) -> Result<(Fit, f64), SimulateError> {
    let runs = reading.of(&examined.prepared.fit);
    let mut fit = match like {
        Some(like) => Fit::resume(model, like.locals.clone(), &runs)?,
        None => Fit::begin(model, &runs)?,
    };
    fit.improve(&runs, Effort::FULL)?;
    let left = score_beside(&fit, &runs, &reading.of(&examined.conclusion.judging))?.chi2 - 1.0;
    Ok((fit, left))
}

/// The stated model with the integral gain that fits best, where the command does not say what it was.
fn integral(examined: &Examined) -> Result<Option<Tried>, SimulateError> {
    let runs = &examined.prepared.fit;
    let integrates = |run: &Run| matches!(run.law, Law::Pi { ki, .. } if ki != 0.0);
    if !unrecorded(runs) || !runs.iter().all(integrates) {
        return Ok(None);
    }
    let at = |share: f64| tried(&Reading::Integral(1.0 + share), examined);
    let mut points = Vec::new();
    for share in [-TRIAL, 0.0, TRIAL] {
        points.push((share, at(share)?));
    }
    for _ in 0..TRIALS {
        points.sort_by(|a, b| a.1.fit.squares.total_cmp(&b.1.fit.squares));
        let of = |i: usize| points.get(i).map(|(share, tried)| (*share, tried.fit.squares));
        let (Some(a), Some(b), Some(c)) = (of(0), of(1), of(2)) else { break };
        let Some(share) = lowest(a, b, c).map(|share| share.clamp(-SLIP, SLIP)) else { break };
        if points.iter().any(|(known, _)| (known - share).abs() < 1e-4) {
            break;
        }
        points.push((share, at(share)?));
    }
    let best = points.into_iter().min_by(|a, b| a.1.fit.squares.total_cmp(&b.1.fit.squares));
    Ok(best.filter(|(share, _)| *share != 0.0 && share.abs() < SLIP).map(|(_, tried)| tried))
}

/// Where the parabola through three points is lowest; none where it has no lowest.
fn lowest((a, fa): (f64, f64), (b, fb): (f64, f64), (c, fc): (f64, f64)) -> Option<f64> {
    let (left, right) = ((b - a) * (fb - fc), (b - c) * (fb - fa));
    let bend = left - right;
    let curved = fa * (b - c) + fb * (c - a) + fc * (a - b);
    // The sign of the second difference, whatever the order of the points.
    let opens_up = curved * (b - c) * (c - a) * (a - b) < 0.0;
    (bend != 0.0 && opens_up).then(|| b - 0.5 * ((b - a) * left - (b - c) * right) / bend)
}

/// A sensor that lags by a whole number of samples is one that was recorded so many samples late, where that explains as much without a
/// number from the data.
fn sample_for_a_lag(examined: &Examined) -> Result<Option<Reading>, SimulateError> {
    let after = &examined.conclusion.after;
    let runs = &examined.prepared.fit;
    let Some(dt) = runs.first().map(|run| run.dt) else { return Ok(None) };
    for (lag, channel) in LAGS {
        let id = lag.id;
        let Some(placed) = after.fit.model.effects.iter().find(|p| p.entry.id == id) else { continue };
        let late = (time_of(placed) / dt).round();
        if !(1.0..=3.0).contains(&late) || !after.added.contains(&id) {
            continue;
        }
        let reading = Reading::Late(channel, late as i32);
        let (fit, left) = fitted(&reading, after.fit.model.without(id), Some(&after.fit), examined)?;
        let price = CALIBRATION.parameter_price * (after.fit.model.values().filter(|v| v.free).count() as f64);
        if left < after.hold.chi2 - 1.0 + 0.5 * CALIBRATION.negligible && fit.squares < after.fit.squares + price {
            return Ok(Some(reading));
        }
    }
    Ok(None)
}

/// The whole time by which a lag comes late, s.
fn time_of(placed: &ModelEffect) -> f64 {
    let keys = placed.entry.parameters.iter().zip(&placed.values);
    keys.filter(|(p, _)| p.unit == "s").map(|(_, value)| value.value).sum()
}

/// The values of a fit that are others than those stated, of those that the experiment holds.
pub(super) fn others(experiment: &Experiment, fit: &Fit) -> Vec<SetUpFinding> {
    let (fitted, parameters) = (quantities(fit), fit.model.kind.parameters());
    let other = |(name, stated): (&'static str, f64)| {
        let quantity = fitted.get(name).filter(|_| !experiment.model.fits(name))?;
        let parameter = parameters.iter().find(|p| p.key == name)?;
        let away = (quantity.value - stated).abs();
        let told = quantity.std.is_some_and(|std| away > CERTAIN * std);
        // A table that never came to its limit says that it is faster, and not by how much.
        let faster = name == "velocity_limit" && quantity.value > (1.0 + FAST) * stated && !told;
        let std = quantity.std.filter(|_| told);
        (told || faster).then(|| SetUpFinding::model_value(name, stated, quantity.value, std, parameter.unit))
    };
    experiment.model.baseline.parameters().into_iter().filter_map(other).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_lowest_where_it_is() {
        let f = |x: f64| (x, 3.0 + 2.0 * (x - 0.12).powi(2));
        for [a, b, c] in [[-0.05, 0.0, 0.05], [0.05, -0.05, 0.0], [0.0, 0.05, -0.05]] {
            let lowest = lowest(f(a), f(b), f(c)).expect("it has a lowest point");
            assert!((lowest - 0.12).abs() < 1e-12, "{lowest}");
        }
        let down = |x: f64| (x, -x * x);
        assert_eq!(lowest(down(-1.0), down(0.5), down(1.0)), None);
        assert_eq!(lowest((0.0, 1.0), (1.0, 2.0), (2.0, 3.0)), None);
    }
}
