//! How well a model predicts runs it was not fitted to: only where they start is estimated again.

use super::data::{Channel, Measured, Run};
use super::evaluate::{BLOCK, Local, Predicted, predict};
use super::fit::{Effort, Fit};
use super::model::Model;
use crate::plant::simulate::SimulateError;
use rayon::prelude::*;

/// A model's standing on a set of runs.
#[derive(Debug, Clone)]
pub struct Score {
    /// Mean of (residual / noise)^2 over displacement and acceleration, or over the command of a rigid mass where
    /// neither states its noise.
    pub chi2: f64,
    /// Samples behind that mean.
    pub samples: usize,
    /// Residuals of all judged channels.
    pub rows: usize,
    /// Sum of squares of all judged channels in each block of a run.
    pub blocks: Vec<f64>,
    /// By how much neighbouring residuals of a judged channel being alike overstates their number, 1 for white ones.
    pub colour: f64,
    /// Mean of (residual / noise)^2 and number of residuals of each judged channel.
    pub channels: Vec<(Channel, f64, usize)>,
    /// Normalised RMS residual by channel: RMS of the residual over RMS of the measurement about its mean.
    pub nrmse: Vec<(Channel, f64)>,
    /// The prediction of each run.
    pub predicted: Vec<Predicted>,
}

impl Score {
    /// Adds one residual's square to its channel's.
    fn count(&mut self, channel: Channel, square: f64) {
        match self.channels.iter_mut().find(|(c, ..)| *c == channel) {
            Some((_, sum, count)) => (*sum, *count) = (*sum + square, *count + 1),
            None => self.channels.push((channel, square, 1)),
        }
    }

    /// The judged channels that count in chi2: mean of (residual / noise)^2 and number of residuals of each.
    pub fn counted(&self) -> impl Iterator<Item = (Channel, f64, usize)> + '_ {
        let judged = || self.channels.iter().map(|(channel, ..)| *channel);
        self.channels.iter().copied().filter(move |(channel, ..)| counts_beside(*channel, judged()))
    }

    /// Mean of (residual / noise)^2 of a channel; none where it was not judged.
    pub fn chi2_of(&self, channel: Channel) -> Option<f64> {
        self.channels.iter().find(|(of, ..)| *of == channel).map(|&(_, chi2, _)| chi2)
    }

    /// Sum of squares of all judged channels.
    pub fn squares(&self) -> f64 {
        self.blocks.iter().sum()
    }
}

/// Scores a model on runs, its shared parameters as they are.
pub fn score(model: &Model, runs: &[Run]) -> Result<Score, SimulateError> {
    scored(Fit::begin(fixed(model), runs)?, runs)
}

/// The same on other samples of the runs that a model was fitted to: where each run starts is known from the fit.
pub(crate) fn score_from(fit: &Fit, runs: &[Run]) -> Result<Score, SimulateError> {
    scored(Fit::resume(fixed(&fit.model), fit.locals.clone(), runs)?, runs)
}

/// The same on runs of which some are other samples of those that a model was fitted to.
pub(crate) fn score_beside(fit: &Fit, fitted: &[Run], runs: &[Run]) -> Result<Score, SimulateError> {
    let model = fixed(&fit.model);
    let known = |run: &Run| fitted.iter().position(|other| other.name == run.name && other.from == run.from);
    let local = |run: &Run| known(run).and_then(|k| fit.locals.get(k).cloned());
    let locals = runs.iter().map(|run| local(run).unwrap_or_else(|| Local::start(&model, run))).collect();
    scored(Fit::resume(model, locals, runs)?, runs)
}

/// A model of which nothing is free but where its runs start.
fn fixed(model: &Model) -> Model {
    let mut fixed = model.clone();
    fixed.values_mut().for_each(|v| v.free = false);
    fixed
}

fn scored(mut fit: Fit, runs: &[Run]) -> Result<Score, SimulateError> {
    fit.improve(runs, Effort { steps: 6, tolerance: 1e-5 })?;
    let predicted: Result<Vec<_>, _> =
        runs.par_iter().zip(&fit.locals).map(|(run, local)| predict(&fit.model, run, local)).collect();
    Ok(of_predictions(runs, predicted?))
}

/// Scores predictions that are at hand.
pub(crate) fn of_predictions(runs: &[Run], predicted: Vec<Predicted>) -> Score {
    let mut score = Score {
        chi2: 0.0,
        samples: 0,
        rows: 0,
        blocks: Vec::new(),
        colour: 1.0,
        channels: Vec::new(),
        nrmse: Vec::new(),
        predicted: Vec::new(),
    };
    let mut sums: Vec<(Channel, Sums)> = Vec::new();
    for (run, prediction) in runs.iter().zip(&predicted) {
        let block = ((BLOCK / run.dt).round() as usize).max(1);
        let first = score.blocks.len();
        score.blocks.resize(first + run.len().div_ceil(block), 0.0);
        for (measured, series) in run.measured.iter().zip(&prediction.channels) {
            let counted = counts(run, measured);
            if measured.judged {
                score.colour = score.colour.max(autocorrelation_factor(measured, series));
            }
            let place = sums.iter().position(|(c, _)| *c == measured.channel).unwrap_or_else(|| {
                sums.push((measured.channel, Sums::default()));
                sums.len() - 1
            });
            for (k, (y, model)) in measured.values.iter().zip(series).enumerate().skip(usize::from(run.moving_start)) {
                let residual = y - model;
                if !residual.is_finite() {
                    continue;
                }
                sums[place].1.add(*y, residual);
                let square = (residual / measured.noise).powi(2);
                if counted {
                    score.chi2 += square;
                    score.samples += 1;
                }
                if measured.judged {
                    score.blocks[first + k / block] += square;
                    score.rows += 1;
                    score.count(measured.channel, square);
                }
            }
        }
    }
    score.chi2 /= score.samples.max(1) as f64;
    score.channels.iter_mut().for_each(|(_, mean, count)| *mean /= (*count).max(1) as f64);
    score.nrmse =
        sums.into_iter().filter(|(_, sums)| sums.count > 0.0).map(|(channel, sums)| (channel, sums.nrmse())).collect();
    score.predicted = predicted;
    score
}

/// One plus twice the sum of the residual's correlations over neighbouring samples.
fn autocorrelation_factor(measured: &Measured, series: &[f64]) -> f64 {
    const NEIGHBOURS: usize = 12;
    let residual: Vec<f64> = measured.values.iter().zip(series).map(|(y, m)| y - m).filter(|r| r.is_finite()).collect();
    let power: f64 = residual.iter().map(|r| r * r).sum::<f64>().max(f64::MIN_POSITIVE);
    let lagged = |lag: usize| residual.iter().zip(residual.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>() / power;
    1.0 + 2.0 * (1..=NEIGHBOURS).map(lagged).sum::<f64>().max(0.0)
}

/// Whether a channel counts in chi2.
fn counts(run: &Run, measured: &Measured) -> bool {
    let judged = run.measured.iter().filter(|m| m.judged).map(|m| m.channel);
    measured.judged && counts_beside(measured.channel, judged)
}

/// Whether a judged channel counts in chi2 beside all that are judged: motion and effort do, the rest where there is no motion.
fn counts_beside(channel: Channel, mut judged: impl Iterator<Item = Channel>) -> bool {
    let motion = |c| matches!(c, Channel::Displacement | Channel::Acceleration);
    motion(channel) || channel == Channel::Command || !judged.any(motion)
}

#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    count: f64,
    sum: f64,
    squares: f64,
    residual: f64,
}

impl Sums {
    fn add(&mut self, y: f64, residual: f64) {
        self.count += 1.0;
        self.sum += y;
        self.squares += y * y;
        self.residual += residual * residual;
    }

    fn nrmse(&self) -> f64 {
        let mean = self.sum / self.count;
        let about_mean = self.squares / self.count - mean * mean;
        (self.residual / self.count / about_mean.max(f64::MIN_POSITIVE)).sqrt()
    }
}

/// Blocks' gains, summed apart: where the second model is better, and where it is worse.
pub(crate) fn gains(before: &[f64], after: &[f64]) -> (f64, f64) {
    let gains = before.iter().zip(after).map(|(b, a)| b - a);
    gains.fold((0.0, 0.0), |(better, worse), gain| (better + gain.max(0.0), worse + (-gain).max(0.0)))
}
