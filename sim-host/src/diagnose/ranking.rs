//! What speaks for one model against another.

use super::calibration::CALIBRATION;
use super::judged::{ScoredModel, parameters};

/// What speaks for a model: its likelihood on training and on validation where the size of what its equations leave is
/// unknown, less what its parameters cost.
///
/// No equation is the table's own. A true effect in a simple form leaves a share of what it explains, and of how large a share
/// nothing is known but that it may be of any order. So what a model leaves beyond the noise has a variance that is unknown
/// with so many degrees of freedom ([`super::calibration::Calibration::form_freedom`]), and the likelihood is Student's: within the
/// noise squares count as they do for normal residuals; beyond it ratios of what is left count, and the thousands of samples
/// that show a ratio well make it no more telling. Each channel
/// of the validation has a share of the say, whatever its noise was said to be: what explains a displacement and spoils the pressure is
/// not what is there.
///
/// Source: K. L. Lange, R. J. A. Little, J. M. G. Taylor, "Robust statistical modeling using the t distribution", Journal of
/// the American Statistical Association 84 (1989) 881-896; for the term of the model's own error: M. C. Kennedy, A. O'Hagan,
/// "Bayesian calibration of computer models", Journal of the Royal Statistical Society B 63 (2001) 425-464.
pub(super) struct Ranking {
    /// What is compared, in the order of [`looks`]: the least that any model leaves, what counts as nothing, and its say.
    floors: Vec<f64>,
    forms: Vec<f64>,
    /// By how much neighbouring residuals that are alike overstate their number, by the model that leaves the least: what makes a
    /// misfit's residuals alike is no noise.
    colour: f64,
}

/// One comparison: mean square, residuals behind it, and its share of the say.
fn looks(judged: &ScoredModel) -> impl Iterator<Item = (f64, f64, f64)> {
    let [training, _] = judged.kinds();
    let say = 1.0 / judged.hold.channels.len().max(1) as f64;
    let channels = judged.hold.channels.iter().map(move |&(_, chi2, rows)| (chi2, rows as f64, say));
    std::iter::once((training.0, training.1, 1.0)).chain(channels)
}

impl Ranking {
    /// Among these models of an experiment, of which the stated one, refitted, leaves what it leaves.
    pub(super) fn new<'a>(before: &ScoredModel, models: impl IntoIterator<Item = &'a ScoredModel>) -> Self {
        let forms = looks(before).map(|(chi2, ..)| CALIBRATION.form_least * (chi2 - 1.0).max(0.0)).collect();
        let mut floors: Vec<f64> = looks(before).map(|(chi2, ..)| chi2.min(1.0)).collect();
        let mut colour = before.hold.colour;
        for judged in models {
            colour = colour.min(judged.hold.colour);
            for (floor, (chi2, ..)) in floors.iter_mut().zip(looks(judged)) {
                *floor = floor.min(chi2);
            }
        }
        Self { floors, forms, colour: colour.max(1.0) }
    }

    /// Twice the logarithm of what speaks against it.
    pub(super) fn cost(&self, judged: &ScoredModel) -> f64 {
        self.least(judged, CALIBRATION.parameter_price)
    }

    /// Puts models in order, the one that least speaks against first.
    pub(super) fn sort(&self, models: &mut Vec<ScoredModel>) {
        let mut costed: Vec<(f64, ScoredModel)> = models.drain(..).map(|judged| (self.cost(&judged), judged)).collect();
        costed.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        models.extend(costed.into_iter().map(|(_, judged)| judged));
    }

    /// What speaks against a model with no more of a price than what a parameter gains by chance.
    pub(super) fn bare_cost(&self, judged: &ScoredModel) -> f64 {
        self.least(judged, 2.0)
    }

    /// The least that speaks against a model at this price of a parameter, its details of form fitted or not.
    fn least(&self, judged: &ScoredModel, price: f64) -> f64 {
        let own = self.misfit(judged) + price * parameters(judged);
        judged.plainer.as_deref().map_or(own, |plainer| own.min(self.least(plainer, price)))
    }

    fn misfit(&self, judged: &ScoredModel) -> f64 {
        let [(_, fitted), _] = judged.kinds();
        judged.departure.least(|squares| {
            // What a value put back leaves lies where the mismatch lies: as much as there on the runs fitted, and in proportion elsewhere.
            let more = squares / fitted.max(1.0);
            let scale = self.forms.first().filter(|form| **form > 0.0);
            let each = looks(judged).zip(&self.floors).zip(&self.forms);
            each.map(|(((chi2, rows, say), floor), form)| {
                // Excess that the noise of so many samples makes as likely as not.
                let chance = CALIBRATION.form_freedom * self.colour * floor / rows.max(1.0);
                let here = chi2 + more * scale.map_or(1.0, |scale| form / scale);
                say * against((here - floor).max(0.0), chance.max(f64::MIN_POSITIVE), *form)
            })
            .sum()
        })
    }
}

/// Twice the logarithm of what speaks against a model that leaves an excess of chi2, of which `chance` makes as much as likely as not and
/// a simple form of a gross effect `form`. Below that nothing is known of what a form leaves but that it may be of any order: its
/// logarithm is as likely everywhere, down to what noise is not known better than.
fn against(excess: f64, chance: f64, form: f64) -> f64 {
    let wide = chance + form;
    let least = chance.max(CALIBRATION.negligible).min(wide);
    CALIBRATION.form_freedom * (excess / wide).ln_1p() + 2.0 * ((excess / least).ln_1p() - (excess / wide).ln_1p())
}

#[cfg(test)]
mod tests;
