//! Normal equations of a run with more free parameters than one simulation carries derivatives of.
//!
//! The simulation is run again for every [`WIDEST`] of them, with the same values, so that the residuals are the same each
//! time and only the columns differ; products of columns need all of them, so rows are kept until the last is there.

use super::{Local, Model, Rows, Run, SimulateError, compared, stretch_length, tangents};
use crate::identify::normal::{Block, Normal};
use nalgebra::DMatrix;

/// Most parameters that one simulation carries derivatives of.
pub(super) const WIDEST: usize = if cfg!(debug_assertions) { 16 } else { 24 };

/// Rows with all their columns.
struct Wide {
    residuals: Vec<f64>,
    /// Row by row.
    jacobian: Vec<f64>,
    /// The stretch of the run that each row is of.
    stretches: Vec<usize>,
    count: usize,
}

/// The normal equations of `run` over all its `count` free parameters, and its rows where they are asked for.
pub(super) fn normal(
    model: &Model,
    run: &Run,
    local: &Local,
    count: usize,
    keep: Option<&mut Rows>,
) -> Result<Normal, SimulateError> {
    let mut wide = Wide { residuals: Vec::new(), jacobian: Vec::new(), stretches: Vec::new(), count };
    let block = stretch_length(run);
    for first in (0..count).step_by(WIDEST) {
        let (trace, scale, offset) = tangents::<WIDEST>(model, run, local, first)?;
        let mut row = 0;
        compared(run, &trace, scale, offset, |k, measured, inverse, model| {
            if measured.is_nan() {
                return;
            }
            if first == 0 {
                wide.residuals.push((measured - model.value) * inverse);
                wide.stretches.push(k / block);
                wide.jacobian.resize(wide.residuals.len() * count, 0.0);
            }
            let here = &mut wide.jacobian[row * count + first..(row + 1) * count];
            here.iter_mut().zip(model.tangent).for_each(|(to, slope)| *to = f64::from(slope) * inverse);
            row += 1;
        });
    }
    if let Some(rows) = keep {
        rows.residuals.extend(&wide.residuals);
        rows.jacobian.extend(wide.jacobian.iter().map(|&slope| slope as f32));
    }
    Ok(wide.finish(run.len().div_ceil(block)))
}

impl Wide {
    /// The sums, stretch by stretch.
    fn finish(&self, stretches: usize) -> Normal {
        let mut sum = Normal::zeros(self.count);
        for stretch in 0..stretches {
            let rows: Vec<usize> = (0..self.residuals.len()).filter(|&row| self.stretches[row] == stretch).collect();
            let residuals = DMatrix::from_fn(rows.len(), 1, |i, _| self.residuals[rows[i]]);
            let jacobian = DMatrix::from_fn(rows.len(), self.count, |i, j| self.jacobian[rows[i] * self.count + j]);
            let matrix = jacobian.tr_mul(&jacobian);
            let gradient = jacobian.tr_mul(&residuals).column(0).into_owned();
            let squares = residuals.norm_squared();
            sum.matrix += &matrix;
            sum.gradient += &gradient;
            sum.squares += squares;
            sum.rows += rows.len();
            let places = (self.count, self.count);
            sum.blocks.push(Block { places, matrix, gradient, squares, rows: rows.len() });
        }
        sum
    }
}
