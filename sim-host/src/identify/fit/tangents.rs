//! What additions to a fitted model would explain, by tangents alone, stretch by stretch.
//!
//! The sensitivities of a whole-loop simulation to an addition that is still at zero are the columns of a linear regression on
//! what the fit leaves; the fit's own parameters are projected out of them. With the sums kept for each stretch of the data, the
//! same regression on any half of the stretches costs no further simulation, which is what a check of stability needs.
//!
//! Source: N. Meinshausen, P. Buehlmann, "Stability selection", Journal of the Royal Statistical Society B 72 (2010) 417-473.

use super::added::{held, only_new};
use super::{Fit, PROMISED};
use crate::identify::data::Run;
use crate::identify::evaluate::{Local, Rows, normal};
use crate::identify::model::Model;
use crate::plant::simulate::SimulateError;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Stretches of each run's rows.
const STRETCHES: usize = 12;
/// Share of an addition's tangent below which nothing of it is left beside the fit's own parameters.
const NOTHING: f64 = 1e-5;

/// A fit with the sums of its sensitivities over each stretch.
#[derive(Debug)]
pub(crate) struct Tangents<'a> {
    fit: &'a Fit,
    runs: &'a [Run],
    rows: Vec<Rows>,
    stretches: Vec<Own>,
    /// What priors add to the curvature, and to the gradient.
    prior: (DMatrix<f64>, DVector<f64>),
}

/// Sums of the fit's own sensitivities over a stretch.
#[derive(Debug, Clone)]
struct Own {
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
}

/// Sums of an addition's sensitivities over each stretch.
#[derive(Debug, Clone)]
pub(crate) struct Addition {
    stretches: Vec<Along>,
}

#[derive(Debug, Clone)]
struct Along {
    cross: DMatrix<f64>,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
}

/// An addition as regressed on a choice of stretches.
#[derive(Debug, Clone)]
pub(crate) struct Regressed {
    /// Squares it takes away there, the fit's own parameters moving with it.
    pub gain: f64,
    /// Its values, in the order of its parameters.
    pub values: Vec<f64>,
}

impl<'a> Tangents<'a> {
    /// Simulates the fit once more to keep its rows.
    pub(crate) fn of(fit: &'a Fit, runs: &'a [Run]) -> Result<Self, SimulateError> {
        let kept = |(run, local): (&Run, &Local)| -> Result<Rows, SimulateError> {
            let mut rows = Rows::default();
            normal(&fit.model, run, local, Some(&mut rows))?;
            Ok(rows)
        };
        let rows = runs.par_iter().zip(&fit.locals).map(kept).collect::<Result<Vec<_>, _>>()?;
        let mut it = Self { fit, runs, rows, stretches: Vec::new(), prior: Default::default() };
        it.stretches = it.own();
        let n = fit.normal.gradient.len();
        let sum = |(mut matrix, mut gradient): (DMatrix<f64>, DVector<f64>), own: &Own| {
            matrix += &own.matrix;
            gradient += &own.gradient;
            (matrix, gradient)
        };
        let (matrix, gradient) = it.stretches.iter().fold((DMatrix::zeros(n, n), DVector::zeros(n)), sum);
        it.prior = (&fit.normal.matrix - matrix, &fit.normal.gradient - gradient);
        Ok(it)
    }

    /// How many stretches there are.
    pub(crate) fn stretches(&self) -> usize {
        self.stretches.len()
    }

    fn shared(&self) -> usize {
        self.fit.model.free_values()
    }

    /// Calls `each` with the range of rows of every stretch of every run, and where the run's own parameters begin.
    fn each_stretch(&self, mut each: impl FnMut(usize, std::ops::Range<usize>, usize, usize)) {
        let mut first = self.shared();
        for (i, rows) in self.rows.iter().enumerate() {
            let n = rows.residuals.len();
            let width = rows.jacobian.len() / n.max(1);
            for s in 0..STRETCHES {
                each(i, s * n / STRETCHES..(s + 1) * n / STRETCHES, width, first);
            }
            first += width.saturating_sub(self.shared());
        }
    }

    fn own(&self) -> Vec<Own> {
        let (n, shared) = (self.fit.normal.gradient.len(), self.shared());
        let mut all = Vec::new();
        self.each_stretch(|i, range, width, first| {
            let mut own = Own { matrix: DMatrix::zeros(n, n), gradient: DVector::zeros(n) };
            let place = |j: usize| if j < shared { j } else { first + j - shared };
            let mut square = vec![0.0; width * width];
            let mut towards = vec![0.0; width];
            let rows = &self.rows[i];
            for k in range {
                let row = &rows.jacobian[k * width..(k + 1) * width];
                for (a, &x) in row.iter().enumerate() {
                    towards[a] += f64::from(x) * rows.residuals[k];
                    for (b, &y) in row.iter().enumerate().skip(a) {
                        square[a * width + b] += f64::from(x) * f64::from(y);
                    }
                }
            }
            for a in 0..width {
                own.gradient[place(a)] = towards[a];
                for b in a..width {
                    own.matrix[(place(a), place(b))] = square[a * width + b];
                    own.matrix[(place(b), place(a))] = square[a * width + b];
                }
            }
            all.push(own);
        });
        all
    }

    /// The tangent of what `model` has beyond the fit: of every free value of its effects that the fit has not. None where it
    /// has none.
    pub(crate) fn addition(&self, model: &Model) -> Result<Option<Addition>, SimulateError> {
        let narrow = only_new(model, &self.fit.model);
        let width = narrow.free_values();
        if width == 0 {
            return Ok(None);
        }
        let mut tangents = self.columns(&narrow)?;
        silence_runaways(&mut tangents, width);
        let (n, shared) = (self.fit.normal.gradient.len(), self.shared());
        let mut stretches = Vec::new();
        self.each_stretch(|i, range, own, first| {
            let mut along = Along {
                cross: DMatrix::zeros(n, width),
                matrix: DMatrix::zeros(width, width),
                gradient: DVector::zeros(width),
            };
            let place = |j: usize| if j < shared { j } else { first + j - shared };
            let (rows, columns) = (&self.rows[i], &tangents[i]);
            for k in range {
                let row = &rows.jacobian[k * own..(k + 1) * own];
                for (w, &x) in columns[k * width..(k + 1) * width].iter().enumerate() {
                    let x = f64::from(x);
                    along.gradient[w] += x * rows.residuals[k];
                    for (j, &y) in row.iter().enumerate() {
                        along.cross[(place(j), w)] += x * f64::from(y);
                    }
                    for (v, &y) in columns[k * width..(k + 1) * width].iter().enumerate() {
                        along.matrix[(v, w)] += x * f64::from(y);
                    }
                }
            }
            stretches.push(along);
        });
        Ok(Some(Addition { stretches }))
    }

    /// Each run's sensitivities to the free values of a model, row by row.
    fn columns(&self, narrow: &Model) -> Result<Vec<Vec<f32>>, SimulateError> {
        let of = |(run, local): (&Run, &Local)| Ok(held(narrow, run, local)?.1.jacobian);
        self.runs.iter().zip(&self.fit.locals).map(of).collect()
    }

    /// Regresses some columns of an addition on the stretches that are `taken`; none where nothing of them is left beside the
    /// fit's own parameters.
    pub(crate) fn regress(
        &self,
        addition: &Addition,
        columns: &[usize],
        taken: impl Fn(usize) -> bool,
    ) -> Option<Regressed> {
        let (n, width) = (self.fit.normal.gradient.len(), columns.len());
        let (mut own, mut gradient) = self.prior.clone();
        let (mut cross, mut matrix) = (DMatrix::zeros(n, width), DMatrix::zeros(width, width));
        let mut towards = DVector::zeros(width);
        for (_, (o, a)) in self.stretches.iter().zip(&addition.stretches).enumerate().filter(|(i, _)| taken(*i)) {
            own += &o.matrix;
            gradient += &o.gradient;
            for (w, &column) in columns.iter().enumerate() {
                cross.set_column(w, &(cross.column(w) + a.cross.column(column)));
                towards[w] += a.gradient[column];
                for (v, &other) in columns.iter().enumerate() {
                    matrix[(v, w)] += a.matrix[(other, column)];
                }
            }
        }
        let held = self.fit.held();
        for i in 0..n {
            let size = own[(i, i)];
            if held[i] || size <= 0.0 {
                own.row_mut(i).fill(0.0);
                own.column_mut(i).fill(0.0);
                cross.row_mut(i).fill(0.0);
                gradient[i] = 0.0;
                own[(i, i)] = 1.0;
            } else {
                own[(i, i)] = size * (1.0 + PROMISED);
            }
        }
        let scale = DVector::from_fn(n, |i, _| 1.0 / own[(i, i)].sqrt());
        let scaled = DMatrix::from_fn(n, n, |i, j| own[(i, j)] * scale[i] * scale[j]);
        let own = scaled.cholesky()?;
        let cross = DMatrix::from_fn(n, width, |i, j| cross[(i, j)] * scale[i]);
        let gradient = gradient.component_mul(&scale);
        let taken_up = own.solve(&cross);
        let before: Vec<f64> = (0..width).map(|w| matrix[(w, w)]).collect();
        matrix -= cross.transpose() * &taken_up;
        towards -= taken_up.transpose() * gradient;
        for (w, before) in before.iter().enumerate() {
            if matrix[(w, w)] <= NOTHING * before || *before <= 0.0 {
                return None;
            }
            matrix[(w, w)] *= 1.0 + 1e-9;
        }
        let values = matrix.cholesky()?.solve(&towards);
        let gain = values.dot(&towards);
        gain.is_finite().then(|| Regressed { gain, values: values.iter().copied().collect() })
    }
}

/// Makes nothing of a column whose sensitivity runs away: it explains nothing.
fn silence_runaways(tangents: &mut [Vec<f32>], width: usize) {
    let runs_away = |w: usize| tangents.iter().any(|t| t.iter().skip(w).step_by(width).any(|x| !x.is_finite()));
    let silent: Vec<bool> = (0..width).map(runs_away).collect();
    for tangent in tangents {
        for (_, x) in tangent.iter_mut().enumerate().filter(|(i, _)| silent[i % width]) {
            *x = 0.0;
        }
    }
}
