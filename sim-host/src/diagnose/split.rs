//! Who sees which data: the runs that may be fitted are cut into stretches that fit hypotheses and stretches that weigh
//! them; the runs held out are seen by the verdict alone.
//!
//! Source: M. Stone, "Cross-validatory choice and assessment of statistical predictions", Journal of the Royal Statistical
//! Society B 36 (1974) 111-147; for stretches in place of single samples: P. Burman, E. Chow, D. Nolan, "A cross-validatory
//! method for dependent data", Biometrika 81 (1994) 351-358.

use crate::identify::data::Run;
use crate::identify::fit::Fit;
use crate::identify::judge::{Score, score, score_from};
use crate::identify::model::{Model, Yardsticks};
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
pub struct Training(Prepared);

/// The stretches that hypotheses are weighed on; where a run starts is estimated on them again.
#[derive(Debug, Clone)]
pub struct Validation(Vec<Run>);

/// The runs held out. There is one, it cannot be copied, and the verdict consumes it.
#[derive(Debug)]
pub(super) struct Test(Vec<Run>);

/// What hypotheses are fitted to and weighed on.
#[derive(Debug, Clone)]
pub struct Weighing {
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
    pub fn prepared(&self) -> &Prepared {
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
    pub fn model(&self) -> &Model {
        &self.training.0.model
    }

    /// Sizes of the signals.
    pub fn yardsticks(&self) -> Yardsticks {
        self.training.0.yardsticks
    }

    /// The runs with the stretches that fit.
    pub fn fitted(&self) -> &[Run] {
        &self.training.0.fit
    }

    /// How a fitted model predicts the stretches that weigh.
    pub(super) fn score(&self, fit: &Fit) -> Result<Score, SimulateError> {
        let same = fit.locals.len() == self.weighed().len();
        if same { score_from(fit, self.weighed()) } else { score(&fit.model, self.weighed()) }
    }

    /// The runs with the stretches that weigh.
    pub fn weighed(&self) -> &[Run] {
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
    let Prepared { model, fit, holdout, yardsticks } = prepared;
    let weighs = |i: usize| i % EVERY == EVERY - 2;
    let seen = excerpt.as_ref().map_or(&fit, |excerpt| &excerpt.fit);
    let training = seen.iter().map(|run| kept(run, |i| !weighs(i))).collect();
    let validation = seen.iter().map(|run| kept(run, weighs)).collect();
    let with = |fit: Vec<Run>| Prepared { model: model.clone(), fit, holdout: Vec::new(), yardsticks };
    Split {
        weighing: Weighing { training: Training(with(training)), validation: Validation(validation) },
        whole: with(fit),
        test: Test(holdout),
    }
}

/// The same experiment with every other stretch of the runs held out among those that may be fitted: for physics that they
/// alone show, a stop that only the largest motion reaches. The stretches between are what is held out now.
pub(super) fn reopened(whole: &Prepared, held_out: &[Run]) -> Split {
    let mut whole = whole.clone();
    whole.fit.extend(held_out.iter().map(|run| kept(run, |i| i % 2 == 0)));
    whole.holdout = held_out.iter().map(|run| kept(run, |i| i % 2 == 1)).collect();
    whole.yardsticks = Yardsticks::of(&whole.fit, whole.yardsticks.force);
    split(whole, None)
}

/// A run of which only these stretches were measured.
fn kept(run: &Run, stretch: impl Fn(usize) -> bool) -> Run {
    let length = ((STRETCH / run.dt) as usize).min(run.len() / STRETCHES).max(1);
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
        let yardsticks = Yardsticks::of(&fit, 1.0);
        let split = split(Prepared { model: model(TRUTH), fit, holdout, yardsticks }, None);
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
}
