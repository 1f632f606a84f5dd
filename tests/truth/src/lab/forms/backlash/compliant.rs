//! An elastic joint with play that drags the table against a viscous guide: the table follows the edge of the gap at a pace.

use crate::lab::law::{Law, Now};

/// The joint.
#[derive(Debug, Clone, Copy)]
pub struct CompliantPlay {
    /// Full gap (m).
    pub gap: f64,
    /// Pace at which the joint pulls the table after it (1/s).
    pub pace: f64,
}

impl CompliantPlay {
    fn pull(&self, place: f64) -> f64 {
        self.pace * (place.abs() - 0.5 * self.gap).max(0.0) * place.signum()
    }
}

impl Law for CompliantPlay {
    fn states(&self) -> usize {
        1
    }

    fn rates(&self, _: &Now, input: f64, y: &[f64], _: &[f64], dy: &mut [f64]) {
        dy[0] = input - self.pull(y[0]);
    }

    fn out(&self, _: &Now, _: f64, y: &[f64], _: &[f64]) -> f64 {
        self.pull(y[0])
    }

    fn fastest(&self) -> f64 {
        self.pace
    }
}
