//! How a device is wired: what its codes mean, what it stands in for, and which output gives zero flow.

use serde::{Deserialize, Serialize};

use crate::settings::{Settings, SettingsError};

/// A straight line between converter codes and SI units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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

/// What the device does in the valve command path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Role {
    /// Passes the existing controller's command on, watches it, and takes over at a limit.
    Guard,
    /// Stands in front of an existing controller and hands it a reference that the table can follow.
    Modifier,
    /// Is the controller: reference and sensors in, valve command out.
    Controller,
}

/// Where the reference comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Source {
    /// The reference input of the converter.
    Analog,
    /// The host, through the link, ahead of time.
    Streamed,
}

/// Which output stops the oil, given how the valve is driven.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum SafeOutput {
    /// The valve amplifier takes the command as flow: its zero stops it.
    Zero,
    /// A hard-wired inner loop (Fig. 2), or an existing position controller, subtracts the LVDT from the command: the
    /// LVDT's reading stops it. From 0.1 m off centre a zero would drive the table at 0.21 m/s.
    Displacement,
}

/// What the converters' codes mean.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Wiring {
    /// Role in the valve command path.
    pub role: Role,
    /// Where the reference comes from.
    pub source: Source,
    /// Reference input, m.
    pub reference: Scale,
    /// LVDT input, m.
    pub displacement: Scale,
    /// Accelerometer input, m/s2.
    pub acceleration: Scale,
    /// The existing controller's command, m.
    pub command: Scale,
    /// Output, m per code.
    pub output: Scale,
    /// Largest code of the converters: 4095 on chip, 65535 outboard.
    pub full_scale: u16,
    /// Which output stops the oil.
    pub safe: SafeOutput,
    /// Time from any output to the safe one, s.
    pub safe_ramp: f32,
    /// Whether an incoming code at either end of the range means a broken wire (4 to 20 mA, or a biased +/-10 V input).
    pub rail_is_fault: bool,
}

/// Everything a device keeps in flash: the core's settings and the wiring.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Setup {
    /// What the core is set to.
    pub control: Settings,
    /// How the device is wired.
    pub wiring: Wiring,
    /// A record of telemetry every so many ticks; 0 sends none.
    pub telemetry_every: u16,
}

/// Why a [`Setup`] was refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// The core refuses its settings.
    Control(SettingsError),
    /// A field of the wiring is not a number, or outside its range.
    Wiring {
        /// The field's name.
        field: &'static str,
        /// What was given.
        value: f32,
    },
}

impl Setup {
    /// Checks every field. A device takes a setup only when all of it holds.
    pub fn validate(&self) -> Result<(), SetupError> {
        self.control.validate().map_err(SetupError::Control)?;
        let wiring = &self.wiring;
        let scales = [
            ("reference", wiring.reference),
            ("displacement", wiring.displacement),
            ("acceleration", wiring.acceleration),
            ("command", wiring.command),
            ("output", wiring.output),
        ];
        for (field, scale) in scales {
            require(field, scale.zero, scale.zero.is_finite())?;
            let slope = scale.per_code;
            require(field, slope, slope.is_finite() && slope.abs() > 1e-12 && slope.abs() < 1e3)?;
        }
        require("full_scale", f32::from(wiring.full_scale), wiring.full_scale >= 255)?;
        require("safe_ramp", wiring.safe_ramp, (0.0..=10.0).contains(&wiring.safe_ramp))
    }
}

fn require(field: &'static str, value: f32, holds: bool) -> Result<(), SetupError> {
    if holds { Ok(()) } else { Err(SetupError::Wiring { field, value }) }
}
