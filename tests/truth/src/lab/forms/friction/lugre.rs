//! `LuGre`: bristles `z' = v - s0 |v| z / g(v)`, force `s0 z + s1 z'`.

use super::Levels;
use crate::lab::law::{Law, Now};

/// The contact.
#[derive(Debug, Clone, Copy)]
pub struct LuGre {
    levels: Levels,
    stiffness: f64,
    damping: f64,
}

impl LuGre {
    /// A contact that slides after bending by `presliding` (m).
    pub fn new(levels: Levels, presliding: f64) -> Self {
        let stiffness = levels.sliding.max(1e-9) / presliding;
        Self { levels, stiffness, damping: 0.6 * levels.sliding }
    }

    fn rate(&self, v: f64, z: f64) -> f64 {
        v - self.stiffness * v.abs() / self.levels.at(v) * z
    }
}

impl Law for LuGre {
    fn memories(&self) -> usize {
        1
    }

    /// Exact at constant velocity: stiff bristles need no short steps.
    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        let settled = now.v.signum() * self.levels.at(now.v) / self.stiffness;
        let pace = self.stiffness * now.v.abs() / self.levels.at(now.v);
        m[0] = settled + (m[0] - settled) * (-pace * h).exp();
    }

    fn out(&self, now: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        // Micro-damping that fades with speed, or it would be viscous friction while the bristles turn.
        let fading = (-(now.v / self.levels.stribeck).powi(2)).exp();
        input + self.stiffness * m[0] + self.damping * fading * self.rate(now.v, m[0])
    }
}
