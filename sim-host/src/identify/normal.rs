//! Normal equations of a least-squares step, summed row by row.

use nalgebra::{DMatrix, DVector};

/// `J'J`, `J'r` and what a judgement needs beside them.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    /// `J'J`, both triangles.
    pub(super) matrix: DMatrix<f64>,
    /// `J'r`, r being measured less simulated in units of noise.
    pub(super) gradient: DVector<f64>,
    /// `r'r`.
    pub(super) squares: f64,
    /// Rows summed.
    pub(super) rows: usize,
    /// `J'r` of each block of a run, for errors that hold where neighbouring residuals are alike.
    pub(super) blocks: Vec<DVector<f64>>,
}

impl Normal {
    pub(super) fn zeros(n: usize) -> Self {
        Self { matrix: DMatrix::zeros(n, n), gradient: DVector::zeros(n), squares: 0.0, rows: 0, blocks: Vec::new() }
    }

    /// Adds another run's equations: its first `shared` parameters are everybody's, the rest start at `local`.
    pub(super) fn add(&mut self, run: &Self, shared: usize, local: usize) {
        let place = |i: usize| if i < shared { i } else { local + i - shared };
        for i in 0..run.gradient.len() {
            self.gradient[place(i)] += run.gradient[i];
            for j in 0..run.gradient.len() {
                self.matrix[(place(i), place(j))] += run.matrix[(i, j)];
            }
        }
        self.squares += run.squares;
        self.rows += run.rows;
        for block in &run.blocks {
            let mut wide = DVector::zeros(self.gradient.len());
            for i in 0..block.len() {
                wide[place(i)] += block[i];
            }
            self.blocks.push(wide);
        }
    }

    /// The step that lowers the squares, damped by `damping` times each parameter's own curvature.
    pub(super) fn step(&self, damping: f64, held: &[bool]) -> Option<DVector<f64>> {
        self.solve(self.gradient.clone(), damping, held)
    }

    /// `J'J` damped by `damping` times its own diagonal, solved for any right side; nothing moves that is held.
    pub(super) fn solve(&self, mut gradient: DVector<f64>, damping: f64, held: &[bool]) -> Option<DVector<f64>> {
        let mut matrix = self.matrix.clone();
        for (i, &held) in held.iter().enumerate() {
            if held || matrix[(i, i)] <= 0.0 {
                matrix.row_mut(i).fill(0.0);
                matrix.column_mut(i).fill(0.0);
                matrix[(i, i)] = 1.0;
                gradient[i] = 0.0;
            }
        }
        let scale = DVector::from_fn(gradient.len(), |i, _| 1.0 / matrix[(i, i)].sqrt());
        let scaled = DMatrix::from_fn(gradient.len(), gradient.len(), |i, j| {
            matrix[(i, j)] * scale[i] * scale[j] + if i == j { damping + 1e-12 } else { 0.0 }
        });
        let right = gradient.component_mul(&scale);
        Some(scaled.cholesky()?.solve(&right).component_mul(&scale))
    }

    /// Inverse of the curvature: the covariance, were the residuals white and of unit size.
    pub(super) fn inverse(&self) -> Option<DMatrix<f64>> {
        let n = self.gradient.len();
        let scale = DVector::from_fn(n, |i, _| 1.0 / self.matrix[(i, i)].max(1e-300).sqrt());
        let scaled =
            DMatrix::from_fn(n, n, |i, j| self.matrix[(i, j)] * scale[i] * scale[j] + if i == j { 1e-10 } else { 0.0 });
        let inverse = scaled.cholesky()?.inverse();
        Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] * scale[i] * scale[j]))
    }

    /// Covariance of the parameters that holds for coloured and misfitting residuals: the spread of the blocks'
    /// scores between two inverses of the curvature.
    pub(super) fn covariance(&self) -> Option<DMatrix<f64>> {
        let n = self.gradient.len();
        let inverse = self.inverse()?;
        let mut spread = DMatrix::zeros(n, n);
        for block in &self.blocks {
            spread += block * block.transpose();
        }
        let few = self.blocks.len() as f64 / (self.blocks.len() as f64 - n as f64).max(1.0);
        let robust = &inverse * spread * &inverse * few;
        // Where residuals are white the curvature alone is the sharper estimate; the larger of the two is honest.
        let chi2 = (self.squares / (self.rows as f64 - n as f64).max(1.0)).max(1.0);
        Some(DMatrix::from_fn(
            n,
            n,
            |i, j| if i == j { robust[(i, i)].max(inverse[(i, i)] * chi2) } else { robust[(i, j)] },
        ))
    }
}
