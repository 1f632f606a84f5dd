//! Pressure-difference damping: flow against the changes of the load pressure that the reference does not ask for.
//!
//! ```text
//! h[k] = rho h[k-1] + g (e[k] - e[k-1]),   e = area p_L / mass - a_r        washout, m/s2
//! q = -gain h                                                               m/s
//! ```
//! gain in s (velocity per acceleration), the washout's corner in Hz: a steady load, a table's friction or a tilt, costs no
//! stiffness. On an oil column of natural frequency w it adds `gain w / 2` to the damping ratio.

use crate::block::{Block, BlockError, require};
use crate::filter::Washout;
use crate::filter::washout::WashoutState;

/// What is known of the sensor and wanted of the damping.
///
/// ```
/// use shakedown_core::settings::{PressureSettings, TrackingSettings};
///
/// let pressure = Some(PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 });
/// assert!(TrackingSettings { pressure, ..TrackingSettings::default() }.pressure.is_some());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct PressureSettings {
    /// Piston area over moving mass, m2/kg.
    pub area_per_mass: f32,
    /// Velocity taken off per acceleration of the load, s.
    pub gain: f32,
    /// Corner below which a load is left alone, Hz.
    pub corner: f32,
}

/// The configuration.
///
/// ```
/// use shakedown_core::blocks::filter::WashoutState;
/// use shakedown_core::blocks::tracking::PressureDamping;
/// use shakedown_core::settings::PressureSettings;
///
/// let damping = PressureDamping::new(&PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 }, 1e-3)?;
/// // A load pressure that nobody asked for is given way to.
/// assert!(damping.advance(&mut WashoutState::default(), 1e6, 0.0) < 0.0);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressureDamping {
    area_per_mass: f32,
    gain: f32,
    washout: Washout,
}

impl PressureDamping {
    /// The damping at ticks of `dt` (s).
    pub fn new(settings: &PressureSettings, dt: f32) -> Result<Self, BlockError> {
        let washout = Washout::new(settings.corner, dt).map_err(|error| error.named("tracking.pressure.corner"))?;
        let area_per_mass = require("tracking.pressure.area_per_mass", settings.area_per_mass, 1e-9, 1.0)?;
        let gain = require("tracking.pressure.gain", settings.gain, 0.0, 1.0)?;
        Ok(Self { area_per_mass, gain, washout })
    }

    /// One tick: pressure difference (Pa) and acceleration wanted (m/s2) in, flow (m/s) out.
    #[inline]
    pub fn advance(&self, state: &mut WashoutState, pressure_difference: f32, acceleration: f32) -> f32 {
        let load = self.area_per_mass * pressure_difference;
        -(self.gain * self.washout.advance(state, load - acceleration))
    }
}
