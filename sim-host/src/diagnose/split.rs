//! Who sees which data: the runs that may be fitted are cut into stretches that fit hypotheses and stretches that weigh
//! them; the runs held out are seen by the verdict alone.
//!
//! Source: M. Stone, "Cross-validatory choice and assessment of statistical predictions", Journal of the Royal Statistical
//! Society B 36 (1974) 111-147; for stretches in place of single samples: P. Burman, E. Chow, D. Nolan, "A cross-validatory
//! method for dependent data", Biometrika 81 (1994) 351-358.

use super::residual::squares_in;
use crate::identify::data::Run;
use crate::identify::evaluate::Predicted;
use crate::identify::fit::Fit;
use crate::identify::judge::{Score, score, score_from};
use crate::identify::model::{Model, SignalScales};
use crate::identify::prepare::Prepared;
use crate::plant::simulate::SimulateError;

/// Length of a stretch, s: a loop forgets where it was within a few tenths of a second.
const STRETCH: f64 = 2.0;
/// Stretches of a run, at least: a motion that shows an effect once must show it to both kinds.
const STRETCHES: usize = 12;
/// One stretch of so many weighs.
const EVERY: usize = 3;

/// The stretches that hypotheses are fitted to.
#[derive(Debug, Clone)]
pub(crate) struct Training(Prepared);

/// The stretches that hypotheses are weighed on; where a run starts is estimated on them again.
#[derive(Debug, Clone)]
pub(crate) struct Validation(Vec<Run>);

/// The runs held out. There is one, it cannot be copied, and the verdict consumes it.
#[derive(Debug)]
pub(super) struct Test(Vec<Run>);

/// What hypotheses are fitted to and weighed on.
#[derive(Debug, Clone)]
pub(crate) struct Weighing {
    /// What fits them.
    pub training: Training,
    /// What weighs them.
    pub validation: Validation,
}

/// An experiment cut up.
#[derive(Debug)]
pub(super) struct Split {
    /// What hypotheses are fitted to and weighed on.
    pub(super) weighing: Weighing,
    /// Every sample that may be fitted, for the last fit.
    pub(super) whole: Prepared,
    /// What the verdict judges by.
    pub(super) test: Test,
}

impl Training {
    /// As what identification works on; it holds no run back.
    pub(crate) fn prepared(&self) -> &Prepared {
        &self.0
    }
}

impl Weighing {
    /// Of whole runs, for tests.
    #[cfg(test)]
    pub(super) fn of(training: Prepared, validation: Vec<Run>) -> Self {
        Self { training: Training(training), validation: Validation(validation) }
    }

    /// The stated model.
    pub(crate) fn model(&self) -> &Model {
        &self.training.0.model
    }

    /// Sizes of the signals.
    pub(crate) fn signal_scales(&self) -> SignalScales {
        self.training.0.signal_scales
    }

    /// The runs with the stretches that fit.
    pub(crate) fn fitted(&self) -> &[Run] {
        &self.training.0.fit
    }

    /// How a fitted model predicts the stretches that weigh.
    pub(super) fn score(&self, fit: &Fit) -> Result<Score, SimulateError> {
        let same = fit.locals.len() == self.weighed().len();
        if same { score_from(fit, self.weighed()) } else { score(&fit.model, self.weighed()) }
    }

    /// The runs with the stretches that weigh.
    pub(crate) fn weighed(&self) -> &[Run] {
        &self.validation.0
    }
}

impl Test {
    /// The runs that judge, given up, and whether they were held out: without one those fitted judge.
    pub(super) fn consume(self, whole: &Prepared) -> (Vec<Run>, bool) {
        if self.0.is_empty() { (whole.fit.clone(), false) } else { (self.0, true) }
    }
}

/// Cuts an experiment up; hypotheses are fitted to and weighed on the excerpt of it where there is one.
pub(super) fn split(prepared: Prepared, excerpt: Option<Prepared>) -> Split {
    let Prepared { model, fit, holdout, signal_scales } = prepared;
    let weighs = |i: usize| i % EVERY == EVERY - 2;
    let seen = excerpt.as_ref().map_or(&fit, |excerpt| &excerpt.fit);
    let training = seen.iter().map(|run| kept(run, |i| !weighs(i))).collect();
    let validation = seen.iter().map(|run| kept(run, weighs)).collect();
    let with = |fit: Vec<Run>| Prepared { model: model.clone(), fit, holdout: Vec::new(), signal_scales };
    Split {
        weighing: Weighing { training: Training(with(training)), validation: Validation(validation) },
        whole: with(fit),
        test: Test(holdout),
    }
}

/// What a stretch of a run held out is used for once half of them are opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Fits,
    Judges,
    Weighs,
}

/// The order in which these are dealt, half of them to the judge.
const DEALT: [Role; 6] = [Role::Fits, Role::Judges, Role::Weighs, Role::Judges, Role::Fits, Role::Judges];

/// The same experiment with half of the stretches of the runs held out among those that may be fitted: for physics that they
/// alone show, a stop that only the largest motion reaches. They are dealt by how much the model handed on, whose predictions
/// these are, misses in each, the largest first: a moment may be all that shows it, and fits need one such as the judge does.
///
/// `seen` is what hypotheses were fitted to so far, an excerpt of long recordings.
pub(super) fn reopened(whole: &Prepared, seen: Prepared, held_out: &[Run], predicted: &[Predicted]) -> Split {
    let mut whole = whole.clone();
    whole.holdout = Vec::new();
    let mut opened = split(whole, Some(seen));
    let missed: Vec<Vec<f64>> = held_out.iter().zip(predicted).map(|(run, p)| missed(run, p)).collect();
    for (run, roles) in held_out.iter().zip(dealt(&missed)) {
        let with = |wanted: &[Role]| kept(run, |i| roles.get(i).is_some_and(|role| wanted.contains(role)));
        opened.weighing.training.0.fit.push(with(&[Role::Fits]));
        opened.weighing.validation.0.push(with(&[Role::Weighs]));
        opened.whole.fit.push(with(&[Role::Fits, Role::Weighs]));
        opened.test.0.push(with(&[Role::Judges]));
    }
    let signal_scales = SignalScales::of(&opened.whole.fit, opened.whole.signal_scales.force);
    opened.whole.signal_scales = signal_scales;
    opened.weighing.training.0.signal_scales = signal_scales;
    opened
}

/// Squares of the residual of all judged channels in each stretch of a run.
fn missed(run: &Run, predicted: &Predicted) -> Vec<f64> {
    let length = stretch_length(run);
    squares_in(run, predicted, run.len().div_ceil(length), |k| k / length)
}

/// What each stretch of each run is used for.
fn dealt(missed: &[Vec<f64>]) -> Vec<Vec<Role>> {
    let places = missed.iter().enumerate().flat_map(|(run, stretches)| (0..stretches.len()).map(move |i| (run, i)));
    let mut places: Vec<(usize, usize)> = places.collect();
    places.sort_by(|a, b| missed[b.0][b.1].total_cmp(&missed[a.0][a.1]));
    let mut roles: Vec<Vec<Role>> = missed.iter().map(|stretches| vec![Role::Judges; stretches.len()]).collect();
    for ((run, stretch), role) in places.into_iter().zip(DEALT.iter().cycle()) {
        roles[run][stretch] = *role;
    }
    roles
}

/// Samples of a stretch.
pub(super) fn stretch_length(run: &Run) -> usize {
    ((STRETCH / run.dt) as usize).min(run.len() / STRETCHES).max(1)
}

/// A run of which only these stretches were measured.
fn kept(run: &Run, stretch: impl Fn(usize) -> bool) -> Run {
    let length = stretch_length(run);
    let mut run = run.clone();
    for measured in &mut run.measured {
        for (k, value) in measured.values.iter_mut().enumerate() {
            if !stretch(k / length) {
                *value = f64::NAN;
            }
        }
    }
    run
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::data::Channel;
    use crate::identify::fit::tests::{TRUTH, model, recorded};

    fn finite(run: &Run) -> Vec<usize> {
        let values = &run.measured[0].values;
        (0..run.len()).filter(|&k| values[k].is_finite()).collect()
    }

    /// No sample fits and weighs, none is lost, and what is held out is in neither.
    #[test]
    fn every_sample_has_one_use() {
        let runs: Vec<Run> = (1..4).map(|seed| recorded(&model(TRUTH), seed)).collect();
        let (fit, holdout) = (runs[..2].to_vec(), runs[2..].to_vec());
        let signal_scales = SignalScales::of(&fit, 1.0);
        let split = split(Prepared { model: model(TRUTH), fit, holdout, signal_scales }, None);
        for (i, run) in split.whole.fit.iter().enumerate() {
            let mut both = finite(&split.weighing.fitted()[i]);
            let weighed = finite(&split.weighing.weighed()[i]);
            assert!(weighed.iter().all(|k| !both.contains(k)));
            assert!(weighed.len() * 5 > run.len() && both.len() > run.len() / 2);
            both.extend(weighed);
            both.sort_unstable();
            assert_eq!(both, finite(run));
        }
        let (judging, held_out) = split.test.consume(&split.whole);
        assert!(held_out && judging.len() == 1);
    }

    /// Opened, no sample has two uses, and of what is missed most the fits, the judge and the weights each have their part. What moves
    /// three times as far sets the scale, though its first stretch is the judge's.
    #[test]
    fn the_judge_keeps_half_and_each_use_sees_what_is_missed() {
        let mut runs: Vec<Run> = (1..3).map(|seed| recorded(&model(TRUTH), seed)).collect();
        let farther = runs[1].measured.iter_mut().filter(|m| m.channel == Channel::Displacement);
        farther.flat_map(|m| &mut m.values).for_each(|value| *value *= 3.0);
        let (fit, holdout) = (runs[..1].to_vec(), runs[1..].to_vec());
        let signal_scales = SignalScales::of(&fit, 1.0);
        let length = stretch_length(&runs[1]);
        let shown = |k: usize| match k / length {
            0 => 0.5,
            3..6 => 1.0,
            _ => 1e-3,
        };
        let channels = runs[1]
            .measured
            .iter()
            .map(|m| m.values.iter().enumerate().map(|(k, value)| value - shown(k) * m.noise).collect());
        let predicted = [Predicted { channels: channels.collect(), displacement: Vec::new() }];
        let whole = Prepared { model: model(TRUTH), fit, holdout: Vec::new(), signal_scales };
        let opened = reopened(&whole, whole.clone(), &holdout, &predicted);
        let uses = [&opened.weighing.fitted()[1], &opened.weighing.weighed()[1], &opened.test.0[0]].map(finite);
        assert!(uses[2].first() == Some(&0), "the judge has the beginning");
        let scale = opened.weighing.training.0.signal_scales.displacement;
        assert!(scale > 2.0 * signal_scales.displacement, "{scale} of {}", signal_scales.displacement);
        let mut all = uses.concat();
        all.sort_unstable();
        assert_eq!(all, finite(&runs[1]));
        assert!(uses[2].len() * 5 > 2 * runs[1].len() && uses[2].len() * 5 < 3 * runs[1].len(), "{}", uses[2].len());
        for samples in uses {
            assert!(samples.iter().any(|k| (3..6).contains(&(k / length))));
        }
    }
}
