//! Everything a user may set, validated as a whole.

use serde::{Deserialize, Serialize};

/// Proportional and integral gain of one feedback loop of Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Gains {
    /// Proportional gain, 1.
    pub proportional: f32,
    /// Integral gain, 1/s.
    pub integral: f32,
}

/// Everything a user may set. A [`crate::Controller`] takes it only when [`Settings::validate`] accepts all of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Control rate, Hz.
    pub rate: f32,
    /// Gains on the displacement error.
    pub displacement: Gains,
    /// Gains on the velocity error, whose sum is integrated once.
    pub velocity: Gains,
    /// Gains on the acceleration error, whose sum is integrated twice.
    pub acceleration: Gains,
    /// Largest speed of the table, m/s.
    pub velocity_limit: f32,
    /// Largest displacement from centre, m.
    pub stroke: f32,
}

/// Why [`Settings`] were refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SettingsError {
    /// A field is not a number, or outside its range.
    OutOfRange {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
        /// Smallest value accepted.
        low: f32,
        /// Largest value accepted.
        high: f32,
    },
}

impl Settings {
    /// Checks every field.
    pub fn validate(&self) -> Result<(), SettingsError> {
        let (value, low, high) = (self.rate, 50.0, 20_000.0);
        if (low..=high).contains(&value) {
            Ok(())
        } else {
            Err(SettingsError::OutOfRange { field: "rate", value, low, high })
        }
    }
}
