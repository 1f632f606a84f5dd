//! What the library does not hold, modelled: the curve that predicts best, in the coordinate it follows.

use super::finish::without;
use super::judged::{ScoredModel, explains_a_channel};
use super::split::Weighing;
use crate::identify::fit::{Effort, Fit};
use crate::identify::judge::gains;
use crate::identify::model::{ModelEffect, Prior, SignalScales};
use crate::plant::effects::{Entry, Role, remainder};
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;
use serde::Serialize;

/// Share of what is left that a curve must take away on the hold-out runs.
const WORTH: f64 = 0.15;
/// Most of its gain that blocks may lose elsewhere.
const LOST: f64 = 0.5;
/// A first look at a curve, and how far the best are taken.
const LOOK: Effort = Effort { steps: 4, tolerance: 1e-3 };
const FULL: Effort = Effort { steps: 10, tolerance: 1e-4 };
/// Share of what the best curve alone leaves that names beside a curve must leave at most to be needed.
const NEEDED: f64 = 0.4;
/// Curves that are taken further than a look.
const FINALISTS: usize = 3;
/// Share of a curve's variation at which one simple term stands for it.
const SIMPLE: f64 = 0.9;

/// A curve through what the library leaves.
#[derive(Debug, Clone, Serialize)]
pub struct ResidualCurve {
    /// Its identifier in a model file.
    pub id: &'static str,
    /// Its equation and, where one simple term stands for it, that term.
    pub equation: String,
    /// Place of each knot and height of the curve there.
    pub knots: Vec<(f64, f64)>,
    /// Unit of the places.
    pub place_unit: &'static str,
    /// Unit of the heights.
    pub height_unit: &'static str,
    /// Effects of the library that stand beside it.
    pub beside: Vec<&'static str>,
    /// Share of the stated model's excess over the noise floor that it takes away, effects beside it included.
    pub share: f64,
}

/// A curve with the model that holds it, as judged on the hold-out runs.
#[derive(Debug, Clone)]
pub(super) struct Curved {
    /// What is reported.
    pub(super) remainder: ResidualCurve,
    /// The model.
    pub(super) judged: ScoredModel,
    /// True where the effects beside the curve cannot be left to it: without them the best curve leaves far more.
    pub(super) names_needed: bool,
    /// The curve that came second, for the test that would tell the two apart.
    pub(super) rival: Option<Fit>,
}

/// Fits every curve beside the best model the library has and keeps the one that predicts best; none where no curve helps.
pub(super) fn remainder(
    weighing: &Weighing,
    before: &ScoredModel,
    best: &ScoredModel,
) -> Result<Option<Curved>, SimulateError> {
    let kind = best.fit.model.kind;
    let curves: Vec<&'static Entry> = remainder::entries().filter(|e| e.kinds.contains(&kind)).collect();
    // An effect that explains a part by chance stands in the curve's way: each is tried without it too.
    let parents = [best, before].into_iter().take(if best.added.is_empty() { 1 } else { 2 });
    let starts: Vec<(&ScoredModel, &'static Entry)> =
        parents.flat_map(|p| curves.iter().map(move |&e| (p, e))).collect();
    let looked =
        |&(parent, entry): &(&ScoredModel, &'static Entry)| -> Result<Option<(Fit, Vec<&'static str>)>, SimulateError> {
            let Some(placed) = placed(entry, &weighing.signal_scales()) else { return Ok(None) };
            let mut fit = Fit::resume(parent.fit.model.with(placed), parent.fit.locals.clone(), weighing.fitted())?;
            fit.improve(weighing.fitted(), LOOK)?;
            Ok(Some((fit, parent.added.clone())))
        };
    let looks = starts.par_iter().map(looked).collect::<Result<Vec<_>, _>>()?;
    let mut looks: Vec<_> = looks.into_iter().flatten().collect();
    looks.sort_by(|a, b| a.0.squares.total_cmp(&b.0.squares));
    // The best curve that stands alone is taken along: whether the names beside a curve are needed is asked of it.
    let alone = looks.iter().position(|(_, added)| added.is_empty()).filter(|&i| i >= FINALISTS);
    let alone = alone.map(|i| looks.swap_remove(i));
    looks.truncate(FINALISTS);
    looks.extend(alone);
    let fitted = |(mut fit, added): (Fit, Vec<&'static str>)| -> Result<ScoredModel, SimulateError> {
        fit.improve(weighing.fitted(), FULL)?;
        Ok(ScoredModel { added, ..ScoredModel::of(fit, weighing)? })
    };
    let mut all = looks.into_par_iter().map(fitted).collect::<Result<Vec<_>, _>>()?;
    all.sort_by(|a, b| a.hold.chi2.total_cmp(&b.hold.chi2));
    let alone = all.iter().filter(|j| j.added.is_empty() && j.hold.chi2 < before.hold.chi2);
    let alone = alone.min_by(|a, b| a.hold.chi2.total_cmp(&b.hold.chi2)).unwrap_or(before);
    let names_needed = all.first().map_or(Ok(false), |best| names_needed(weighing, best, alone))?;
    let mut all = all.into_iter();
    let Some(judged) = all.next() else { return Ok(None) };
    let (better, worse) = gains(&best.hold.blocks, &judged.hold.blocks);
    let left = (best.hold.chi2 - 1.0).max(0.0);
    if best.hold.chi2 - judged.hold.chi2 < WORTH * left || worse > LOST * better {
        return Ok(None);
    }
    let rival = all.next().map(|second| second.fit);
    Ok(described(before, &judged).map(|remainder| Curved { remainder, judged, names_needed, rival }))
}

/// Whether the effects beside a curve or an equation cannot be left to it: without them it leaves far more, fitted on from where it
/// stands as well as found anew (`alone`); in all, or nearly all of what one channel lacks.
pub(super) fn names_needed(
    weighing: &Weighing,
    judged: &ScoredModel,
    alone: &ScoredModel,
) -> Result<bool, SimulateError> {
    let left = |judged: &ScoredModel| (judged.hold.chi2 - 1.0).max(0.0);
    let in_all = |less: &ScoredModel| left(judged) < NEEDED * left(less);
    let needed = |less: &ScoredModel| in_all(less) || explains_a_channel(less, judged).is_some();
    if judged.added.is_empty() || !needed(alone) {
        return Ok(false);
    }
    let less = without(judged, &judged.added, weighing)?;
    Ok(needed(&less))
}

/// A curve at zero, its knots held loosely to it: what no run reaches stays there.
fn placed(entry: &'static Entry, signal_scales: &SignalScales) -> Option<ModelEffect> {
    let mut placed = ModelEffect::start(entry, 0, signal_scales)?;
    for value in placed.values.iter_mut().filter(|v| v.free) {
        value.prior = Some(Prior { mean: 0.0, std: value.high, lent: false });
    }
    Some(placed)
}

fn described(before: &ScoredModel, judged: &ScoredModel) -> Option<ResidualCurve> {
    let curve = judged.fit.model.effects.iter().find(|p| remainder::entries().any(|e| e.id == p.entry.id))?;
    let (span, heights) = curve.values.split_first()?;
    let places = remainder::places(curve.entry.id, span.value)?;
    let knots: Vec<(f64, f64)> = places.into_iter().zip(heights.iter().map(|v| v.value)).collect();
    let unit = |role| curve.entry.parameters.iter().find(|p| p.role == role).map_or("1", |p| p.unit);
    let term = simple(&knots).map_or_else(|| ", straight between the knots".into(), |term| format!(", about {term}"));
    Some(ResidualCurve {
        id: curve.entry.id,
        equation: format!("{}{term}", curve.entry.equation),
        knots,
        place_unit: unit(Role::Given),
        height_unit: unit(Role::Shared),
        beside: judged.added.clone(),
        share: 1.0 - (judged.hold.chi2 - 1.0) / (before.hold.chi2 - 1.0).max(1e-9),
    })
}

/// The one term, beside a constant, that stands for a curve; none where it takes more.
fn simple(knots: &[(f64, f64)]) -> Option<String> {
    const TERMS: [(&str, fn(f64) -> f64); 5] =
        [("s", |s| s), ("s^2", |s| s * s), ("s |s|", |s| s * s.abs()), ("s^3", |s| s * s * s), ("sign s", f64::signum)];
    let n = knots.len() as f64;
    let mean = |of: &dyn Fn(f64, f64) -> f64| knots.iter().map(|&(s, y)| of(s, y)).sum::<f64>() / n;
    let height = mean(&|_, y| y);
    let variance = mean(&|_, y| (y - height).powi(2));
    let fit = |(name, term): (&'static str, fn(f64) -> f64)| {
        let level = mean(&|s, _| term(s));
        let slope = mean(&|s, y| (term(s) - level) * (y - height)) / mean(&|s, _| (term(s) - level).powi(2));
        let left = mean(&|s, y| (y - height - slope * (term(s) - level)).powi(2));
        (1.0 - left / variance.max(f64::MIN_POSITIVE), format!("{:.4} {slope:+.4} {name}", height - slope * level))
    };
    let best = TERMS.into_iter().map(fit).filter(|(r2, _)| r2.is_finite()).max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > SIMPLE).then_some(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_that_is_one_term_is_printed_as_that_term() {
        let knots = |of: fn(f64) -> f64| (-4..=4).map(|i| (f64::from(i), of(f64::from(i)))).collect::<Vec<_>>();
        assert_eq!(simple(&knots(|s| 2.0 * s * s.abs())).unwrap(), "0.0000 +2.0000 s |s|");
        assert_eq!(simple(&knots(|s| 1.0 - 0.5 * s)).unwrap(), "1.0000 -0.5000 s");
        assert_eq!(simple(&knots(|s| (2.0 * s).sin())), None);
    }
}
