//! A fit from several starts: where the stated values leave more than noise, others are tried.

use super::data::Run;
use super::fit::{Effort, Fit};
use super::model::Model;
use super::prepare::Prepared;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// chi2 at which a fit is taken to be at the floor.
const FLOOR: f64 = 1.2;

/// Factors on every free positive parameter of the model's own.
const FACTORS: [f64; 2] = [0.6, 1.6];

/// Share of the largest speed at which a limit that binds would stand.
const TOP: f64 = 0.97;

/// How far another start is taken before it must have beaten the first.
const LOOK: Effort = Effort { steps: 8, tolerance: 1e-4 };

/// Fits the prepared model from the stated values and, where these do not reach the floor, from others; the best.
pub fn fitted(prepared: &Prepared) -> Result<Fit, SimulateError> {
    let mut best = from_several(prepared)?;
    best.sharpen(&prepared.fit, LOOK)?;
    Ok(best)
}

fn from_several(prepared: &Prepared) -> Result<Fit, SimulateError> {
    let runs: &[Run] = &prepared.fit;
    let mut best = Fit::begin(prepared.model.clone(), runs)?;
    best.improve(runs, Effort::FULL)?;
    if best.chi2() < FLOOR {
        return Ok(best);
    }
    let looks: Result<Vec<Fit>, SimulateError> = others(prepared)
        .into_par_iter()
        .map(|model| {
            let mut fit = Fit::begin(model, runs)?;
            fit.improve(runs, LOOK)?;
            Ok(fit)
        })
        .collect();
    let other = looks?.into_iter().min_by(|a, b| a.squares.total_cmp(&b.squares));
    if let Some(mut other) = other.filter(|o| o.squares < 0.999 * best.squares) {
        other.improve(runs, Effort::FULL)?;
        best = other;
    }
    Ok(best)
}

/// Other values to start from, within the stated model's bounds.
fn others(prepared: &Prepared) -> Vec<Model> {
    let stated = &prepared.model;
    let mut all = Vec::new();
    if stated.own.iter().any(|v| v.free && v.positive) {
        for factor in FACTORS {
            let mut model = stated.clone();
            for value in model.own.iter_mut().filter(|v| v.free && v.positive) {
                value.value = (value.value * factor).clamp(value.low, value.high);
            }
            all.push(model);
        }
    }
    if let (Kind::Servo, Some(limit)) = (stated.kind, stated.own.get(3).filter(|v| v.free)) {
        let mut model = stated.clone();
        let binding = (TOP * prepared.yardsticks.speed).clamp(limit.low, limit.high);
        model.own[3].value = binding;
        all.push(model);
    }
    all
}
