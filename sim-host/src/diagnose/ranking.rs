//! What speaks for one model against another.

use super::decide::Judged;

/// What a parameter has to earn, as twice a log likelihood, and beside it the share of the misfit that the best model leaves.
const PRICE: f64 = 10.0;
const PARAMETER: f64 = 0.12;
/// Samples over which a misfit's error is alike.
const ALIKE: f64 = 20.0;

/// What speaks for a model: its likelihood, the noise's size unknown, on the runs fitted and on those held back, less what its
/// parameters cost. A misfit is no white noise: samples count once for every stretch over which what even the best model
/// leaves is alike, or the kind of runs that all models miss most would drown the kind that tells them apart.
pub(super) struct Ranking {
    parameter: f64,
    alike: [f64; 2],
}

impl Ranking {
    /// Among these models.
    pub(super) fn new<'a>(models: impl IntoIterator<Item = &'a Judged>) -> Self {
        let mut least = [(f64::INFINITY, 0.0); 2];
        for judged in models {
            for (least, (chi2, rows)) in least.iter_mut().zip(judged.kinds()) {
                *least = (least.0.min(chi2), rows);
            }
        }
        let misfit = least.map(|(chi2, _)| if chi2.is_finite() { (1.0 - 1.0 / chi2).max(0.0) } else { 0.0 });
        let alike = misfit.map(|misfit| 1.0 + misfit * ALIKE);
        let lost = |i: usize| PARAMETER * misfit[i] * least[i].1 / alike[i];
        Self { parameter: PRICE + lost(0) + lost(1), alike }
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
        judged.kinds().iter().zip(self.alike).map(|((chi2, rows), alike)| rows / alike * chi2.ln()).sum()
    }
}

/// Parameters that were fitted.
pub(super) fn parameters(judged: &Judged) -> f64 {
    judged.fit.model.values().filter(|v| v.free).count() as f64
}
