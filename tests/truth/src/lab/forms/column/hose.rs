//! A column whose oil carries air: it stiffens with pressure, and its damping is that of a pipe with turbulent friction.

use crate::lab::law::{Column, Now};
use std::f64::consts::TAU;

/// The column.
#[derive(Debug, Clone, Copy)]
pub struct Airy {
    /// Frequency at the size of the pressures (Hz).
    pub frequency: f64,
    /// Damping ratio (1).
    pub damping: f64,
    /// Share by which it is softer at rest (1).
    pub air: f64,
    /// Size of the pressures (m/s2).
    pub size: f64,
}

impl Column for Airy {
    fn states(&self) -> usize {
        1
    }

    fn spring(&self, _: &Now, y: &[f64]) -> f64 {
        let k = (TAU * self.frequency).powi(2);
        let linear = k * y[0];
        let filled = (linear / self.size).powi(2);
        linear * (1.0 - self.air / (1.0 + filled))
    }

    fn rates(&self, now: &Now, q: f64, lost: f64, v: f64, y: &[f64], dy: &mut [f64]) -> f64 {
        let w = TAU * self.frequency;
        let rate = q - lost - v;
        dy[0] = rate;
        let scale = 0.3 * self.size / w;
        self.spring(now, y) + 2.0 * self.damping * w * rate * (0.7 + 0.6 * rate.abs() / (rate.abs() + scale))
    }

    fn fastest(&self) -> f64 {
        2.0 * TAU * self.frequency
    }

    fn relaxation(&self) -> f64 {
        TAU * self.frequency / (2.0 * 0.7 * self.damping)
    }
}
