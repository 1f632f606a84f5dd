//! What changed on a table between two dates: the same model fitted to both experiments, number by number.
//!
//! A difference is judged by the deviation that the stretches of both experiments tell together, against a threshold that all
//! numbers share, so that of a thousand pairs of the same table about one shows anything (Bonferroni).

use super::covariance::Variance;
use super::interval::NINETY;
use super::outcome::{Identified, IdentifyError, identify};
use super::quantity::Quantity;
use crate::recording::Experiment;
use serde::Serialize;
use std::collections::BTreeMap;

/// Chance that anything is reported changed on a table that is the same.
const FALSE_ALARM: f64 = 0.001;

/// One number on both dates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Change {
    /// Its name: `b0`, `coulomb_friction.force`.
    pub name: String,
    /// Unit.
    pub unit: &'static str,
    /// Before.
    pub before: f64,
    /// After.
    pub after: f64,
    /// After less before, in its unit.
    pub difference: f64,
    /// Lower end of the difference's 90 % interval; none where the data do not bound it.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// The difference as a share of what was before; none where that is zero.
    pub share: Option<f64>,
    /// Whether it differs by more than chance allows; none where one of the two is not determined.
    pub changed: Option<bool>,
}

/// Why two experiments cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// One of the fits.
    #[error("{experiment}: {problem}")]
    Fit {
        /// Which.
        experiment: String,
        /// Its problem.
        problem: IdentifyError,
    },
    /// They do not fit the same numbers.
    #[error(
        "the first fits {before}, the second {after}; give both the same `kind`, `effects` and `fit`, so that each number has its like"
    )]
    Unlike {
        /// Numbers of the first.
        before: String,
        /// Numbers of the second.
        after: String,
    },
}

/// Fits both experiments and compares their numbers, those surest to have changed first. Where an experiment names nothing in
/// `fit`, all that its model states is fitted.
pub fn compare(before: &Experiment, after: &Experiment) -> Result<Vec<Change>, CompareError> {
    let (before, after) = (fitted(before)?, fitted(after)?);
    let names = |found: &Identified| found.quantities.keys().cloned().collect::<Vec<_>>();
    if names(&before) != names(&after) {
        let spelled = |found: &Identified| names(found).join(", ");
        return Err(CompareError::Unlike { before: spelled(&before), after: spelled(&after) });
    }
    Ok(changes(&before, &after))
}

fn fitted(experiment: &Experiment) -> Result<Identified, CompareError> {
    let mut all = experiment.clone();
    if all.model.fit.is_empty() {
        let own = all.model.baseline.parameters().into_iter().map(|(name, _)| name.to_owned());
        all.model.fit = own.chain(all.model.effects.iter().map(|e| e.id.clone())).collect();
    }
    identify(&all).map_err(|problem| CompareError::Fit { experiment: experiment.name.clone(), problem })
}

fn changes(before: &Identified, after: &Identified) -> Vec<Change> {
    let pairs: Vec<_> = before.quantities.iter().zip(after.quantities.values()).collect();
    let threshold = normal_quantile(1.0 - FALSE_ALARM / (2.0 * pairs.len().max(1) as f64));
    let pooled = pooled(before, after);
    let judged = |((name, b), a): ((&String, _), _)| {
        change(name, (b, a), pooled.get(name.as_str()).copied().unwrap_or(1.0), threshold)
    };
    let mut rated: Vec<(f64, Change)> = pairs.into_iter().map(judged).collect();
    rated.sort_by(|(x, _), (y, _)| y.total_cmp(x));
    rated.into_iter().map(|(_, change)| change).collect()
}

/// The deviation of each number's difference that both fits tell together, as a share of what their own add up to: each own one is the larger
/// of two estimates and widened for its few stretches, and so is the sum of two twice over.
fn pooled(before: &Identified, after: &Identified) -> BTreeMap<String, f64> {
    let (Some(b), Some(a)) = (before.fit.variances(), after.fit.variances()) else { return BTreeMap::new() };
    let model = &before.fit.model;
    let free = model.names().into_iter().zip(model.values()).filter(|(_, value)| value.free).map(|(name, _)| name);
    let share = |(b, a): (Variance, Variance)| (b.with(a).honest() / (b.honest() + a.honest())).sqrt();
    free.zip(b.into_iter().zip(a).map(share)).collect()
}

/// A change with how many deviations it is.
fn change(name: &str, (before, after): (&Quantity, &Quantity), pooled: f64, threshold: f64) -> (f64, Change) {
    let difference = after.value - before.value;
    let root = |a: Option<f64>, b: Option<f64>| Some(pooled * a?.hypot(b?));
    let below = |q: &Quantity| q.low.map(|low| q.value - low);
    let above = |q: &Quantity| q.high.map(|high| high - q.value);
    let (down, up) = (root(below(after), above(before)), root(above(after), below(before)));
    // The arm of the interval that reaches towards no difference.
    let arm = if difference > 0.0 { down } else { up };
    let deviations = arm.filter(|arm| *arm > 0.0).map(|arm| NINETY * difference.abs() / arm);
    let change = Change {
        name: name.to_owned(),
        unit: before.unit,
        before: before.value,
        after: after.value,
        difference,
        low: down.map(|arm| difference - arm),
        high: up.map(|arm| difference + arm),
        share: (before.value != 0.0).then(|| difference / before.value.abs()),
        changed: deviations.map(|d| d > threshold),
    };
    (deviations.unwrap_or(-1.0), change)
}

/// Abramowitz and Stegun, Handbook of Mathematical Functions (1964), 26.2.23: off by less than 4.5e-4.
fn normal_quantile(share: f64) -> f64 {
    let t = (-2.0 * (1.0 - share).max(1e-300).ln()).sqrt();
    t - (2.515_517 + t * (0.802_853 + t * 0.010_328)) / (1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quantity(value: f64, half: f64) -> Quantity {
        let (low, high) = (Some(value - half), Some(value + half));
        Quantity { value, std: Some(half / NINETY), low, high, unit: "1/s" }
    }

    #[test]
    fn the_quantile_is_the_tables() {
        for (share, value) in [(0.95, 1.6449), (0.995, 2.5758), (0.9995, 3.2905)] {
            assert!((normal_quantile(share) - value).abs() < 5e-4, "{share}");
        }
    }

    #[test]
    fn a_difference_within_both_intervals_is_no_change() {
        let judged = |a: f64, b: f64| change("a1", (&quantity(a, 1.645), &quantity(b, 1.645)), 1.0, 3.0).1;
        assert_eq!(judged(50.0, 54.0).changed, Some(false), "2.8 deviations");
        let far = judged(50.0, 55.0);
        assert_eq!(far.changed, Some(true), "3.5 deviations");
        assert!((far.high.unwrap() - 5.0 - 1.645 * 2f64.sqrt()).abs() < 1e-12 && far.share == Some(0.1));
        let open = change("a1", (&Quantity { high: None, ..quantity(50.0, 1.0) }, &quantity(40.0, 1.0)), 1.0, 3.0).1;
        assert!(open.low.is_none() && open.changed == Some(true), "what points towards no change is bounded: {open:?}");
    }
}
