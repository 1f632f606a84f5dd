//! What speaks for one model against another.

use super::decide::Judged;
use crate::identify::model::Value;
use crate::identify::prepare::Prepared;
use crate::plant::model::Kind;

/// What a parameter has to earn, as twice a log likelihood, and beside it the share of the misfit that the best model leaves.
const PRICE: f64 = 10.0;
const PARAMETER: f64 = 0.12;
/// Samples over which a misfit's error is alike.
const ALIKE: f64 = 20.0;
/// Share of the stated model's excess that the right equation in its simple form may leave: less is no evidence.
const FORM: f64 = 2e-4;
/// Standard deviation of a stated value that may be fitted, as a share of it.
const STATED: f64 = 0.2;

/// What speaks for a model: its likelihood, the noise's size unknown, on the runs fitted and on those held back, less what its
/// parameters cost. A misfit is no white noise: samples count once for every stretch over which what even the best model
/// leaves is alike, or the kind of runs that all models miss most would drown the kind that tells them apart. And no equation is
/// the table's own: what a simple form may leave counts as noise.
pub(super) struct Ranking<'a> {
    parameter: f64,
    alike: [f64; 2],
    form: [f64; 2],
    stated: &'a [Value],
}

impl<'a> Ranking<'a> {
    /// Among these models of what was prepared, of which the stated one, refitted, leaves what it leaves.
    pub(super) fn new<'b>(
        prepared: &'a Prepared,
        before: &Judged,
        models: impl IntoIterator<Item = &'b Judged>,
    ) -> Self {
        let form = before.kinds().map(|(chi2, _)| FORM * (chi2 - 1.0).max(0.0));
        let mut least = [(f64::INFINITY, 0.0); 2];
        for judged in models {
            for (least, ((chi2, rows), form)) in least.iter_mut().zip(judged.kinds().into_iter().zip(form)) {
                *least = (least.0.min(chi2 + form), rows);
            }
        }
        let misfit = least.map(|(chi2, _)| if chi2.is_finite() { (1.0 - 1.0 / chi2).max(0.0) } else { 0.0 });
        let alike = misfit.map(|misfit| 1.0 + misfit * ALIKE);
        let lost = |i: usize| PARAMETER * misfit[i] * least[i].1 / alike[i];
        // Masses and dashpots may be stated in any way: residuals depend on them almost linearly.
        let stated = if prepared.model.kind == Kind::Servo { prepared.model.own.as_slice() } else { &[] };
        Self { parameter: PRICE + lost(0) + lost(1), alike, form, stated }
    }

    /// Twice the logarithm of what speaks against it.
    pub(super) fn cost(&self, judged: &Judged) -> f64 {
        self.misfit(judged) + self.parameter * parameters(judged)
    }

    /// The same with no more of a price than what a parameter gains by chance.
    pub(super) fn bare_cost(&self, judged: &Judged) -> f64 {
        self.misfit(judged) + 2.0 * parameters(judged)
    }

    fn misfit(&self, judged: &Judged) -> f64 {
        let each = judged.kinds().into_iter().zip(self.alike).zip(self.form);
        let misfit: f64 = each.map(|(((chi2, rows), alike), form)| rows / alike * (chi2 + form).ln()).sum();
        misfit + self.disbelief(&judged.fit.model.own)
    }

    /// How far the stated values had to go.
    fn disbelief(&self, fitted: &[Value]) -> f64 {
        let known = self.stated.iter().zip(fitted).filter(|(stated, _)| stated.free && stated.value != 0.0);
        known.map(|(stated, fitted)| ((fitted.value / stated.value - 1.0) / STATED).powi(2)).sum()
    }
}

/// Parameters that were fitted.
pub(super) fn parameters(judged: &Judged) -> f64 {
    judged.fit.model.values().filter(|v| v.free).count() as f64
}
