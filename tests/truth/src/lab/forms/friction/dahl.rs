//! Dahl's curve with an exponent: `F' = s0 v (1 - F/Fc sgn v)^n`.

use super::Levels;
use crate::lab::law::{Law, Now};

/// The contact.
#[derive(Debug, Clone, Copy)]
pub struct Dahl {
    level: f64,
    stiffness: f64,
    exponent: f64,
}

impl Dahl {
    /// A contact that slides after bending by a few times `presliding` (m). The exponent is 1.5: softer before sliding.
    pub fn new(levels: Levels, presliding: f64) -> Self {
        Self { level: levels.sliding, stiffness: levels.sliding.max(1e-9) / presliding, exponent: 1.5 }
    }
}

impl Law for Dahl {
    fn memories(&self) -> usize {
        1
    }

    /// With `r = 1 - F/Fc sgn v`: `r' = -s0 |v| / Fc r^n`, in closed form.
    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        let sign = now.v.signum();
        let r = (1.0 - sign * m[0] / self.level).max(0.0);
        if r == 0.0 {
            return;
        }
        let travel = self.stiffness * now.v.abs() * h / self.level;
        let grown = r.powf(1.0 - self.exponent) + (self.exponent - 1.0) * travel;
        m[0] = sign * self.level * (1.0 - grown.powf(-1.0 / (self.exponent - 1.0)));
    }

    fn out(&self, _: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        input + m[0]
    }
}
