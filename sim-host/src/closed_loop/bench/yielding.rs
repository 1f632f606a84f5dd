//! A one-storey structure on the table whose columns yield: the payload of the benchmark that no linear model has.
//!
//! ```text
//! f = mu (w^2 (r (x - x_s) + (1 - r) g) + 2 zeta w (v - v_s)),   x_s'' = f / mu
//! g' = (v - v_s) (1 - |g / y|^2 [g (v - v_s) > 0])                    Bouc and Wen, exponent 2
//! ```
//! g the elastic part of the drift, held near `y` (m) in yielding; r the stiffness left after it.

use crate::plant::effects::{Effect, Hooks, Instant};

/// The structure.
#[derive(Debug, Clone)]
pub(super) struct YieldingPayload {
    /// Its mass over the table's, 1.
    pub(super) mass_ratio: f64,
    /// Frequency before yielding, rad/s.
    pub(super) frequency: f64,
    /// Damping ratio, 1.
    pub(super) damping: f64,
    /// Drift at which it yields, m.
    pub(super) drift: f64,
    /// Stiffness after yielding over that before, 1.
    pub(super) left: f64,
}

impl Effect<f64> for YieldingPayload {
    fn hooks(&self) -> Hooks {
        Hooks { force: true, ..Hooks::default() }
    }

    fn fastest(&self) -> f64 {
        self.frequency
    }

    fn states(&self) -> usize {
        3
    }

    fn rest(&self, displacement: f64, y: &mut [f64]) {
        if let Some(first) = y.first_mut() {
            *first = displacement;
        }
    }

    fn force(&self, at: &Instant<f64>, y: &[f64], dy: &mut [f64]) -> f64 {
        let (&[place, speed, elastic], [place_rate, speed_rate, elastic_rate]) = (y, dy) else { return 0.0 };
        let (drift, rate) = (at.displacement - place, at.velocity - speed);
        let w2 = self.frequency * self.frequency;
        let spring = w2 * (self.left * drift + (1.0 - self.left) * elastic);
        let push = spring + 2.0 * self.damping * self.frequency * rate;
        *place_rate = speed;
        *speed_rate = push;
        let share = if elastic * rate > 0.0 { (elastic / self.drift).powi(2) } else { 0.0 };
        *elastic_rate = rate * (1.0 - share);
        push * self.mass_ratio
    }
}
