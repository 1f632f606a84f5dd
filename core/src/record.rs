//! Records modified while the test runs, so that the table is never told to go where or as fast as it cannot.
//!
//! Write e = `v_ref` - v for the velocity given up. Every modifier keeps the velocity within its limit, so e stays inside
//! the tube `v_ref - v_max <= e <= v_ref + v_max`, and the acceleration error is e'. The three differ in how much of the
//! reference they have seen when they choose e':
//!
//! - [`clip`]: Eq. 10 of the paper. e returns to zero the moment the tube allows it, so every excess over the limit is
//!   paid twice, and the displacement it leaves behind is never made up.
//! - [`causal`]: no preview. e rests unless the tube pushes it (the play operator, which has the least variation any
//!   causal choice can have), bleeds off through a slow washout of velocity and displacement, and, once the reference
//!   has been seen to exceed the limit, the swing is compressed before the wall instead of cut at it.
//! - [`preview`]: a buffer of the reference. e' is the taut string's through the part of the tube in view, which is the
//!   least acceleration error that part allows, in every convex norm at once.
//!
//! All keep two walls whatever arrives: the velocity limit in force, which saturation detection may lower from one tick
//! to the next, and a stroke that is never entered faster than the table can brake inside it (not [`clip`], which is the
//! paper's and knows no stroke).
//!
//! Velocities are kept in metres a tick, where the limits are the integrator's own increments and cost no rounding.

pub(crate) mod causal;
pub(crate) mod clip;
mod input;
pub(crate) mod preview;
mod travel;

use crate::settings::SettingsError;

/// What the table allows, as the modifiers need it.
///
/// ```
/// use shakedown_core::blocks::record::ReferenceLimits;
///
/// // 1 kHz, 0.242 m/s, 120 mm to either side.
/// assert!(ReferenceLimits::new(1000.0, 0.242, 0.12).validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ReferenceLimits {
    /// Control rate, Hz.
    pub rate: f32,
    /// Largest speed, m/s. What [`causal::step`] and the others are told later may lower it, never raise it.
    pub velocity: f32,
    /// Largest displacement from centre, m.
    pub stroke: f32,
    /// Deceleration with which the table is brought to rest before the end of its stroke, m/s2.
    pub braking: f32,
    /// A reference that moves faster than this, m/s, has leapt: it is taken as an offset to wash out, not as a motion.
    pub leap: f32,
}

impl ReferenceLimits {
    /// ReferenceLimits with the project's braking (1 m/s2: 29 mm of stroke at 0.242 m/s) and leap (5 m/s, above any ground
    /// motion on record).
    pub const fn new(rate: f32, velocity: f32, stroke: f32) -> Self {
        Self { rate, velocity, stroke, braking: 1.0, leap: 5.0 }
    }

    /// Checks every field.
    pub fn validate(&self) -> Result<(), SettingsError> {
        within("rate", self.rate, 50.0, 20_000.0)?;
        within("velocity", self.velocity, 1e-4, 10.0)?;
        within("stroke", self.stroke, 1e-4, 10.0)?;
        within("braking", self.braking, 0.01, 100.0)?;
        within("leap", self.leap, self.velocity, 1000.0)
    }
}

/// How what was given up is made good: the displacement error e obeys e'' + 2 zeta w e' + w^2 e = 0 wherever no limit
/// acts, so the drift it leaves at the end is zero.
///
/// ```
/// use shakedown_core::blocks::record::{DriftRecovery, causal};
///
/// assert_eq!(causal::Config::DRIFT_RECOVERY, DriftRecovery { frequency: 0.4, damping: 0.8 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct DriftRecovery {
    /// Natural frequency w / 2 pi, Hz.
    pub frequency: f32,
    /// Damping ratio zeta, 1.
    pub damping: f32,
}

impl DriftRecovery {
    /// Checks every field against the control rate, Hz.
    pub fn validate(self, rate: f32) -> Result<(), SettingsError> {
        within("frequency", self.frequency, 1e-3, rate / 100.0)?;
        within("damping", self.damping, 0.3, 2.0)
    }

    /// Share of the velocity error and of the displacement error that is taken back in one tick.
    fn shares(self, rate: f32) -> (f32, f32) {
        let angle = core::f32::consts::TAU * self.frequency / rate;
        (2.0 * self.damping * angle, angle * angle)
    }
}

/// Accepts `value` between `low` and `high`.
fn within(field: &'static str, value: f32, low: f32, high: f32) -> Result<(), SettingsError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(SettingsError::OutOfRange { field, value, low, high }) }
}
