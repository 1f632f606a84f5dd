//! The control core set up as a controller of Table 1.

use super::published::{Gains, Named};
use shakedown_core::{Settings, settings};

/// The core's settings for these gains at `rate` (Hz): bare, as the paper's controllers are, with no anti-windup and no
/// guard.
pub fn settings(gains: Gains, rate: f64) -> Settings {
    let pair = |(proportional, integral): (f64, f64)| settings::Gains {
        proportional: proportional as f32,
        integral: integral as f32,
    };
    Settings {
        rate: rate as f32,
        displacement: pair(gains.displacement),
        velocity: pair(gains.velocity),
        acceleration: pair(gains.acceleration),
        velocity_limit: 0.242,
        stroke: 0.12,
        ..Settings::default()
    }
}

impl Named {
    /// The core's settings for this controller at `rate` (Hz).
    pub fn settings(self, rate: f64) -> Settings {
        settings(self.gains(), rate)
    }
}
