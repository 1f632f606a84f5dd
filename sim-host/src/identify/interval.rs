//! Profile-likelihood intervals: how far a parameter can be moved, every other one fitted again, before the misfit grows
//! by more than chance allows.
//!
//! A standard deviation takes the misfit for a parabola; a profile follows its true shape, so that it finds the one-sided
//! knowledge of a limit that was never met and the long arm of a parameter that others can stand in for. Chance is
//! measured with the residuals' own colour: the threshold is widened by [`Fit::inflation`].
//!
//! Source: D. J. Venzon, S. H. Moolgavkar, "A method for computing profile-likelihood-based confidence intervals",
//! Applied Statistics 37 (1988) 87-94.

pub use super::covariance::NINETY;
use super::data::Run;
use super::fit::{Effort, Fit};
use super::model::Value;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// How an end is fitted: near the end of a profile the others hardly move.
const REFIT: Effort = Effort { steps: 5, tolerance: 1e-4 };

/// Places tried for one end.
const TRIES: usize = 10;

/// How near to the threshold, in its own multiple, an end must lie.
const NEAR: f64 = 0.04;

/// A 90 % interval; an end that the data do not give is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl Interval {
    /// True where the data bound the parameter from both sides.
    pub fn is_closed(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// The interval of every shared value in the order of [`super::model::Model::values`]; none where it was not free.
pub fn profiles(fit: &Fit, runs: &[Run]) -> Result<Vec<Option<Interval>>, SimulateError> {
    let deviations = fit.deviations();
    let inflation = fit.inflation();
    let free: Vec<usize> = fit.model.values().enumerate().filter(|(_, v)| v.free).map(|(i, _)| i).collect();
    let ends: Result<Vec<Option<f64>>, SimulateError> = (0..2 * free.len())
        .into_par_iter()
        .map(|job| {
            let (place, sign) = (job / 2, if job % 2 == 0 { -1.0 } else { 1.0 });
            let inflation = inflation.as_ref().map_or(1.0, |all| all[place]);
            let inflation = if inflation.is_finite() { inflation.max(1.0) } else { 1.0 };
            let which = Which { index: free[place], sign, deviation: deviations[free[place]], inflation };
            end(fit, runs, which)
        })
        .collect();
    let ends = ends?;
    let mut all = vec![None; deviations.len()];
    for (place, pair) in ends.chunks_exact(2).enumerate() {
        all[free[place]] = Some(Interval { low: pair[0], high: pair[1] });
    }
    Ok(all)
}

/// One end of one parameter's interval.
#[derive(Debug, Clone, Copy)]
struct Which {
    index: usize,
    sign: f64,
    /// Standard deviation, the value's unit; infinite where there is none.
    deviation: f64,
    inflation: f64,
}

/// Looks for the place where the misfit crosses the threshold; none where it stays below up to the bound.
fn end(fit: &Fit, runs: &[Run], which: Which) -> Result<Option<f64>, SimulateError> {
    let Some(best) = fit.model.values().nth(which.index).copied() else { return Ok(None) };
    let first = first_step(&best, which.deviation);
    let bound = if which.sign > 0.0 { best.high } else { best.low };
    let (mut inside, mut outside): ((f64, f64), Option<(f64, f64)>) = ((0.0, 0.0), None);
    let mut step = first;
    for _ in 0..TRIES {
        let mut value = best;
        value.set_coordinate(best.coordinate() + which.sign * step);
        let at_bound = value.value == bound;
        let rise = rise(fit, runs, which, value)?;
        if (rise - 1.0).abs() < NEAR || (at_bound && rise > 1.0 && inside.0 > 0.9 * step) {
            return Ok(Some(corrected(&best, which.sign, step / rise)));
        }
        if rise < 1.0 {
            if at_bound {
                return Ok(None);
            }
            inside = (step, rise);
        } else {
            outside = Some((step, rise));
        }
        step = next(inside, outside);
    }
    Ok(outside.map(|outside| corrected(&best, which.sign, crossing(inside, outside))))
}

/// The first place to look: where the end would be on a parabola, or a tenth of the value where there is none.
fn first_step(best: &Value, deviation: f64) -> f64 {
    if deviation.is_finite() && deviation > 0.0 {
        return (NINETY * deviation / best.slope().max(f64::MIN_POSITIVE)).min(if best.positive {
            2.0
        } else {
            f64::MAX
        });
    }
    if best.positive { 0.1 } else { 0.1 * best.value.abs().max(1e-6) }
}

/// A place between those known, or further out.
fn next(inside: (f64, f64), outside: Option<(f64, f64)>) -> f64 {
    match outside {
        // Far outside the profile is no longer a line.
        Some(outside) if outside.1 > 4.0 => 0.5 * (inside.0 + outside.0),
        Some(outside) => {
            let step = crossing(inside, outside);
            step.clamp(inside.0 + 0.1 * (outside.0 - inside.0), outside.0 - 0.1 * (outside.0 - inside.0))
        }
        None => inside.0 * (1.0 / inside.1.max(1e-3)).clamp(1.3, 4.0),
    }
}

/// Where a straight line between two places crosses the threshold.
fn crossing(inside: (f64, f64), outside: (f64, f64)) -> f64 {
    inside.0 + (outside.0 - inside.0) * (1.0 - inside.1) / (outside.1 - inside.1).max(1e-12)
}

fn corrected(best: &Value, sign: f64, step: f64) -> f64 {
    let mut value = *best;
    value.set_coordinate(best.coordinate() + sign * step);
    value.value
}

/// Root of the misfit's growth over the threshold with one parameter held, the others fitted again: 1 at the end.
fn rise(fit: &Fit, runs: &[Run], which: Which, value: Value) -> Result<f64, SimulateError> {
    let mut model = fit.model.clone();
    if let Some(held) = model.values_mut().nth(which.index) {
        *held = Value { free: false, ..value };
    }
    let mut held = Fit::resume(model, fit.locals.clone(), runs)?;
    held.improve(runs, REFIT)?;
    let grown = (held.squares - fit.squares).max(0.0);
    let rise = (grown / which.inflation).sqrt() / NINETY;
    Ok(if rise.is_finite() { rise } else { f64::MAX })
}
