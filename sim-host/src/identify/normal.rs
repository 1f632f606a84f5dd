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
    /// What each stretch of a run adds, for errors that hold where neighbouring residuals are alike.
    pub(super) blocks: Vec<Block>,
}

/// What one stretch of a run adds to the normal equations, in the run's own order of parameters.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// How many of them are everybody's, and where the others begin.
    pub(super) places: (usize, usize),
    /// `J'J`.
    pub(super) matrix: DMatrix<f64>,
    /// `J'r`.
    pub(super) gradient: DVector<f64>,
    /// `r'r`.
    pub(super) squares: f64,
    /// Rows summed.
    pub(super) rows: usize,
}

impl Block {
    /// The columns of a matrix over all parameters that belong to this block's own.
    pub(super) fn columns(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let (shared, local) = self.places;
        let place = |i: usize| if i < shared { i } else { local + i - shared };
        DMatrix::from_fn(of.nrows(), self.gradient.len(), |j, i| of[(j, place(i))])
    }
}

impl Normal {
    pub(super) fn zeros(n: usize) -> Self {
        Self { matrix: DMatrix::zeros(n, n), gradient: DVector::zeros(n), squares: 0.0, rows: 0, blocks: Vec::new() }
    }

    /// Adds another run's equations: its first `shared` parameters are everybody's, the rest start at `local`.
    pub(super) fn add(&mut self, run: Self, shared: usize, local: usize) {
        let place = |i: usize| if i < shared { i } else { local + i - shared };
        for i in 0..run.gradient.len() {
            self.gradient[place(i)] += run.gradient[i];
            for j in 0..run.gradient.len() {
                self.matrix[(place(i), place(j))] += run.matrix[(i, j)];
            }
        }
        self.squares += run.squares;
        self.rows += run.rows;
        self.blocks.extend(run.blocks.into_iter().map(|block| Block { places: (shared, local), ..block }));
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
}
