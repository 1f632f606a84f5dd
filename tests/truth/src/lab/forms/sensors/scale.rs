//! A bridge whose gain and offset are off, and change as it warms.

use crate::lab::law::{Law, Now};

/// The bridge.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    /// Gain (1).
    pub gain: f64,
    /// Offset (m/s2).
    pub offset: f64,
    /// Share by which gain error and offset change while warming (1).
    pub warming: f64,
    /// Time constant of it (s).
    pub time: f64,
}

impl Law for Scale {
    fn out(&self, now: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        let warm = 1.0 + self.warming * (1.0 - (-now.t / self.time).exp());
        (1.0 + (self.gain - 1.0) * warm) * input + self.offset * warm
    }
}
