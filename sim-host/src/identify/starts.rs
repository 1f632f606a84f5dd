//! A fit from several starts: where the stated values leave more than noise, others are tried.

use super::data::Run;
use super::fit::{Effort, Fit};
use super::model::{Model, ModelEffect};
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

/// How far each other start is taken, how many of them go on, and how far before they must have beaten the first.
const GLANCE: Effort = Effort { steps: 3, tolerance: 1e-4 };
const HOPEFUL: usize = 5;
const LOOK: Effort = Effort { steps: 8, tolerance: 1e-4 };

/// Fits the prepared model from the stated values and, where these do not reach the floor, from others; the best.
pub fn fitted(prepared: &Prepared) -> Result<Fit, SimulateError> {
    let runs: &[Run] = &prepared.fit;
    let mut best = Fit::begin(prepared.model.clone(), runs)?;
    best.improve(runs, Effort::FULL)?;
    if best.chi2() < FLOOR {
        return Ok(best);
    }
    let taken = |(mut fit, effort): (Fit, Effort)| -> Result<Fit, SimulateError> {
        fit.improve(runs, effort)?;
        Ok(fit)
    };
    let begun = |model: Model| taken((Fit::begin(model, runs)?, GLANCE));
    let mut looks = others(prepared).into_par_iter().map(begun).collect::<Result<Vec<_>, _>>()?;
    looks.sort_by(|a, b| a.squares.total_cmp(&b.squares));
    looks.truncate(HOPEFUL);
    let looks: Result<Vec<Fit>, SimulateError> = looks.into_par_iter().map(|fit| taken((fit, LOOK))).collect();
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
    all.extend(with_binding_limit(stated, TOP * prepared.signal_scales.speed));
    all.extend(with_soft_contacts(stated));
    all.extend(stated.effects.iter().flat_map(|placed| with_other_values(prepared, placed)));
    all
}

/// The stated model with each of the library's starting values of an effect of which no value is stated: where a diagnosis would begin.
fn with_other_values(prepared: &Prepared, placed: &ModelEffect) -> Vec<Model> {
    let starts = |i| ModelEffect::start(placed.entry, i, &prepared.signal_scales);
    let at = |start: &ModelEffect| {
        let mut pairs = placed.values.iter().zip(&start.values).filter(|(value, _)| value.free).peekable();
        pairs.peek().is_some() && pairs.all(|(value, start)| value.value == start.value)
    };
    if !starts(0).is_some_and(|first| at(&first)) {
        return Vec::new();
    }
    let moved = |start: ModelEffect| {
        let mut model = prepared.model.clone();
        let own = model.effects.iter_mut().find(|own| own.entry.id == placed.entry.id)?;
        for (value, start) in own.values.iter_mut().zip(start.values).filter(|(value, _)| value.free) {
            value.value = start.value;
        }
        Some(model)
    };
    (1..).map_while(starts).filter_map(moved).collect()
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

/// A model with its velocity limit at this speed, m/s, for a limit that is never reached has no slope to follow; none where it is not free.
pub(super) fn with_binding_limit(model: &Model, speed: f64) -> Option<Model> {
    let mut model = model.clone();
    let limit = model.own_mut("velocity_limit").filter(|limit| limit.free)?;
    limit.value = speed.clamp(limit.low, limit.high);
    Some(model)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model, recorded};
    use crate::identify::model::SignalScales;
    use crate::plant::effects::entry;

    /// Leakage that is far from the least that the library starts with bends the model's own values first; from another start it is found.
    #[test]
    fn an_effect_of_which_nothing_is_stated_begins_where_a_diagnosis_would() {
        let leakage = |coefficient: Option<f64>| {
            let mut placed = ModelEffect::start(entry("leakage").unwrap(), 0, &SignalScales::TYPICAL).unwrap();
            if let Some(coefficient) = coefficient {
                placed.values[0].value = coefficient;
            }
            model(TRUTH).with(placed)
        };
        let fit: Vec<Run> = (1..3).map(|seed| recorded(&leakage(Some(0.08)), seed)).collect();
        let others = |stated: Model| {
            let prepared =
                Prepared { model: stated, fit: fit.clone(), holdout: Vec::new(), signal_scales: SignalScales::TYPICAL };
            (others(&prepared).len(), fitted(&prepared).unwrap())
        };
        let (unstated, found) = others(leakage(None));
        let (stated, _) = others(leakage(Some(0.05)));
        assert!(unstated > stated, "{unstated} other starts, {stated} where a value is stated");
        let value = found.model.effects[0].values[0].value;
        assert!(found.chi2() < FLOOR && (value / 0.08 - 1.0).abs() < 0.05, "chi2 {}, {value}", found.chi2());
    }
}
