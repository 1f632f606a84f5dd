//! What sticks and what overlaps: friction of the bearings, deadband of the spool.
//!
//! ```text
//! f = c v + Fc sat(v / v1)                                    force per table mass, m/s2
//! u <- u + half_width sat(u / (half_width / 4))               m
//! ```
//! Signs as velocity's and command's. `sat` is the identity held within +/- 1: a sign would chatter.

use crate::block::{BlockError, require};
use crate::scalar::Scalar;

/// What is known of friction and overlap. Zeros switch off.
///
/// ```
/// use shakedown_core::settings::FrictionSettings;
///
/// // Coulomb friction of 0.3 m/s2 and an overlap of 1 mm.
/// let friction = FrictionSettings { coulomb: 0.3, deadband: 0.001, ..FrictionSettings::default() };
/// assert_eq!(friction.viscous, 0.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct FrictionSettings {
    /// Coulomb friction per table mass, m/s2.
    pub coulomb: f32,
    /// Viscous friction per table mass, 1/s.
    pub viscous: f32,
    /// Velocity at which the Coulomb friction is whole, m/s.
    pub velocity: f32,
    /// Command on either side of zero that opens nothing, m.
    pub deadband: f32,
}

impl Default for FrictionSettings {
    fn default() -> Self {
        Self { coulomb: 0.0, viscous: 0.0, velocity: 0.005, deadband: 0.0 }
    }
}

/// The configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::Friction;
/// use shakedown_core::settings::FrictionSettings;
///
/// let friction = Friction::new(&FrictionSettings { coulomb: 0.3, deadband: 0.001, ..FrictionSettings::default() })?;
/// assert_eq!(friction.force(0.1), 0.3);
/// assert_eq!(friction.open(0.002), 0.003); // beyond the overlap
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    coulomb: f32,
    viscous: f32,
    per_velocity: f32,
    deadband: f32,
    per_knee: f32,
}

impl Friction {
    /// Checks and works out `settings`.
    pub fn new(settings: &FrictionSettings) -> Result<Self, BlockError> {
        let s = settings;
        let deadband = require("tracking.friction.deadband", s.deadband, 0.0, 1.0)?;
        Ok(Self {
            coulomb: require("tracking.friction.coulomb", s.coulomb, 0.0, 100.0)?,
            viscous: require("tracking.friction.viscous", s.viscous, 0.0, 1000.0)?,
            per_velocity: 1.0 / require("tracking.friction.velocity", s.velocity, 1e-6, 1.0)?,
            deadband,
            per_knee: if deadband > 0.0 { 4.0 / deadband } else { 0.0 },
        })
    }

    /// The force per mass to expect at `velocity` (m/s), m/s2.
    #[inline]
    pub fn force(&self, velocity: f32) -> f32 {
        self.viscous * velocity + self.coulomb * (velocity * self.per_velocity).bounded(1.0)
    }

    /// The command (m) that opens the spool as `command` would without overlap.
    #[inline]
    pub fn open(&self, command: f32) -> f32 {
        command + self.deadband * (command * self.per_knee).bounded(1.0)
    }
}
