//! What a model leaves: whether it follows the motion, and the noise that it is where it does not.

use super::calibration::CALIBRATION;
use super::judged::{Decision, Judged};
use super::split::Weighing;
use super::structure::{Structure, structure};
use crate::identify::evaluate::predict;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

impl Decision {
    /// True where these effects alone, without what was found beside them, foresee more than the stated model.
    pub(super) fn explain_a_part(&self, names: &[&'static str]) -> bool {
        let left = |judged: &Judged| (judged.hold.chi2 - 1.0).max(0.0);
        let mut known = self.candidates.iter().chain(&self.partial).filter(|judged| judged.added == names);
        known.any(|judged| left(judged) < left(&self.before))
    }

    /// Names effects that explain a part and cannot be left to a curve; more is missing beside them.
    pub(super) fn name_beside_more(&mut self, names: &[&'static str]) {
        let same = |c: &Judged| c.added == names;
        let others: f64 = self.candidates.iter().filter(|c| !same(c)).map(|c| c.probability).sum();
        let rest = (1.0 - CALIBRATION.beside_more) / (others + self.unlisted_probability).max(1e-9);
        for candidate in &mut self.candidates {
            candidate.probability =
                if same(candidate) { CALIBRATION.beside_more } else { rest * candidate.probability };
        }
        self.unlisted_probability *= rest;
        self.unlisted = false;
        self.more_missing = true;
        self.ties.clear();
    }
}

/// True where named effects leave more than noise, an excess of chi2 that is `negligible`, and the simplicity of their equations.
pub(super) fn more_is_missing(before: &Judged, after: &Judged, negligible: f64) -> bool {
    let left = (after.hold.chi2 - 1.0).max(0.0);
    let excess = (before.hold.chi2 - 1.0).max(1e-9);
    !after.added.is_empty() && left > negligible && left > CALIBRATION.simple * excess
}

/// What of a model's residuals follows the motion, on all runs at hand.
pub(super) fn follows(weighing: &Weighing, judged: &Judged) -> Result<Structure, SimulateError> {
    let mut runs = weighing.fitted().to_vec();
    let fitted = runs.iter().zip(&judged.fit.locals).map(|(run, local)| predict(&judged.fit.model, run, local));
    let mut predicted = fitted.collect::<Result<Vec<_>, _>>()?;
    runs.extend(weighing.weighed().iter().cloned());
    predicted.extend(judged.hold.predicted.iter().cloned());
    Ok(structure(&runs, &predicted))
}

/// The noise that stands for what a model leaves where that follows nothing, by channel; an excess of chi2 that is `negligible`
/// is none.
pub(super) fn larger_noise(weighing: &Weighing, judged: &Judged, negligible: f64) -> Vec<SetUpFinding> {
    let runs = weighing.weighed();
    let mut findings: Vec<SetUpFinding> = Vec::new();
    let channels = runs.first().map(super::residual::judged_channels).unwrap_or_default();
    for channel in channels {
        let (mut squares, mut count, mut stated) = (0.0, 0.0, 0.0);
        for (run, predicted) in runs.iter().zip(&judged.hold.predicted) {
            let residual = super::residual::residual(run, predicted, channel).unwrap_or_default();
            squares += residual.iter().filter(|r| r.is_finite()).map(|r| r * r).sum::<f64>();
            count += residual.iter().filter(|r| r.is_finite()).count() as f64;
            stated = run.channel(channel).map_or(stated, |m| m.noise);
        }
        let factor = (squares / f64::max(count, 1.0)).sqrt();
        if factor > 1.0 + negligible / 2.0 {
            let (found, std) = (stated * factor, stated * factor / (2.0 * f64::max(count, 1.0)).sqrt());
            findings.push(SetUpFinding::noise(channel.name(), stated, found, std, channel.unit()));
        }
    }
    findings
}
