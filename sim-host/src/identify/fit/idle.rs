//! Limits that nothing reaches: no row depends on them, so that no slope leads to where they bind.

use super::{Fit, priors, squares};
use crate::identify::data::Run;
use crate::identify::model::{Model, Value};
use crate::plant::simulate::SimulateError;

/// Shares of a limit that nothing reaches at which it is tried.
const LOWERED: [f64; 3] = [0.98, 0.94, 0.88];
/// Least step between such shares.
const CLOSE: f64 = 0.002;
/// Squares that a lower limit must save.
const LEAST: f64 = 10.0;
/// What rounding moves squares by, as a share of them.
const ROUNDING: f64 = 1e-9;

impl Fit {
    /// Puts limits lower that nothing reaches: they have no slope to follow. False where that is no better.
    pub(super) fn lowered(&mut self, runs: &[Run]) -> Result<bool, SimulateError> {
        // What was known of it before is no slope.
        let known = |value: &Value| value.prior.map_or(0.0, |prior| prior.std.powi(-2));
        let idle = |(i, value): &(usize, &Value)| value.positive && self.normal.matrix[(*i, *i)] <= known(value);
        let places: Vec<usize> =
            self.model.values().filter(|v| v.free).enumerate().filter(idle).map(|(i, _)| i).collect();
        let own = beyond_known(&self.model, self.squares) * (1.0 + ROUNDING);
        let mut best: Option<(Model, f64)> = None;
        for place in places {
            if self.is_out_of_reach(place, runs)? {
                continue;
            }
            let mut worse = |share: f64| -> Result<bool, SimulateError> {
                let (model, squares) = self.with_share(place, share, runs)?;
                let worse = beyond_known(&model, squares) > own;
                if squares < best.as_ref().map_or(self.squares - LEAST, |(_, least)| *least) {
                    best = Some((model, squares));
                }
                Ok(worse)
            };
            let (mut low, mut high) = (1.0, 1.0);
            for share in LOWERED {
                if worse(share)? && low == high {
                    low = share;
                }
            }
            // The first that was too low may be so by little: then the best is between it and what nothing reaches.
            while high - low > CLOSE {
                let share = 0.5 * (low + high);
                *(if worse(share)? { &mut low } else { &mut high }) = share;
            }
        }
        let Some((model, _)) = best else { return Ok(false) };
        let lower = Self::resume(model, self.locals.clone(), runs)?;
        *self = Self { evaluations: self.evaluations + 1, ..lower };
        Ok(true)
    }

    /// True where nothing reaches a limit at the least of its shares either.
    fn is_out_of_reach(&self, place: usize, runs: &[Run]) -> Result<bool, SimulateError> {
        let (model, squares) = self.with_share(place, LOWERED[LOWERED.len() - 1], runs)?;
        let moved = beyond_known(&model, squares) - beyond_known(&self.model, self.squares);
        Ok(moved.abs() <= ROUNDING * self.squares)
    }

    /// The model with one free value at a share of what it is, and its squares.
    fn with_share(&self, place: usize, share: f64, runs: &[Run]) -> Result<(Model, f64), SimulateError> {
        let mut model = self.model.clone();
        if let Some(value) = model.values_mut().filter(|v| v.free).nth(place) {
            value.value = (value.value * share).max(value.low);
        }
        let squares = squares(&model, &self.locals, runs)?;
        Ok((model, squares))
    }
}

/// Squares less what values away from those known before cost.
fn beyond_known(model: &Model, squares: f64) -> f64 {
    squares - priors(model).map(|(_, away, _)| away * away).sum::<f64>()
}
