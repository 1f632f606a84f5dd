//! A table mass that is pushed by whichever side of the gap it touches: dead zone, contact spring and damper, a little drag of
//! the guide.

use crate::lab::law::{Law, Now};
use std::f64::consts::TAU;

/// The joint.
#[derive(Debug, Clone, Copy)]
pub struct Contact {
    /// Full gap (m).
    pub gap: f64,
    /// Frequency of the table on the contact (Hz).
    pub frequency: f64,
    /// Damping ratio of the contact (1).
    pub damping: f64,
}

/// Drag of the guide on the table (1/s) and its dry part (m/s2).
const DRAG: (f64, f64) = (10.0, 0.5);

impl Law for Contact {
    fn states(&self) -> usize {
        2
    }

    fn rates(&self, _: &Now, input: f64, y: &[f64], _: &[f64], dy: &mut [f64]) {
        let w = TAU * self.frequency;
        let (place, speed) = (y[0], y[1]);
        let depth = (place.abs() - 0.5 * self.gap).max(0.0) * place.signum();
        // The damper works as far as the contact is closed.
        let closed = (depth.abs() / (0.05 * self.gap + 1e-7)).min(1.0);
        let push = w * w * depth + 2.0 * self.damping * w * closed * (input - speed);
        dy[0] = input - speed;
        dy[1] = push - DRAG.0 * speed - DRAG.1 * (speed / 1e-3).tanh();
    }

    fn out(&self, _: &Now, _: f64, y: &[f64], _: &[f64]) -> f64 {
        y[1]
    }

    fn fastest(&self) -> f64 {
        2.0 * TAU * self.frequency
    }
}
