//! A fit from several starts: where the stated values leave more than noise, others are tried.

use super::data::Run;
use super::fit::{Effort, Fit};
use super::model::Model;
use super::prepare::Prepared;
use crate::plant::effects::PRESLIDING;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// chi2 at which a fit is taken to be at the floor.
const FLOOR: f64 = 1.2;

/// Factors on every free positive parameter of the model's own.
const FACTORS: [f64; 2] = [0.6, 1.6];

/// Share of the largest speed at which a limit that binds would stand.
const TOP: f64 = 0.97;

/// Factor on the travel over which a stated contact bends before it slides. Where it bends over microns the misfit jumps
/// from one reversal to the next and a fit stays where it began; a soft contact has a smooth misfit and stiffens on the
/// way.
const SOFT: f64 = 50.0;

/// How far another start is taken before it must have beaten the first.
const LOOK: Effort = Effort { steps: 8, tolerance: 1e-4 };

/// Fits the prepared model from the stated values and, where these do not reach the floor, from others; the best.
pub fn fitted(prepared: &Prepared) -> Result<Fit, SimulateError> {
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
    all.extend(with_binding_limit(prepared, TOP));
    all.extend(with_soft_contacts(stated));
    all
}

/// The stated model with every contact that a fit may move made soft; none where there is none.
fn with_soft_contacts(stated: &Model) -> Option<Model> {
    let mut model = stated.clone();
    let mut any = false;
    for placed in &mut model.effects {
        let parameters = placed.entry.parameters.iter().zip(&mut placed.values);
        for (_, travel) in parameters.filter(|(p, v)| p.key == PRESLIDING.key && v.free) {
            travel.value = (SOFT * travel.value).clamp(travel.low, travel.high);
            any = true;
        }
    }
    any.then_some(model)
}

/// The stated model with its velocity limit at this share of the largest speed seen, for a limit that is never reached has
/// no slope to follow; none where it is not free.
pub(super) fn with_binding_limit(prepared: &Prepared, share: f64) -> Option<Model> {
    let mut model = prepared.model.clone();
    let limit = model.own_mut("velocity_limit").filter(|limit| limit.free)?;
    limit.value = (share * prepared.yardsticks.speed).clamp(limit.low, limit.high);
    Some(model)
}
