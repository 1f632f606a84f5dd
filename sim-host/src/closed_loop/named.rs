//! The control core set up by name: as a controller of Table 1, or with the tracking law.

use super::design::Table;
use super::published::{Named, PublishedGains};
use shakedown_core::settings::{self, VelocitySource};
use shakedown_core::{Modification, Settings};

/// Name of the tracking law, set for the paper's table.
pub(crate) const TRACKING: &str = "tracking";

/// Every controller's name.
pub(crate) fn names() -> Vec<&'static str> {
    Named::ALL.iter().map(|named| named.name()).chain([TRACKING]).collect()
}

/// The core's settings for the controller of this name at `rate` (Hz).
pub(crate) fn by_name(name: &str, rate: f64) -> Option<Settings> {
    if name == TRACKING {
        return Some(Table::default().settings(rate));
    }
    Named::parse(name).map(|named| named.settings(rate))
}

/// Control rate of the paper's controllers here, Hz.
pub(crate) const RATE: f64 = 1000.0;

/// The core's settings for these gains at `rate` (Hz): bare, as the paper's controllers are, with no anti-windup and no
/// guard. Velocity comes from a sensor of its own, as the paper's velocity loop asks for; the reference's velocity and
/// acceleration are its differences.
pub fn settings(gains: PublishedGains, rate: f64) -> Settings {
    let pair = |(proportional, integral): (f64, f64)| settings::Gains::new(proportional as f32, integral as f32);
    Settings {
        rate: rate as f32,
        displacement: pair(gains.displacement),
        velocity: pair(gains.velocity),
        acceleration: pair(gains.acceleration),
        velocity_source: VelocitySource::Sensor,
        ..Settings::default()
    }
}

impl Named {
    /// The core's settings for this controller at `rate` (Hz).
    pub fn settings(self, rate: f64) -> Settings {
        let modification = if self == Self::Modified { Modification::Clip } else { Modification::Off };
        Settings { modification, ..settings(self.gains(), rate) }
    }
}
