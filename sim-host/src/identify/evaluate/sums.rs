//! Rows of a run summed into its normal equations.

use crate::identify::data::{Measured, Run};
use crate::identify::normal::{Block, Normal};
use crate::scalar::Dual;
use nalgebra::{DMatrix, DVector};

/// The sample behind each residual of a run, in the order of [`super::residuals`].
pub(crate) fn compared_samples(run: &Run) -> Vec<usize> {
    let from = usize::from(run.moving_start);
    let samples = |m: &Measured| {
        let values = m.values.iter().enumerate().take(run.len()).skip(from);
        values.filter(|(_, value)| !value.is_nan()).map(|(k, _)| k).collect::<Vec<_>>()
    };
    run.measured.iter().filter(|m| m.judged).flat_map(samples).collect()
}

/// The rows behind the normal equations of a run, in the order of [`super::residuals`].
#[derive(Debug, Clone, Default)]
pub(in crate::identify) struct Rows {
    /// Residuals in units of noise.
    pub(in crate::identify) residuals: Vec<f64>,
    /// Their sensitivities with the sign of the model's, row by row.
    pub(in crate::identify) jacobian: Vec<f32>,
}

/// Sums rows into normal equations, stretch by stretch.
pub(super) struct Sums<const N: usize> {
    stretches: Vec<Stretch<N>>,
    count: usize,
    block: usize,
}

/// What one stretch of a run adds, the upper triangle of the matrix alone.
#[derive(Clone)]
struct Stretch<const N: usize> {
    matrix: [[f64; N]; N],
    gradient: [f64; N],
    squares: f64,
    rows: usize,
}

impl<const N: usize> Sums<N> {
    pub(super) fn new(count: usize, block: usize, samples: usize) -> Self {
        let nothing = Stretch { matrix: [[0.0; N]; N], gradient: [0.0; N], squares: 0.0, rows: 0 };
        Self { stretches: vec![nothing; samples.div_ceil(block)], count, block }
    }

    #[inline]
    pub(super) fn row(&mut self, k: usize, (measured, inverse): (f64, f64), model: &Dual<N>, keep: Option<&mut Rows>) {
        // A dropped sample says nothing; a model that ran away must not pass for one that leaves nothing.
        if measured.is_nan() {
            return;
        }
        let residual = (measured - model.value) * inverse;
        let jacobian = model.tangent.map(|slope| f64::from(slope) * inverse);
        if let Some(rows) = keep {
            rows.residuals.push(residual);
            rows.jacobian.extend(jacobian.iter().take(self.count).map(|&t| t as f32));
        }
        let stretch = &mut self.stretches[k / self.block];
        stretch.squares += residual * residual;
        stretch.rows += 1;
        for i in 0..N {
            stretch.gradient[i] += jacobian[i] * residual;
            // The upper triangle, from an even column on so that lanes stay whole.
            for j in (i & !1)..N {
                stretch.matrix[i][j] += jacobian[i] * jacobian[j];
            }
        }
    }

    pub(super) fn finish(self) -> Normal {
        let n = self.count;
        let mut sum = Normal::zeros(n);
        for stretch in &self.stretches {
            let matrix = DMatrix::from_fn(n, n, |i, j| stretch.matrix[i.min(j)][i.max(j)]);
            let gradient = DVector::from_fn(n, |i, _| stretch.gradient[i]);
            let (squares, rows) = (stretch.squares, stretch.rows);
            sum.matrix += &matrix;
            sum.gradient += &gradient;
            sum.squares += squares;
            sum.rows += rows;
            sum.blocks.push(Block { places: (n, n), matrix, gradient, squares, rows });
        }
        sum
    }
}
