//! A table that tilts as it goes, with clearance in its bearings.

use crate::lab::law::{Law, Now};

const GRAVITY: f64 = 9.80665;

/// The guide.
#[derive(Debug, Clone, Copy)]
pub struct Tilt {
    /// Angle per displacement (rad/m).
    pub angle: f64,
    /// Half the clearance, as a displacement that turns nothing (m).
    pub play: f64,
}

impl Law for Tilt {
    fn memories(&self) -> usize {
        1
    }

    fn at_rest(&self, x: f64, _: &mut [f64], m: &mut [f64]) {
        m[0] = x;
    }

    fn remember(&self, now: &Now, _: f64, _: f64, m: &mut [f64]) {
        m[0] = m[0].clamp(now.x - self.play, now.x + self.play);
    }

    fn out(&self, _: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        input + GRAVITY * (self.angle * m[0]).sin()
    }
}
