//! Mains pick-up with a third harmonic, whose size breathes.

use crate::lab::law::{Law, Now};
use std::f64::consts::TAU;

/// The pick-up.
#[derive(Debug, Clone, Copy)]
pub struct Hum {
    /// Frequency (Hz).
    pub frequency: f64,
    /// Amplitude (m/s2).
    pub amplitude: f64,
    /// Third harmonic over the fundamental (1).
    pub third: f64,
    /// Share by which the size breathes (1).
    pub breath: f64,
}

impl Law for Hum {
    fn out(&self, now: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        // Every run begins somewhere else in the period.
        let phase = 2.4 * now.run as f64;
        let angle = TAU * self.frequency * now.t + phase;
        let size = self.amplitude * (1.0 + self.breath * (0.4 * now.t + phase).sin());
        input + size * (angle.sin() + self.third * (3.0 * angle + 1.0).sin())
    }
}
