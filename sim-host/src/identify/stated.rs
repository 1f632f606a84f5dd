//! The stated model fitted: from several starts, and within reach of what was stated.

use super::fit::{Effort, Fit};
use super::judge::score_from;
use super::model::{Model, Prior};
use super::prepare::Prepared;
use super::starts::with_binding_limit;
use crate::plant::model::Kind;
use crate::plant::simulate::SimulateError;

/// chi2 above which a fit from the stated values may have missed the best.
const POOR: f64 = 4.0;
/// Sum of squares that a start must gain to be worth it: three standard deviations of one parameter.
const GAINED: f64 = 9.0;
/// Change of a value, as a share of what was stated, that makes one think of missing physics first.
const FAR: f64 = 0.25;

/// Standard deviation of a stated value's logarithm: what a model that is of this table may be wrong by.
const EXPECTED: f64 = 0.25;

/// Expects the values that may be fitted near what was stated: a diagnosis asks what a model that is roughly right leaves out,
/// and left alone its values go to wherever they hide that best. Nothing is clamped: where the data say that a value is far
/// away, it goes there. Masses and dashpots, on which residuals depend almost linearly, are free.
pub(crate) fn expect_near_stated(model: &mut Model) {
    if model.kind != Kind::Servo {
        return;
    }
    for value in model.own.iter_mut().filter(|v| v.free && v.value != 0.0 && v.prior.is_none()) {
        let std = if value.positive { EXPECTED } else { EXPECTED * value.value.abs() };
        value.prior = Some(Prior { mean: value.coordinate(), std, lent: false });
        (value.low, value.high) = if value.positive {
            (value.value / WIDEST, value.value * WIDEST)
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        };
    }
}

/// Weighs what another recording determined against these runs as they deserve: its deviations allow for what a model leaves out, and a
/// fit takes all residuals for independent noise. Both count alike once the deviations are as many times smaller as the residuals are
/// larger than noise, and fewer than they seem for being alike.
pub(crate) fn weigh_determined(prepared: &mut Prepared) -> Result<(), SimulateError> {
    let determined = |value: &&mut super::model::Value| value.free && value.prior.is_some_and(|prior| !prior.lent);
    if prepared.model.values_mut().filter(determined).count() == 0 {
        return Ok(());
    }
    let fit = fit_stated(prepared)?;
    let colour = score_from(&fit, &prepared.fit)?.colour;
    let overstated = (fit.chi2() * colour).max(1.0).sqrt();
    for value in prepared.model.values_mut().filter(determined) {
        value.prior = value.prior.map(|prior| Prior { std: prior.std / overstated, ..prior });
    }
    Ok(())
}

/// Factor by which a positive value may differ from what was stated: a unit's worth.
const WIDEST: f64 = 1e3;

/// The stated model with the values it lists in `fit`, fitted: from the stated values and, where those leave a misfit or a velocity
/// limit that these runs do not reach, from a limit at the largest speed seen, for a limit that is never reached has no slope to follow.
pub(crate) fn fit_stated(prepared: &Prepared) -> Result<Fit, SimulateError> {
    let runs = &prepared.fit;
    let mut fit = Fit::begin(prepared.model.clone(), runs)?;
    fit.improve(runs, Effort::FULL)?;
    let poor = fit.chi2() >= POOR;
    // What little a limit takes away bends no other value far: from those stated the limit would be bent instead.
    let from = if poor { &prepared.model } else { &fit.model };
    let Some(limited) = with_binding_limit(from, prepared.signal_scales.speed) else { return Ok(fit) };
    let mut other = if poor {
        Fit::begin(limited, runs)?
    } else if is_lower(&limited, from) {
        Fit::resume(limited, fit.locals.clone(), runs)?
    } else {
        return Ok(fit);
    };
    other.improve(runs, Effort::FULL)?;
    Ok(if other.squares < fit.squares - GAINED { other } else { fit })
}

/// Whether a value of the model's own is lower than in another.
fn is_lower(model: &Model, other: &Model) -> bool {
    model.own.iter().zip(&other.own).any(|(value, other)| value.value < other.value)
}

/// A model fitted with no stated value further than a quarter from what was stated, and held there from now on; none where
/// `free` went no further. A fit far from what was stated bends the model to hide what is missing; masses and dashpots may be stated in
/// any way.
pub(crate) fn fit_near(prepared: &Prepared, free: &Fit) -> Result<Option<Fit>, SimulateError> {
    let far = |(stated, fitted): (&super::model::Value, &super::model::Value)| {
        stated.free && (fitted.value - stated.value).abs() > FAR * stated.value.abs()
    };
    if prepared.model.kind != Kind::Servo || !prepared.model.own.iter().zip(&free.model.own).any(far) {
        return Ok(None);
    }
    let mut near = free.model.clone();
    for (value, stated) in near.own.iter_mut().zip(&prepared.model.own).filter(|(value, _)| value.free) {
        let reach = FAR * stated.value.abs();
        (value.low, value.high) = (stated.value - reach, stated.value + reach);
        value.value = value.value.clamp(value.low, value.high);
    }
    let mut fit = Fit::resume(near, free.locals.clone(), &prepared.fit)?;
    fit.improve(&prepared.fit, Effort { steps: 10, tolerance: 1e-4 })?;
    Ok(Some(fit))
}

/// The same, its values free again to go where the stated model's may.
pub(crate) fn fit_from_near(prepared: &Prepared, free: &Fit) -> Result<Option<Fit>, SimulateError> {
    let mut near = fit_near(prepared, free)?;
    if let Some(fit) = &mut near {
        fit.model.own = with_bounds_of(&fit.model, &prepared.model);
    }
    Ok(near)
}

fn with_bounds_of(model: &Model, other: &Model) -> Vec<super::model::Value> {
    let bounded = |(value, other): (&super::model::Value, &super::model::Value)| super::model::Value {
        low: other.low,
        high: other.high,
        ..*value
    };
    model.own.iter().zip(&other.own).map(bounded).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::fit::tests::{TRUTH, model, recorded};
    use crate::identify::model::SignalScales;

    /// A limit stated a fifth too high beside other values that are off, where what binds leaves little: nothing near the stated one binds.
    #[test]
    fn a_limit_that_is_stated_far_above_the_speeds_seen_is_found() {
        let limited = |limit: f64| model([TRUTH[0], TRUTH[1], TRUTH[2], limit]);
        let truth = FASTEST * fastest(&recorded(&limited(9.0), 1));
        let run = recorded(&limited(truth), 1);
        let signal_scales = SignalScales { speed: fastest(&run), ..SignalScales::TYPICAL };
        let prepared = Prepared {
            model: model([TRUTH[0], 1.05 * TRUTH[1], 1.18 * TRUTH[2], 1.22 * truth]),
            fit: vec![run],
            holdout: Vec::new(),
            signal_scales,
        };
        let mut alone = Fit::begin(prepared.model.clone(), &prepared.fit).unwrap();
        alone.improve(&prepared.fit, Effort::FULL).unwrap();
        let found = fit_stated(&prepared).unwrap();
        let off = |fit: &Fit| fit.model.own[3].value / truth - 1.0;
        assert!((1.1..POOR).contains(&alone.chi2()) && off(&alone) > 0.2, "chi2 {}, {}", alone.chi2(), off(&alone));
        assert!(found.chi2() < 1.05 && off(&found).abs() < 5e-3, "chi2 {}, {}", found.chi2(), off(&found));
    }

    /// Share of the largest speed of a run without a limit.
    const FASTEST: f64 = 0.97;

    fn fastest(run: &crate::identify::data::Run) -> f64 {
        let moved = |w: &[f64]| (w[4] - w[0]).abs() / (4.0 * run.dt);
        run.measured[0].values.windows(5).map(moved).fold(0.0, f64::max)
    }
}
