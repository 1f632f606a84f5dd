//! Stated values of the model that the data place far away.

use super::calibration::CALIBRATION;
use super::verdict::Conclusion;
use crate::identify::fit::Fit;
use crate::identify::prepare::Prepared;
use crate::identify::quantity::{Quantity, quantities};
use crate::identify::stated::fit_near;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulateError;
use crate::recording::{Experiment, SetUpFinding};

/// Distance of a fitted value from the stated one, as a logarithm, from which the model is said to be of another table.
const FAR: f64 = 0.4;
/// Standard deviations from which it is distinguished from the stated one.
const CERTAIN: f64 = 3.0;
/// The same for any of the ten or so parameters that effects of a model have: one of a thousand untouched models is called another.
const CERTAIN_OF_ANY: f64 = 4.0;

/// A stated value of the model, and what a fit made of it.
pub(super) struct ValueBesideStated {
    pub(super) name: &'static str,
    pub(super) stated: f64,
    pub(super) fitted: Quantity,
    /// Whether the experiment lists it in `fit`.
    pub(super) listed: bool,
}

impl ValueBesideStated {
    /// Whether the fit is another than what was stated for certain.
    pub(super) fn is_another(&self) -> bool {
        self.fitted.std.is_some_and(|std| (self.fitted.value - self.stated).abs() > CERTAIN * std)
    }

    /// What is said of it.
    pub(super) fn finding(&self, std: Option<f64>) -> SetUpFinding {
        SetUpFinding::model_value(self.name, self.stated, self.fitted.value, std, self.fitted.unit)
    }
}

/// Every stated value of the model beside what a fit made of it.
pub(super) fn fitted_beside_stated(experiment: &Experiment, fit: &Fit) -> Vec<ValueBesideStated> {
    let mut fitted = quantities(fit);
    let beside = |(name, stated): (&'static str, f64)| {
        Some(ValueBesideStated { name, stated, fitted: fitted.remove(name)?, listed: experiment.model.fits(name) })
    };
    experiment.model.baseline.parameters().into_iter().filter_map(beside).collect()
}

/// Those that are far away, by name.
pub(super) fn far_from_stated(
    experiment: &Experiment,
    whole: &Prepared,
    conclusion: &Conclusion,
) -> Result<Vec<SetUpFinding>, SimulateError> {
    let fit = &conclusion.accepted.fit;
    // Masses and dashpots may be stated in any way: residuals depend on them almost linearly.
    if fit.model.kind != Kind::Servo {
        return Ok(Vec::new());
    }
    // A value of the other sign has no logarithm.
    let is_far = |value: &ValueBesideStated| {
        let away = (value.fitted.value / value.stated).ln().abs();
        value.is_another() && (away.is_nan() || away >= FAR)
    };
    let listed = fitted_beside_stated(experiment, fit).into_iter().filter(|value| value.listed);
    let found: Vec<SetUpFinding> = listed.filter(is_far).map(|value| value.finding(value.fitted.std)).collect();
    Ok(if found.is_empty() || is_needed(fit, whole)? { found } else { Vec::new() })
}

/// Parameters of stated effects that these recordings place elsewhere than the one that determined them: both accuracies are known.
pub(super) fn moved_effects(experiment: &Experiment, conclusion: &Conclusion) -> Vec<SetUpFinding> {
    let model = &experiment.model;
    // A curve for what no name explains takes a share of what the stated effects do.
    let best = if conclusion.unlisted { &conclusion.stated } else { &conclusion.accepted };
    let fitted = quantities(&best.fit);
    let each = model
        .effects
        .iter()
        .flat_map(|effect| effect.parameters.iter().map(|(key, value)| (format!("{}.{key}", effect.id), *value)));
    let moved = |(name, stated): (String, f64)| {
        let std = model.accuracy.get(&name).filter(|_| model.fits(&name))?.std?;
        let now = fitted.get(&name)?;
        let apart = (now.value - stated).abs() > CERTAIN_OF_ANY * std.hypot(now.std?);
        apart.then(|| SetUpFinding::model_value(&name, stated, now.value, now.std, now.unit))
    };
    each.filter_map(moved).collect()
}

/// Whether the data need values that are far from those stated: with values near these, all else fitted anew, more is left of what the
/// model leaves as it was stated than a right effect's simple equation may leave. What such an equation leaves moves values that
/// explain little by many times the deviation of their fit.
fn is_needed(fit: &Fit, whole: &Prepared) -> Result<bool, SimulateError> {
    let Some(near) = fit_near(whole, fit)? else { return Ok(false) };
    let as_stated = Fit::begin(whole.model.clone(), &whole.fit)?.chi2() - 1.0;
    let left = near.chi2() - fit.chi2();
    Ok(left > CALIBRATION.negligible.max((1.0 - CALIBRATION.explained) * as_stated))
}

#[cfg(test)]
mod tests;
