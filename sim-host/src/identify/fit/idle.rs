//! Limits that nothing reaches: no row depends on them, so that no slope leads to where they bind.

use super::{Fit, squares};
use crate::identify::data::Run;
use crate::identify::model::{Model, Value};
use crate::plant::simulate::SimulateError;

/// Shares of a limit that nothing reaches at which it is tried.
const LOWERED: [f64; 3] = [0.98, 0.94, 0.88];
/// Least step between such shares.
const CLOSE: f64 = 0.002;
/// Squares that a lower limit must save.
const LEAST: f64 = 10.0;

impl Fit {
    /// Puts limits lower that nothing reaches: they have no slope to follow. False where that is no better.
    pub(super) fn lowered(&mut self, runs: &[Run]) -> Result<bool, SimulateError> {
        let idle = |(i, value): &(usize, &Value)| value.positive && self.normal.matrix[(*i, *i)] == 0.0;
        let places: Vec<usize> =
            self.model.values().filter(|v| v.free).enumerate().filter(idle).map(|(i, _)| i).collect();
        let mut best: Option<(Model, f64)> = None;
        for place in places {
            let mut worse = |share: f64| -> Result<bool, SimulateError> {
                let (model, squares) = self.with_share(place, share, runs)?;
                if squares < best.as_ref().map_or(self.squares - LEAST, |(_, least)| *least) {
                    best = Some((model, squares));
                }
                Ok(squares > self.squares)
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
