//! Stated values of the model that the data place far away.

use super::calibration::CALIBRATION;
use super::verdict::Conclusion;
use crate::identify::fit::Fit;
use crate::identify::prepare::Prepared;
use crate::identify::quantity::quantities;
use crate::identify::stated::fit_near;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulateError;
use crate::recording::{Experiment, SetUpFinding};

/// Distance of a fitted value from the stated one, as a logarithm, from which the model is said to be of another table.
const FAR: f64 = 0.4;
/// Standard deviations from which it is distinguished from the stated one.
const CERTAIN: f64 = 3.0;

/// Those that are far away, by name.
pub(super) fn far_from_stated(
    experiment: &Experiment,
    whole: &Prepared,
    conclusion: &Conclusion,
) -> Result<Vec<SetUpFinding>, SimulateError> {
    let fit = &conclusion.after.fit;
    let kind = fit.model.kind;
    // Masses and dashpots may be stated in any way: residuals depend on them almost linearly.
    if kind != Kind::Servo {
        return Ok(Vec::new());
    }
    let fitted = quantities(fit);
    let mut found = Vec::new();
    for (name, stated) in experiment.model.baseline.parameters() {
        let Some(parameter) = kind.parameters().iter().find(|p| p.key == name) else { continue };
        let Some(quantity) = fitted.get(name).filter(|_| experiment.model.fits(name)) else { continue };
        // A value of the other sign has no logarithm.
        let away = (quantity.value / stated).ln().abs();
        let told = quantity.std.is_some_and(|std| (quantity.value - stated).abs() > CERTAIN * std);
        if told && (away.is_nan() || away >= FAR) {
            found.push(SetUpFinding::model_value(name, stated, quantity.value, quantity.std, parameter.unit));
        }
    }
    Ok(if found.is_empty() || is_needed(fit, whole)? { found } else { Vec::new() })
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
