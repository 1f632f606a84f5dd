//! Leuven: a hysteresis in displacement with non-local memory before sliding, a Stribeck curve while sliding.
//! `z' = v (1 - sgn(F_d/s) |F_d/s|^n)`, `F_h = F_b + F_d(z)`: the transition curve begins anew at each reversal.

use super::Levels;
use crate::lab::law::{Law, Now};

/// The contact. Memories: force at the last reversal, travel since then, direction, level at hand.
#[derive(Debug, Clone, Copy)]
pub struct Leuven {
    levels: Levels,
    presliding: f64,
}

impl Leuven {
    /// A contact with a virgin curve `F = s(v) (1 - exp(-z/presliding))^0.7` (m).
    pub fn new(levels: Levels, presliding: f64) -> Self {
        Self { levels, presliding }
    }

    /// The transition curve from 0 to 1 over the travel.
    fn curve(&self, travel: f64) -> f64 {
        (1.0 - (-travel / self.presliding).exp()).powf(0.7)
    }

    fn force(&self, m: &[f64]) -> f64 {
        let level = if m[3] > 0.0 { m[3] } else { self.levels.breakaway };
        // From the force at the reversal to the sliding level on the other side, doubled as Masing's rule has it.
        let span = m[2] * level - m[0];
        let stretch = (span.abs() / level).max(0.2);
        m[0] + span * self.curve(m[1] / stretch)
    }
}

impl Law for Leuven {
    fn memories(&self) -> usize {
        4
    }

    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        let direction = now.v.signum();
        if now.v != 0.0 && direction != m[2] {
            let here = self.force(m);
            m[0] = if m[2] == 0.0 { 0.0 } else { here };
            m[1] = 0.0;
            m[2] = direction;
        }
        m[1] = (m[1] + now.v.abs() * h).min(100.0 * self.presliding);
        // The level follows the Stribeck curve within a millisecond: frictional lag.
        let level = self.levels.at(now.v);
        m[3] = if m[3] > 0.0 { level + (m[3] - level) * (-h / 1e-3).exp() } else { level };
    }

    fn out(&self, _: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        input + self.force(m)
    }
}
