//! A transducer that leaves its linear range: `sin` or `sinh` about a centre.

use crate::lab::law::{Law, Now};

/// The transducer.
#[derive(Debug, Clone, Copy)]
pub struct Bend {
    /// Cubic part (1/m2).
    pub cubic: f64,
    /// Centre of the curve (m).
    pub side: f64,
}

impl Bend {
    fn curve(&self, x: f64) -> f64 {
        let c = (6.0 * self.cubic.abs()).sqrt().max(1e-9);
        if self.cubic > 0.0 { (c * x).sinh() / c } else { (c * x).sin() / c }
    }
}

impl Law for Bend {
    fn out(&self, _: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        // Zeroed in the middle, as a person who adjusts it does.
        self.curve(input - self.side) - self.curve(-self.side)
    }
}
