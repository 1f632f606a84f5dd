//! What a device's converter codes mean, and the whole of what it keeps.

use serde::{Deserialize, Serialize};

use crate::settings::{Settings, SettingsError};

/// A straight line between converter codes and SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scale {
    /// Code at zero, which may lie between two codes or outside the converter's range.
    pub zero: f32,
    /// SI units per code; negative where the wiring inverts.
    pub per_code: f32,
}

impl Scale {
    /// What `code` stands for, in the channel's SI unit.
    #[inline]
    pub fn to_si(&self, code: u16) -> f32 {
        (f32::from(code) - self.zero) * self.per_code
    }
}

/// Where the reference comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The reference input of the converter.
    Analog,
    /// The host, through the link, ahead of time.
    Streamed,
}

/// What the converters' codes mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wiring {
    /// Where the reference comes from.
    pub source: Source,
    /// Reference input, m.
    pub reference: Scale,
    /// LVDT input, m.
    pub displacement: Scale,
    /// Accelerometer input, m/s2.
    pub acceleration: Scale,
    /// The existing controller's command, m.
    pub external: Scale,
    /// Output, m.
    pub output: Scale,
    /// Largest code of the converters: 4095 on chip, 65535 outboard.
    pub full_scale: u16,
    /// Whether a code at either end of the range is no reading: with a signal biased to the middle, a broken wire, a
    /// short or a saturated amplifier ends there.
    pub rails_are_faults: bool,
}

/// Everything a device keeps in flash: the core's settings and the wiring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// A record of telemetry every so many ticks; 0 sends none.
    pub telemetry_every: u16,
    /// How the device is wired.
    pub wiring: Wiring,
    /// What the core is set to.
    pub control: Settings,
}

/// Why a [`Setup`] was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// The core refuses its settings.
    Control(SettingsError),
    /// There is no guard: a device does not run without.
    NoGuard,
    /// A field of the wiring is not a number, or outside its range.
    Wiring {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
    },
}

impl core::fmt::Display for SetupError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Control(error) => write!(f, "control.{error}"),
            Self::NoGuard => write!(f, "control.guard is missing: a device does not run without one"),
            Self::Wiring { field, value } => write!(f, "wiring.{field} is {value}, which no converter can have"),
        }
    }
}

impl core::error::Error for SetupError {}

impl Setup {
    /// Checks every field. A device takes a setup only when all of it holds.
    pub fn validate(&self) -> Result<(), SetupError> {
        self.control.validate().map_err(SetupError::Control)?;
        if self.control.guard.is_none() {
            return Err(SetupError::NoGuard);
        }
        let wiring = &self.wiring;
        let scales = [
            ("reference", wiring.reference),
            ("displacement", wiring.displacement),
            ("acceleration", wiring.acceleration),
            ("external", wiring.external),
            ("output", wiring.output),
        ];
        for (field, scale) in scales {
            require(field, scale.zero, scale.zero.is_finite())?;
            let slope = scale.per_code;
            require(field, slope, slope.is_finite() && slope.abs() > 1e-12 && slope.abs() < 1e3)?;
        }
        require("full_scale", f32::from(wiring.full_scale), wiring.full_scale >= 255)
    }
}

fn require(field: &'static str, value: f32, holds: bool) -> Result<(), SetupError> {
    if holds { Ok(()) } else { Err(SetupError::Wiring { field, value }) }
}
