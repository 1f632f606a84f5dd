//! Rows of a run summed into its normal equations.

use crate::identify::normal::Normal;
use crate::scalar::Dual;
use nalgebra::{DMatrix, DVector};

/// The rows behind the normal equations of a run, in the order of [`super::residuals`].
#[derive(Debug, Clone, Default)]
pub(in crate::identify) struct Rows {
    /// Residuals in units of noise.
    pub(in crate::identify) residuals: Vec<f64>,
    /// Their sensitivities with the sign of the model's, row by row.
    pub(in crate::identify) jacobian: Vec<f32>,
}

/// Sums rows into normal equations on the stack.
pub(super) struct Sums<const N: usize> {
    matrix: [[f64; N]; N],
    blocks: Vec<[f64; N]>,
    squares: f64,
    rows: usize,
    count: usize,
    block: usize,
}

impl<const N: usize> Sums<N> {
    pub(super) fn new(count: usize, block: usize, samples: usize) -> Self {
        Self { matrix: [[0.0; N]; N], blocks: vec![[0.0; N]; samples / block + 1], squares: 0.0, rows: 0, count, block }
    }

    #[inline]
    pub(super) fn row(&mut self, k: usize, (measured, inverse): (f64, f64), model: &Dual<N>, keep: Option<&mut Rows>) {
        // A dropped sample says nothing; a model that ran away must not pass for one that leaves nothing.
        if measured.is_nan() {
            return;
        }
        let residual = (measured - model.value) * inverse;
        self.squares += residual * residual;
        self.rows += 1;
        let jacobian = model.tangent.map(|slope| f64::from(slope) * inverse);
        if let Some(rows) = keep {
            rows.residuals.push(residual);
            rows.jacobian.extend(jacobian.iter().take(self.count).map(|&t| t as f32));
        }
        let block = &mut self.blocks[k / self.block];
        for i in 0..N {
            block[i] += jacobian[i] * residual;
            // The upper triangle, from an even column on so that lanes stay whole.
            for j in (i & !1)..N {
                self.matrix[i][j] += jacobian[i] * jacobian[j];
            }
        }
    }

    pub(super) fn finish(self) -> Normal {
        let blocks: Vec<_> = self.blocks.iter().map(|b| DVector::from_fn(self.count, |i, _| b[i])).collect();
        let gradient = blocks.iter().fold(DVector::zeros(self.count), |sum, block| sum + block);
        Normal {
            matrix: DMatrix::from_fn(self.count, self.count, |i, j| self.matrix[i.min(j)][i.max(j)]),
            gradient,
            squares: self.squares,
            rows: self.rows,
            blocks,
        }
    }
}
