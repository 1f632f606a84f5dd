//! A reading of the set-up tried: a model fitted to the runs as it has them.

use super::reading::Reading;
use crate::diagnose::calibration::CALIBRATION;
use crate::diagnose::concluded::Concluded;
use crate::identify::data::Run;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::score_beside;
use crate::identify::model::Model;
use crate::identify::stated::expect_near_stated;
use crate::plant::simulate::{SimulateError, SimulatedLaw};

/// Trials of a gain, as shares of it: the first two on either side of what was stated, the others from a parabola.
const TRIALS: usize = 6;
const TRIAL: f64 = 0.05;
/// Share of what the stated gain leaves beyond which a gain that a parabola finds explains too little for another trial.
const HALF: f64 = 0.5;
/// Share by which a gain may be stated wrong without a unit or a digit being the likelier fault.
const SLIP: f64 = 0.3;
/// How many times as fast as stated a table is tried.
const FASTER: f64 = 4.0;

/// What a reading is tried on: a model, and the fit that its runs start from.
pub(super) struct Base<'a> {
    model: Model,
    like: Option<&'a Fit>,
}

/// A reading with a model fitted by it.
pub(super) struct Tried {
    pub(super) reading: Reading,
    pub(super) fit: Fit,
    /// chi2 on the runs that judge, less one.
    pub(super) left: f64,
}

impl<'a> Base<'a> {
    /// The stated model, from what was stated: without a reading the values that may be fitted have gone wherever they hide what is
    /// missing.
    pub(super) fn stated(concluded: &Concluded) -> Self {
        Self { model: concluded.whole.model.clone(), like: None }
    }

    /// A model that was fitted, with these effects of it.
    pub(super) fn fitted(model: Model, fit: &'a Fit) -> Self {
        Self { model, like: Some(fit) }
    }
}

/// A model fitted by a reading, and what it leaves on the runs that judge.
pub(super) fn tried(reading: &Reading, base: &Base<'_>, concluded: &Concluded) -> Result<Tried, SimulateError> {
    let mut model = base.model.clone();
    if let Reading::Values(names) = reading {
        for name in names {
            if let Some(value) = model.own_mut(name) {
                value.free = true;
            }
        }
        expect_near_stated(&mut model);
    }
    let mut best = fitted(reading, model.clone(), base.like, concluded)?;
    // A limit that is far too low is not left downhill.
    if matches!(reading, Reading::Values(_))
        && let Some(limit) = model.own_mut("velocity_limit").filter(|limit| limit.free)
    {
        limit.value *= FASTER;
        let faster = fitted(reading, model, base.like, concluded)?;
        best = if faster.0.squares + CALIBRATION.parameter_price < best.0.squares { faster } else { best };
    }
    let (fit, left) = best;
    Ok(Tried { reading: reading.clone(), fit, left })
}

fn fitted(
    reading: &Reading,
    model: Model,
    like: Option<&Fit>,
    concluded: &Concluded,
) -> Result<(Fit, f64), SimulateError> {
    let runs = reading.of(&concluded.whole.fit);
    let mut fit = match like {
        Some(like) => Fit::resume(model, like.locals.clone(), &runs)?,
        None => Fit::begin(model, &runs)?,
    };
    fit.improve(&runs, Effort::FULL)?;
    let left = score_beside(&fit, &runs, &reading.of(&concluded.conclusion.judging))?.chi2 - 1.0;
    Ok((fit, left))
}

/// A model with the gain of the controller that fits best, of those that no value of the model takes up, where the command does not say
/// what it was.
pub(super) fn gain(base: &Base<'_>, concluded: &Concluded) -> Result<Option<Tried>, SimulateError> {
    let runs = &concluded.whole.fit;
    let has_one = |run: &Run| match run.law {
        SimulatedLaw::Pi { ki: gain, .. } | SimulatedLaw::Cascade { kp: gain, .. } => gain != 0.0,
        SimulatedLaw::Recorded => false,
    };
    if !super::unrecorded(runs) || !runs.iter().all(has_one) {
        return Ok(None);
    }
    let at = |share: f64| tried(&Reading::Gain(1.0 + share), base, concluded);
    let mut points = Vec::new();
    for share in [-TRIAL, 0.0, TRIAL] {
        points.push((share, at(share)?));
    }
    let beyond = |tried: &Tried| tried.fit.squares - tried.fit.rows as f64;
    let as_stated = points.iter().find(|(share, _)| *share == 0.0).map_or(f64::INFINITY, |(_, tried)| beyond(tried));
    for _ in 0..TRIALS {
        points.sort_by(|a, b| a.1.fit.squares.total_cmp(&b.1.fit.squares));
        let of = |i: usize| points.get(i).map(|(share, tried)| (*share, tried.fit.squares));
        let (Some(a), Some(b), Some(c)) = (of(0), of(1), of(2)) else { break };
        let Some(share) = lowest(a, b, c).map(|share| share.clamp(-SLIP, SLIP)) else { break };
        if points.iter().any(|(known, _)| (known - share).abs() < 1e-4) {
            break;
        }
        let trial = at(share)?;
        // Where the gain is what is wrong, another explains nearly all, and a parabola finds most of that at once.
        if beyond(&trial) > HALF * as_stated {
            break;
        }
        points.push((share, trial));
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
