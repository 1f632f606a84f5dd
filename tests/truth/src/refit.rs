//! How far the stated model is from the truth once its free parameters have done what they can: the measure of strength.

use crate::baseline::{Prediction, predict};
use crate::closed_loop::{Run, Traces};
use crate::plant::Machine;

/// A parameter that an experiment may list in `fit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// `b1` (1/s).
    B1,
    /// `b0` (1/s2).
    B0,
    /// `a1` (1/s).
    A1,
    /// `velocity_limit` (m/s).
    VelocityLimit,
    /// `mass` (kg).
    Mass,
    /// `viscous` (N s/m).
    Viscous,
}

impl Parameter {
    /// Its key under `[model]`.
    pub fn key(self) -> &'static str {
        match self {
            Self::B1 => "b1",
            Self::B0 => "b0",
            Self::A1 => "a1",
            Self::VelocityLimit => "velocity_limit",
            Self::Mass => "mass",
            Self::Viscous => "viscous",
        }
    }

    /// Its place in a model; none where the model has no such parameter.
    pub fn of(self, machine: &mut Machine) -> Option<&mut f64> {
        match (self, machine) {
            (Self::B1, Machine::Servo { b1, .. }) => Some(b1),
            (Self::B0, Machine::Servo { b0, .. }) => Some(b0),
            (Self::A1, Machine::Servo { a1, .. }) => Some(a1),
            (Self::VelocityLimit, Machine::Servo { velocity_limit, .. }) => Some(velocity_limit),
            (Self::Mass, Machine::Rigid { mass, .. }) => Some(mass),
            (Self::Viscous, Machine::Rigid { viscous, .. }) => Some(viscous),
            _ => None,
        }
    }

    fn scaled(self, mut machine: Machine, factor: f64) -> Machine {
        if let Some(value) = self.of(&mut machine) {
            *value *= factor;
        }
        machine
    }
}

/// Standard deviations that an experiment states (m, m/s2); none where it has no such channel or states no noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sigma {
    /// Of displacement.
    pub displacement: f64,
    /// Of acceleration.
    pub acceleration: Option<f64>,
}

/// A refitted model: parameters, and the offset of the displacement sensor (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refit {
    /// The model.
    pub machine: Machine,
    /// Offset of the displacement sensor (m).
    pub offset: f64,
}

/// Residuals of one run in units of noise: displacement, then acceleration where it counts; every `stride`th sample.
fn residuals(traces: &Traces, model: &Prediction, offset: f64, sigma: &Sigma, stride: usize, out: &mut Vec<f64>) {
    let d = traces.displacement.iter().zip(&model.displacement).step_by(stride);
    out.extend(d.map(|(y, m)| (y - m - offset) / sigma.displacement));
    if let Some(s) = sigma.acceleration {
        let a = traces.acceleration.iter().zip(&model.acceleration).step_by(stride);
        out.extend(a.map(|(y, m)| (y - m) / s));
    }
}

fn stacked(fit: &Refit, runs: &[(&Run, &Traces)], sigma: &Sigma, stride: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for (run, traces) in runs {
        residuals(traces, &predict(&fit.machine, run), fit.offset, sigma, stride, &mut out);
    }
    out
}

/// Mean of (residual / noise)^2. On traces without noise this is what a flaw adds to chi2.
pub fn chi2(fit: &Refit, runs: &[(&Run, &Traces)], sigma: &Sigma) -> f64 {
    let r = stacked(fit, runs, sigma, 1);
    squares(&r) / r.len().max(1) as f64
}

/// Sum of (residual / noise)^2 over every sample.
pub fn misfit(fit: &Refit, runs: &[(&Run, &Traces)], sigma: &Sigma) -> f64 {
    squares(&stacked(fit, runs, sigma, 1))
}

/// Samples skipped while fitting: strengths need no more.
const STRIDE: usize = 5;

/// Residuals and their sensitivities at a model, one column a free parameter (relative changes, then the offset).
pub fn tangents(
    fit: &Refit,
    free: &[Parameter],
    runs: &[(&Run, &Traces)],
    sigma: &Sigma,
    stride: usize,
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let here = stacked(fit, runs, sigma, stride);
    let step = 1e-5;
    let mut columns: Vec<Vec<f64>> = free
        .iter()
        .map(|parameter| {
            let moved = Refit { machine: parameter.scaled(fit.machine, 1.0 + step), ..*fit };
            let there = stacked(&moved, runs, sigma, stride);
            here.iter().zip(&there).map(|(a, b)| (a - b) / step).collect()
        })
        .collect();
    let moved = Refit { offset: fit.offset + sigma.displacement, ..*fit };
    let there = stacked(&moved, runs, sigma, stride);
    columns.push(here.iter().zip(&there).map(|(a, b)| a - b).collect());
    (here, columns)
}

/// Fits the free parameters and the offset by Gauss and Newton with halved steps.
pub fn refit(start: Machine, free: &[Parameter], runs: &[(&Run, &Traces)], sigma: &Sigma) -> Refit {
    let mut best = Refit { machine: start, offset: 0.0 };
    let mut cost = f64::INFINITY;
    for _ in 0..8 {
        let (r, columns) = tangents(&best, free, runs, sigma, STRIDE);
        let here = squares(&r);
        cost = cost.min(here);
        let Some(step) = least_squares(&columns, &r) else { break };
        let mut gained = false;
        let mut share = 1.0;
        while share > 0.05 {
            let trial = moved(&best, free, &step, share, sigma);
            let there = squares(&stacked(&trial, runs, sigma, STRIDE));
            if there < cost {
                gained = there < cost * (1.0 - 1e-4);
                (best, cost) = (trial, there);
                break;
            }
            share *= 0.4;
        }
        if !gained {
            break;
        }
    }
    best
}

fn moved(from: &Refit, free: &[Parameter], step: &[f64], share: f64, sigma: &Sigma) -> Refit {
    let mut to = *from;
    for (parameter, delta) in free.iter().zip(step) {
        to.machine = parameter.scaled(to.machine, (share * delta).clamp(-0.5, 0.5).exp());
    }
    to.offset += share * step.last().copied().unwrap_or(0.0) * sigma.displacement;
    to
}

/// Solves the normal equations of `columns x = r` by elimination with pivots; none where they are singular.
pub fn least_squares(columns: &[Vec<f64>], r: &[f64]) -> Option<Vec<f64>> {
    let n = columns.len();
    let scale: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt().max(1e-12)).collect();
    let mut m: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let mut row: Vec<f64> = (0..n).map(|j| dot(&columns[i], &columns[j]) / (scale[i] * scale[j])).collect();
            row[i] += 1e-10;
            row.push(dot(&columns[i], r) / scale[i]);
            row
        })
        .collect();
    for i in 0..n {
        let pivot = (i..n).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs()))?;
        m.swap(i, pivot);
        if m[i][i].abs() < 1e-13 {
            return None;
        }
        let head = m[i].clone();
        for row in m.iter_mut().skip(i + 1) {
            let factor = row[i] / head[i];
            for (value, above) in row.iter_mut().zip(&head) {
                *value -= factor * above;
            }
        }
    }
    let mut x = vec![0.0; n];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| m[i][j] * x[j]).sum();
        x[i] = (m[i][n] - known) / m[i][i];
    }
    Some(x.iter().zip(&scale).map(|(v, s)| v / s).collect())
}

/// `r` less the columns, each times its share, one after the other; in the unit of `r`.
pub fn less(r: &[f64], columns: &[Vec<f64>], shares: &[f64]) -> Vec<f64> {
    let mut out = r.to_vec();
    for (column, share) in columns.iter().zip(shares) {
        for (value, slope) in out.iter_mut().zip(column) {
            *value -= share * slope;
        }
    }
    out
}

/// Sum of the products of two vectors, first to last, in the product of their units.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Sum of squares, first to last, in the square of the unit of `r`.
pub fn squares(r: &[f64]) -> f64 {
    r.iter().map(|x| x * x).sum()
}
