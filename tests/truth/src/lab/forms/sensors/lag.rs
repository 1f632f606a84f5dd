//! Two poles in a row, the second a share of the first.

use crate::lab::law::{Law, Now};

/// The conditioner.
#[derive(Debug, Clone, Copy)]
pub struct Lag {
    /// Slow time constant (s).
    pub time: f64,
    /// Fast time constant over the slow one (1).
    pub second: f64,
    /// Whether a position passes, which starts where it is, and not a velocity, which starts at zero.
    pub position: bool,
}

/// Shorter than this (s) the fast pole is left out.
const SHORTEST: f64 = 2e-4;

impl Law for Lag {
    fn states(&self) -> usize {
        2
    }

    fn at_rest(&self, x: f64, y: &mut [f64], _: &mut [f64]) {
        y.fill(if self.position { x } else { 0.0 });
    }

    fn rates(&self, _: &Now, input: f64, y: &[f64], _: &[f64], dy: &mut [f64]) {
        let fast = self.time * self.second;
        let through = if fast > SHORTEST {
            dy[1] = (input - y[1]) / fast;
            y[1]
        } else {
            input
        };
        dy[0] = (through - y[0]) / self.time.max(SHORTEST);
    }

    fn out(&self, _: &Now, input: f64, y: &[f64], _: &[f64]) -> f64 {
        if self.time > SHORTEST { y[0] } else { input }
    }

    fn fastest(&self) -> f64 {
        1.0 / if self.time * self.second > SHORTEST { self.time * self.second } else { self.time.max(SHORTEST) }
    }
}
