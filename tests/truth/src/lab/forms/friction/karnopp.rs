//! Karnopp: within a band about zero velocity the contact sticks and balances what drives it, up to its break-away level.

use super::Levels;
use crate::lab::law::{Law, Now};

/// The contact.
#[derive(Debug, Clone, Copy)]
pub struct Karnopp {
    levels: Levels,
    band: f64,
}

impl Karnopp {
    /// A contact that sticks below `band` (m/s).
    pub fn new(levels: Levels, band: f64) -> Self {
        Self { levels, band }
    }
}

impl Law for Karnopp {
    fn out(&self, now: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        let sliding = now.v.signum() * self.levels.at(now.v);
        let share = (now.v.abs() / self.band).min(1.0);
        if share >= 1.0 {
            return input + sliding;
        }
        // What drives it is balanced and the velocity that is left decays within a few milliseconds.
        let held = (now.drive - input + 300.0 * now.v).clamp(-self.levels.breakaway, self.levels.breakaway);
        // The outer half of the band blends the two, or the force would jump at its edge.
        let blend = (2.0 * share - 1.0).max(0.0);
        input + (1.0 - blend) * held + blend * sliding
    }

    fn fastest(&self) -> f64 {
        600.0
    }
}
