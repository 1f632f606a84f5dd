//! Bounded Levenberg-Marquardt on whole-loop simulation error.

mod added;
mod foresight;
mod idle;
pub(crate) mod secant;
pub(crate) mod tangents;

use super::covariance::{Variance, covariance, variances};
use super::data::Run;
use super::evaluate::{Local, normal, residuals};
use super::model::{Model, Value};
use super::normal::Normal;
use crate::plant::simulate::SimulateError;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// A model with the local parameters of the runs it was fitted to.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The model with its fitted values.
    pub model: Model,
    /// One set a run.
    pub locals: Vec<Local>,
    /// Sum of squared residuals in units of noise.
    pub squares: f64,
    /// Residuals summed.
    pub rows: usize,
    /// Runs of the plant simulated with sensitivities.
    pub evaluations: usize,
    damping: f64,
    normal: Normal,
    /// The last step lowered the squares as it had promised.
    kept: bool,
    converged: bool,
}

/// Damping with which a fit's promise is computed.
const PROMISED: f64 = 1e-3;

/// Share of what a step promised from which the next one is taken without a trial.
const KEPT: f64 = 0.5;

/// Share of a bound within which a value is at it.
const AT_END: f64 = 1e-3;

/// How far a fit goes.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Most steps tried.
    pub steps: usize,
    /// Stops when a step lowers the squares by less than this share.
    pub tolerance: f64,
}

impl Effort {
    /// Until nothing moves.
    pub const FULL: Self = Self { steps: 25, tolerance: 1e-6 };
}

impl Fit {
    /// A model before any step.
    pub fn begin(model: Model, runs: &[Run]) -> Result<Self, SimulateError> {
        let locals = runs.iter().map(|run| Local::start(&model, run)).collect();
        Self::resume(model, locals, runs)
    }

    /// A model with local parameters known from before.
    pub fn resume(model: Model, locals: Vec<Local>, runs: &[Run]) -> Result<Self, SimulateError> {
        let locals = matching(locals, &model, runs);
        let normal = assemble(&model, &locals, runs)?;
        let (squares, rows) = (normal.squares, normal.rows);
        Ok(Self { model, locals, squares, rows, evaluations: 1, damping: 1e-3, normal, kept: false, converged: false })
    }

    /// The same values on other recordings or parts of the same runs, before any step.
    pub(crate) fn on(&self, runs: &[Run]) -> Result<Self, SimulateError> {
        Self::resume(self.model.clone(), self.locals.clone(), runs)
    }

    /// Mean squared residual in units of noise; 1 is the floor.
    pub fn chi2(&self) -> f64 {
        self.squares / (self.rows as f64).max(1.0)
    }

    /// Squares that the next step promises, were the residual linear in the parameters.
    pub fn promised(&self) -> f64 {
        let step = self.normal.step(PROMISED, &self.held());
        self.squares - step.map_or(0.0, |step| step.dot(&self.normal.gradient))
    }

    /// True where the last effort ended because nothing moved any more.
    pub fn converged(&self) -> bool {
        self.converged
    }

    /// Takes steps until the effort is spent or nothing moves.
    pub fn improve(&mut self, runs: &[Run], effort: Effort) -> Result<(), SimulateError> {
        self.improve_towards(runs, effort, f64::INFINITY)
    }

    /// The same, no further once the steps that are left would not lower the squares to a goal even if each lowered them as the last
    /// one did.
    pub(crate) fn improve_towards(&mut self, runs: &[Run], effort: Effort, goal: f64) -> Result<(), SimulateError> {
        let mut steps = 0;
        while steps < effort.steps && !self.converged {
            steps += 1;
            let before = self.squares;
            if !self.step(runs)? {
                self.converged = self.damping > 1e7;
                continue;
            }
            if self.squares - (effort.steps - steps) as f64 * (before - self.squares) > goal {
                return Ok(());
            }
            self.converged = before - self.squares <= effort.tolerance * before.min(self.rows as f64);
            if self.converged {
                self.converged = !self.lowered(runs)?;
            }
        }
        Ok(())
    }

    /// One step; false where it led nowhere and only the damping grew.
    fn step(&mut self, runs: &[Run]) -> Result<bool, SimulateError> {
        let held = self.held();
        let Some(step) = self.normal.step(self.damping, &held) else {
            self.damping *= 10.0;
            return Ok(false);
        };
        let (mut model, mut locals) = (self.model.clone(), self.locals.clone());
        let free = model.values_mut().chain(locals.iter_mut().flat_map(Local::values_mut)).filter(|v| v.free);
        for (value, change) in free.zip(step.iter()) {
            value.set_coordinate(value.coordinate() + bounded(value.positive, *change));
        }
        // Half of all steps lead nowhere, which a simulation without sensitivities says for a part of the time; not those
        // that follow one that kept its promise.
        if !self.kept && squares(&model, &locals, runs)? >= self.squares {
            self.damping *= 8.0;
            return Ok(false);
        }
        let normal = assemble(&model, &locals, runs)?;
        self.evaluations += 1;
        let lowered = self.squares - normal.squares;
        self.kept = lowered > KEPT * step.dot(&self.normal.gradient).abs();
        if lowered > 0.0 {
            self.squares = normal.squares;
            (self.model, self.locals, self.normal) = (model, locals, normal);
            self.damping = (self.damping * 0.2).max(1e-9);
            Ok(true)
        } else {
            self.damping *= 8.0;
            Ok(false)
        }
    }

    /// Which parameters sit at a bound that the gradient pushes against.
    fn held(&self) -> Vec<bool> {
        let free = self.model.values().chain(self.locals.iter().flat_map(Local::values)).filter(|v| v.free);
        free.zip(self.normal.gradient.iter())
            .map(|(v, &g)| (v.value <= v.low && g < 0.0) || (v.value >= v.high && g > 0.0))
            .collect()
    }

    /// Squares that a tenth less of each shared value would cost at least, where it wants to go beyond the end of what makes
    /// sense, in the order of [`Model::values`]; 0 where it is at none.
    pub fn pushed(&self) -> Vec<f64> {
        let mut gradient = self.normal.gradient.iter();
        let cost = |value: &Value| -> f64 {
            if !value.free {
                return 0.0;
            }
            let slope = gradient.next().copied().unwrap_or(0.0);
            let near = |end: f64| (value.value - end).abs() <= AT_END * end.abs();
            let beyond = (near(value.high) && slope > 0.0) || (near(value.low) && slope < 0.0);
            let tenth = if value.positive { 0.1 } else { 0.1 * value.value.abs() };
            if beyond { 2.0 * slope.abs() * tenth } else { 0.0 }
        };
        self.model.values().map(cost).collect()
    }

    /// Covariance of the free shared parameters' coordinates; none where the data do not determine them.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        Some(self.shared(&covariance(&self.normal)?))
    }

    /// How the variance of each free shared coordinate is told; none where the data do not determine them.
    pub(super) fn variances(&self) -> Option<Vec<Variance>> {
        let mut all = variances(&self.normal)?;
        all.truncate(self.model.free_values());
        Some(all)
    }

    /// Inverse of the curvature of the squares by the free shared values' coordinates, all else fitted along; none where the data do not
    /// determine them.
    pub fn spread(&self) -> Option<DMatrix<f64>> {
        Some(self.shared(&self.normal.inverse()?))
    }

    /// The part of a matrix over all coordinates that belongs to the free shared values.
    fn shared(&self, all: &DMatrix<f64>) -> DMatrix<f64> {
        let count = self.model.free_values();
        all.view((0, 0), (count, count)).into_owned()
    }

    /// By how much colour and misfit of the residuals widen each free shared coordinate's variance against white noise
    /// of the stated size; none where the data do not determine them.
    pub fn inflation(&self) -> Option<Vec<f64>> {
        let (robust, white) = (self.covariance()?, self.spread()?);
        Some((0..robust.nrows()).map(|i| robust[(i, i)] / white[(i, i)]).collect())
    }

    /// Standard deviation of each shared value in the order of [`Model::values`]; NaN where it was not free.
    pub fn deviations(&self) -> Vec<f64> {
        let covariance = self.covariance();
        let mut next = 0;
        let deviation = |value: &Value| {
            if !value.free {
                return f64::NAN;
            }
            let i = next;
            next += 1;
            covariance.as_ref().map_or(f64::INFINITY, |c| c[(i, i)].max(0.0).sqrt() * value.slope())
        };
        self.model.values().map(deviation).collect()
    }
}

/// A step of a coordinate. A logarithm grows as the value itself would under the same linear step, so that a size
/// started near nothing arrives in one step, and shrinks by no more than a factor of four.
fn bounded(positive: bool, change: f64) -> f64 {
    match positive {
        false => change,
        true if change > 0.0 => change.min(60.0).ln_1p(),
        true => change.max(-1.4),
    }
}

/// Local parameters known from before, those of effects and states begun anew where the model has others.
fn matching(mut locals: Vec<Local>, model: &Model, runs: &[Run]) -> Vec<Local> {
    for (local, run) in locals.iter_mut().zip(runs) {
        let wanted = Local::start(model, run);
        if local.effects.len() != wanted.effects.len() {
            local.effects = wanted.effects;
        }
        if local.states.len() != wanted.states.len() {
            local.states = wanted.states;
        }
    }
    locals
}

/// By how much each free shared coordinate is away from what was known of it, and how surely that was.
fn priors(model: &Model) -> impl Iterator<Item = (usize, f64, f64)> {
    let free = model.values().filter(|v| v.free).enumerate();
    free.filter_map(|(i, v)| v.prior.map(|p| (i, (p.mean - v.coordinate()) / p.std, p.std)))
}

/// What a fit makes small, without its derivatives.
pub(crate) fn squares(model: &Model, locals: &[Local], runs: &[Run]) -> Result<f64, SimulateError> {
    let of = |(run, local): (&Run, &Local)| Ok(residuals(model, run, local)?.iter().map(|r| r * r).sum::<f64>());
    let parts = runs.par_iter().zip(locals).map(of).collect::<Result<Vec<f64>, _>>()?;
    let sum = parts.iter().sum::<f64>() + priors(model).map(|(_, away, _)| away * away).sum::<f64>();
    Ok(if sum.is_finite() { sum } else { f64::INFINITY })
}

/// The normal equations over all runs: shared parameters first, then each run's own.
fn assemble(model: &Model, locals: &[Local], runs: &[Run]) -> Result<Normal, SimulateError> {
    let shared = model.free_values();
    let counts: Vec<usize> = locals.iter().map(|l| l.values().filter(|v| v.free).count()).collect();
    let parts: Vec<_> = runs.par_iter().zip(locals).map(|(run, local)| normal(model, run, local, None)).collect();
    let mut sum = Normal::zeros(shared + counts.iter().sum::<usize>());
    let mut place = shared;
    for (part, count) in parts.into_iter().zip(counts) {
        sum.add(part?, shared, place);
        place += count;
    }
    for (i, away, std) in priors(model) {
        sum.squares += away * away;
        sum.gradient[i] += away / std;
        sum.matrix[(i, i)] += std.powi(-2);
    }
    // A model that runs away is as bad as can be, not an error.
    if !sum.squares.is_finite() {
        sum.squares = f64::INFINITY;
    }
    Ok(sum)
}

#[cfg(test)]
pub(crate) mod tests;
