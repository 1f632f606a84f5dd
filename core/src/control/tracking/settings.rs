//! What is set of the tracking law, and its check.

use super::disturbance::Disturbance;
use super::flow::{FlowMap, FlowSettings};
use super::friction::{Friction, FrictionSettings};
use super::oil::{OilColumn, OilSettings};
use super::pressure::{PressureDamping, PressureSettings};
use super::trajectory::{ROOM, Stencil};
use super::valve::Valve;
use super::{Actuator, LONGEST_DELAY, Tracking};
use crate::block::{BlockError, require};
use crate::filter::{MotionObserver, SecondOrder};
use core::f32::consts::TAU;

/// Noise of the sensors at each tick, standard deviations: what weighs them against each other.
///
/// ```
/// use shakedown_core::settings::NoiseSettings;
///
/// // An LVDT read in steps of 0.1 mm.
/// let noise = NoiseSettings { displacement: 1e-4 / 12.0_f32.sqrt(), ..NoiseSettings::default() };
/// assert!((noise.displacement - 2.89e-5).abs() < 1e-7);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct NoiseSettings {
    /// LVDT, m; a step's is the step over the root of 12.
    pub displacement: f32,
    /// Accelerometer, m/s2; without one, the accelerations to expect.
    pub acceleration: f32,
}

impl Default for NoiseSettings {
    /// The paper's laboratory: a step of 0.04 mm, 0.02 g.
    fn default() -> Self {
        Self { displacement: 1.15e-5, acceleration: 0.196 }
    }
}

/// A notch in the feedback, for a mode that it must leave alone.
///
/// ```
/// use shakedown_core::settings::{NotchSettings, TrackingSettings};
///
/// // A specimen's mode at 12 Hz that the feedback leaves alone.
/// let notch = Some(NotchSettings { frequency: 12.0, damping: 0.1 });
/// assert!(TrackingSettings { notch, ..TrackingSettings::default() }.notch.is_some());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct NotchSettings {
    /// Hz.
    pub frequency: f32,
    /// Half its width over its frequency, 1.
    pub damping: f32,
}

/// Everything that is set of the tracking law beside the valve's gain, lag and null.
///
/// ```
/// use shakedown_core::settings::TrackingSettings;
/// use shakedown_core::{Controller, Settings};
///
/// let tracking = TrackingSettings { bandwidth: 8.0, ..TrackingSettings::default() };
/// let controller = Controller::new(&Settings { tracking: Some(tracking), ..Settings::default() });
/// assert!(controller.is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct TrackingSettings {
    /// Bandwidth of the feedback, Hz.
    pub bandwidth: f32,
    /// Below this what the model lacks is corrected, Hz.
    pub disturbance: f32,
    /// From command to flow beyond the valve's lag, s.
    pub delay: f32,
    /// Lead of the valve, s: b1 / b0 of Eq. 7.
    pub lead: f32,
    /// Between the points of the reference that its rates are taken from, s.
    pub spacing: f32,
    /// Noise of the sensors.
    pub noise: NoiseSettings,
    /// Flow map.
    pub flow: FlowSettings,
    /// Friction and overlap.
    pub friction: FrictionSettings,
    /// Mode of the oil column; none where it is too stiff to matter.
    pub oil: Option<OilSettings>,
    /// Damping by the pressure difference; none without a sensor.
    pub pressure: Option<PressureSettings>,
    /// Notch in the feedback.
    pub notch: Option<NotchSettings>,
}

impl Default for TrackingSettings {
    /// For the paper's table.
    fn default() -> Self {
        Self {
            bandwidth: 10.0,
            disturbance: 50.0,
            delay: 0.0,
            lead: 0.69 / 138.0,
            spacing: 0.002,
            noise: NoiseSettings::default(),
            flow: FlowSettings::default(),
            friction: FrictionSettings::default(),
            oil: None,
            pressure: None,
            notch: None,
        }
    }
}

/// What the law takes from the settings around it.
///
/// ```
/// use shakedown_core::blocks::tracking::Surroundings;
/// use shakedown_core::settings::TrackingSettings;
///
/// let around = Surroundings { dt: 1e-3, valve: [2.39, 0.0173], command_limit: 0.2, velocity_limit: 0.242 };
/// let law = TrackingSettings::default().law(&around)?;
/// assert_eq!(law.lag(), 6); // three points of 2 ms
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surroundings {
    /// Length of a tick, s.
    pub dt: f32,
    /// Velocity per command, 1/s, and time constant, s, of the valve.
    pub valve: [f32; 2],
    /// Largest command, m.
    pub command_limit: f32,
    /// Largest speed, m/s.
    pub velocity_limit: f32,
}

impl TrackingSettings {
    /// Checks every field and works the law out.
    pub fn law(&self, around: &Surroundings) -> Result<Tracking, BlockError> {
        let (s, dt, limit) = (self, around.dt, around.velocity_limit);
        let stencil = Stencil::new(s.spacing, dt)?;
        let longest = LONGEST_DELAY as f32;
        let delay = (require("tracking.delay", s.delay, 0.0, longest * dt)? / dt + 0.5) as u32;
        // The stencil may not look at the tick that is written next.
        let back = stencil.reach() + delay;
        require("tracking.spacing", s.spacing, 0.0, (ROOM as u32 - 1 - back) as f32 * dt / 3.0)?;
        let actuator = match &s.oil {
            Some(oil) => Actuator::Compliant(OilColumn::new(oil, [s.bandwidth, s.disturbance], limit, dt)?),
            None => Actuator::Stiff {
                bandwidth: TAU * require("tracking.bandwidth", s.bandwidth, 0.0, 0.2 / dt)?,
                disturbance: Disturbance::new(s.disturbance, limit, dt)?,
            },
        };
        let [gain, lag] = around.valve;
        Ok(Tracking {
            stencil,
            back,
            delay,
            half_dt: 0.5 * dt,
            observer: MotionObserver::kalman(s.noise.displacement, s.noise.acceleration, dt)?,
            actuator,
            flow: FlowMap::new(&s.flow, limit, dt)?,
            valve: Valve::new([gain, lag, s.lead], around.command_limit, dt)?,
            friction: Friction::new(&s.friction)?,
            pressure: s.pressure.map(|p| PressureDamping::new(&p, dt)).transpose()?,
            notch: s.notch.map(|n| n.filter(dt)).transpose()?,
        })
    }
}

impl NotchSettings {
    fn filter(self, dt: f32) -> Result<SecondOrder, BlockError> {
        let named = |error: BlockError| match error.field {
            "frequency" => error.named("tracking.notch.frequency"),
            _ => error.named("tracking.notch.damping"),
        };
        SecondOrder::notch(self.frequency, self.damping, dt).map_err(named)
    }
}
