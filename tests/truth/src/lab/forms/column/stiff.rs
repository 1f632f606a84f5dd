//! Oil far stiffer than the tests reach: for laws that need a load pressure.

use crate::lab::law::{Column, Now};

/// Oil that is hardly there: a column far above the band of the tests, damped by the pipe and not by a leak.
#[derive(Debug)]
pub struct Stiff;

const STIFF: f64 = 1200.0;
const DAMPING: f64 = 0.8 * STIFF;

impl Column for Stiff {
    fn states(&self) -> usize {
        1
    }

    fn spring(&self, _: &Now, y: &[f64]) -> f64 {
        STIFF * STIFF * y[0]
    }

    fn rates(&self, _: &Now, q: f64, lost: f64, v: f64, y: &[f64], dy: &mut [f64]) -> f64 {
        dy[0] = q - lost - v;
        STIFF * STIFF * y[0] + DAMPING * dy[0]
    }

    fn fastest(&self) -> f64 {
        STIFF
    }

    fn relaxation(&self) -> f64 {
        STIFF * STIFF / DAMPING
    }
}
