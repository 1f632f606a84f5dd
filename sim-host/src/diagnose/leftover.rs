//! What a model leaves: whether it follows the motion, and the noise that it is where it does not.

use super::calibration::CALIBRATION;
use super::judged::{Decision, ScoredModel};
use super::split::Weighing;
use super::structure::{Structure, structures};
use crate::identify::data::{Channel, Run};
use crate::identify::evaluate::{Predicted, predict};
use crate::identify::judge::Score;
use crate::plant::simulate::SimulateError;
use crate::recording::SetUpFinding;

/// What is more than one half is the larger part.
pub(super) const LARGER_PART: f64 = 0.5;

impl Decision {
    /// These effects as they were weighed, with nothing beside them.
    pub(super) fn weighed(&self, names: &[&'static str]) -> impl Iterator<Item = &ScoredModel> {
        self.candidates.iter().chain(&self.partial).filter(move |judged| judged.added == names)
    }

    /// True where these effects alone, without what was found beside them, predict more than the stated model.
    pub(super) fn explain_a_part(&self, names: &[&'static str]) -> bool {
        let left = |judged: &ScoredModel| (judged.hold.chi2 - 1.0).max(0.0);
        self.weighed(names).any(|judged| left(judged) < left(&self.stated))
    }

    /// Names effects that explain a part and cannot be left to a curve; more is missing beside them.
    pub(super) fn name_beside_more(&mut self, names: &[&'static str]) {
        let same = |c: &ScoredModel| c.added == names;
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

/// True where named effects leave more than a negligible excess of chi2 and the simplicity of their equations, which is a share of the
/// excess that they account for, `accounted`; `noise` of what is left is the noise of channels that follow nothing. What is left beyond
/// any noise is held against what the stated model leaves once it is fitted: of that the names must explain most.
pub(super) fn more_is_missing(before: &ScoredModel, after: &ScoredModel, accounted: f64, noise: f64) -> bool {
    let left = (after.hold.chi2 - 1.0 - noise).max(0.0);
    let of = if left > CALIBRATION.modest - 1.0 { before.hold.chi2 - 1.0 } else { accounted };
    !after.added.is_empty() && left > CALIBRATION.negligible && left > CALIBRATION.simple * (of - noise).max(1e-9)
}

/// Which channels of what a model leaves follow the motion.
pub(super) struct Followed {
    pub(super) structures: Vec<(Channel, Structure)>,
    /// Channels whose noise nobody states.
    pub(super) estimated: Vec<Channel>,
    /// What the model leaves of each channel on the runs fitted, chi2, where other runs are looked at.
    pub(super) fitted: Vec<(Channel, f64)>,
}

impl Followed {
    /// Of runs and their predictions.
    pub(super) fn of(runs: &[Run], predicted: &[Predicted]) -> Self {
        let measured = runs.iter().flat_map(|run| &run.measured);
        let estimated = measured.filter(|m| m.judged && m.stated.is_none()).map(|m| m.channel).collect();
        Self { structures: structures(runs, predicted), estimated, fitted: Vec::new() }
    }

    /// The same of runs held out, beside what the model leaves of those fitted: a noise that was stated too small is too small there too.
    pub(super) fn beside(self, fitted: &Score) -> Self {
        Self { fitted: fitted.channels.iter().map(|&(channel, chi2, _)| (channel, chi2)).collect(), ..self }
    }

    /// True where what is left is no larger than noise may be: what follows the motion or not is then physics or noise.
    pub(super) fn is_modest(&self, judged: &ScoredModel) -> bool {
        let overall = judged.hold.chi2.max(judged.fit.chi2());
        let within = |(channel, chi2, _): &(Channel, f64, usize)| *chi2 < self.most(*channel);
        overall < CALIBRATION.modest || (overall < CALIBRATION.unstated && judged.hold.channels.iter().all(within))
    }

    /// chi2 of a channel up to which what follows nothing is its noise.
    fn most(&self, channel: Channel) -> f64 {
        let most = if self.estimated.contains(&channel) { CALIBRATION.unstated } else { CALIBRATION.modest };
        let fitted = self.fitted.iter().find(|(known, _)| *known == channel);
        fitted.map_or(most, |(_, chi2)| most.min(CALIBRATION.modest * chi2.max(1.0)))
    }

    /// True where something follows the motion beyond doubt.
    pub(super) fn is_certain(&self) -> bool {
        self.structures.iter().any(|(_, structure)| structure.is_certain())
    }

    /// True where what is left of a channel follows the motion beyond doubt.
    fn is_certain_of(&self, channel: Channel) -> bool {
        self.structures.iter().any(|(of, structure)| *of == channel && structure.is_certain())
    }

    /// True where one channel is left beyond any noise, follows the motion beyond doubt, and is no better than half explained: what another
    /// channel owes to the names does not make up for it.
    pub(super) fn leaves_a_channel(&self, before: &ScoredModel, after: &ScoredModel) -> bool {
        let lacked = |channel| before.hold.chi2_of(channel).unwrap_or(1.0);
        after.hold.channels.iter().any(|&(channel, chi2, _)| {
            chi2 > self.most(channel)
                && chi2 - 1.0 > LARGER_PART * (lacked(channel) - 1.0)
                && self.is_certain_of(channel)
        })
    }

    /// Excess of chi2 that lies in channels of which nothing follows the motion, where it is modest: their noise was stated too small.
    pub(super) fn noise(&self, judged: &ScoredModel) -> f64 {
        let excess = |(channel, chi2, rows): (Channel, f64, usize)| {
            let known = self.structures.iter().any(|(of, structure)| *of == channel && !structure.is_certain());
            if known && chi2 < self.most(channel) { (chi2 - 1.0).max(0.0) * rows as f64 } else { 0.0 }
        };
        judged.hold.counted().map(excess).sum::<f64>() / judged.hold.samples.max(1) as f64
    }
}

/// What of a model's residuals follows the motion, on all runs at hand.
pub(super) fn follows(weighing: &Weighing, judged: &ScoredModel) -> Result<Followed, SimulateError> {
    let mut runs = weighing.fitted().to_vec();
    let fitted = runs.iter().zip(&judged.fit.locals).map(|(run, local)| predict(&judged.fit.model, run, local));
    let mut predicted = fitted.collect::<Result<Vec<_>, _>>()?;
    runs.extend(weighing.weighed().iter().cloned());
    predicted.extend(judged.hold.predicted.iter().cloned());
    Ok(Followed::of(&runs, &predicted))
}

/// The noise that stands for what a model leaves in the channels of which nothing follows the motion; a negligible excess of chi2 is
/// none.
pub(super) fn larger_noise(weighing: &Weighing, judged: &ScoredModel, follows: &Followed) -> Vec<SetUpFinding> {
    let runs = weighing.weighed();
    let mut findings: Vec<SetUpFinding> = Vec::new();
    let channels = runs.first().map(super::residual::judged_channels).unwrap_or_default();
    for channel in channels.into_iter().filter(|channel| !follows.is_certain_of(*channel)) {
        let (mut squares, mut count, mut stated) = (0.0, 0.0, 0.0);
        for (run, predicted) in runs.iter().zip(&judged.hold.predicted) {
            let residual = super::residual::residual(run, predicted, channel).unwrap_or_default();
            squares += residual.iter().filter(|r| r.is_finite()).map(|r| r * r).sum::<f64>();
            count += residual.iter().filter(|r| r.is_finite()).count() as f64;
            stated = run.channel(channel).map_or(stated, |m| m.noise);
        }
        let factor = (squares / f64::max(count, 1.0)).sqrt();
        if factor > 1.0 + CALIBRATION.negligible / 2.0 {
            let (found, std) = (stated * factor, stated * factor / (2.0 * f64::max(count, 1.0)).sqrt());
            findings.push(SetUpFinding::noise(channel.name(), stated, found, std, channel.unit()));
        }
    }
    findings
}
