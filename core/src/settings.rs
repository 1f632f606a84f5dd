//! Everything a user may set, validated as a whole.
//!
//! The same type is read from TOML on the host and from a frame on the device. A [`crate::Controller`] takes it only
//! when [`Settings::validate`] accepts all of it; what is accepted at one end is accepted at the other, because it is the
//! same check.

mod consistency;
mod error;
mod findings;
mod named;
mod validate;

pub use error::SettingsError;
pub use findings::Finding;
pub use named::NameError;

use crate::control::{InnerLoop, TrackingSettings};
use crate::guard::GuardSettings;
pub use crate::modifier::{Modification, PREVIEW_PLACES, PREVIEW_WINDOW};
use crate::saturation::Detection;

/// Proportional and integral gain of one feedback loop of Fig. 12.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Gains {
    /// Proportional gain, 1.
    pub proportional: f32,
    /// Integral gain, 1/s.
    pub integral: f32,
}

impl Gains {
    /// `proportional` (1) and `integral` (1/s).
    pub const fn new(proportional: f32, integral: f32) -> Self {
        Self { proportional, integral }
    }

    /// Whether the loop does anything.
    pub(crate) fn act(self) -> bool {
        self.proportional != 0.0 || self.integral != 0.0
    }
}

/// Where the device sits in the valve command path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Mode {
    /// Behind an existing controller: passes its command on, detects saturation, enforces limits.
    Guard,
    /// In front of an existing controller: reference in, reference that the table can follow out.
    Modifier,
    /// Instead of one: reference and sensors in, valve command out.
    #[default]
    Controller,
}

/// Where the velocity and acceleration of the reference come from, for the loops that track them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum ReferenceRates {
    /// Differentiated from the modified reference ([`crate::filter::Differentiator`]).
    Derived {
        /// Band of the differentiators, Hz; from rate / pi on they are backward differences.
        frequency: f32,
    },
    /// Backward differences of the modified reference.
    #[default]
    Differences,
    /// With each sample, as [`crate::Sample::reference_velocity`] and [`crate::Sample::reference_acceleration`]; not
    /// modified.
    Supplied,
    /// Zero: pure feedback, which damps instead of tracking.
    Zero,
}

/// Where the measured velocity comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum VelocitySource {
    /// The observer ([`crate::filter::MotionObserver`]).
    #[default]
    Observer,
    /// A velocity sensor, as [`crate::Sample::velocity`].
    Sensor,
}

/// The observer of the table's velocity.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct ObserverSettings {
    /// Below this the LVDT is believed, above it the accelerometer, Hz.
    pub frequency: f32,
    /// Whether an accelerometer is fitted; without one [`crate::Sample::acceleration`] is not read.
    pub accelerometer: bool,
    /// Time constant of the low-pass on the acceleration that saturation detection and guard look at, s.
    pub smoothing: f32,
}

impl Default for ObserverSettings {
    fn default() -> Self {
        Self { frequency: 2.0, accelerometer: true, smoothing: 0.006 }
    }
}

/// What is known of the servovalve and its actuator, for what must know how the table will answer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct ValveSettings {
    /// Velocity per command at rest, 1/s: b0 / a1 of Eq. 7.
    pub gain: f32,
    /// Time constant of the velocity, s: 1 / a1 of Eq. 7.
    pub lag: f32,
    /// Command at which no oil flows, m, beside what the inner loop asks for.
    pub null_bias: f32,
    /// Largest command either way, beyond the one at which no oil flows, m.
    pub command_limit: f32,
}

impl Default for ValveSettings {
    fn default() -> Self {
        Self { gain: 138.0 / 57.65, lag: 1.0 / 57.65, null_bias: 0.0, command_limit: 10.0 }
    }
}

/// Largest readings that can be true, either way from zero. A reading beyond is not used: the last good output is held.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct Ranges {
    /// Reference displacement, m.
    pub reference: f32,
    /// LVDT, m.
    pub displacement: f32,
    /// Velocity sensor and supplied reference velocity, m/s.
    pub velocity: f32,
    /// Accelerometer and supplied reference acceleration, m/s2.
    pub acceleration: f32,
    /// Existing controller's command, m.
    pub external: f32,
    /// Pressure difference, Pa.
    pub pressure_difference: f32,
}

impl Default for Ranges {
    fn default() -> Self {
        Self {
            reference: 10.0,
            displacement: 10.0,
            velocity: 20.0,
            acceleration: 1000.0,
            external: 100.0,
            pressure_difference: 1e8,
        }
    }
}

/// Everything a user may set. What is left out of a file has the default's value: the paper's current controller,
/// bare, at 1 kHz.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct Settings {
    /// Control rate, Hz, 50 to 20,000. A device's board has a bound of its own, which it states in
    /// [`crate::link::Identity::highest_rate`].
    pub rate: f32,
    /// Place in the valve command path.
    pub mode: Mode,
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
    /// What the output drives: the valve, or a hard-wired loop that has to be cancelled.
    pub inner_loop: InnerLoop,
    /// Whether integrators stop while the valve or the command is at its limit.
    pub anti_windup: bool,
    /// How the reference is modified.
    pub modification: Modification,
    /// Velocity and acceleration of the reference.
    pub reference_rates: ReferenceRates,
    /// Velocity of the table.
    pub velocity_source: VelocitySource,
    /// Corner of the acceleration loop's washout, Hz.
    pub washout_frequency: f32,
    /// The observer.
    pub observer: ObserverSettings,
    /// The valve.
    pub valve: ValveSettings,
    /// What readings can be true.
    pub ranges: Ranges,
    /// Time over which a change of settings or of mode is blended in, s.
    pub blend: f32,
    /// The tracking law, in controller mode in place of the three loops; none leaves them.
    pub tracking: Option<TrackingSettings>,
    /// Detection of velocity saturation; none does not look for it.
    pub saturation: Option<Detection>,
    /// The guard; none leaves the law bare, running from the first tick, for simulation and for fitting.
    pub guard: Option<GuardSettings>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            rate: 1000.0,
            mode: Mode::Controller,
            displacement: Gains::new(3.70205, 0.61701),
            velocity: Gains::new(0.0, 0.0),
            acceleration: Gains::new(0.0, 0.0),
            velocity_limit: 0.242,
            stroke: 0.12,
            inner_loop: InnerLoop::Absent,
            anti_windup: false,
            modification: Modification::Off,
            reference_rates: ReferenceRates::Differences,
            velocity_source: VelocitySource::Observer,
            washout_frequency: 0.05,
            observer: ObserverSettings::default(),
            valve: ValveSettings::default(),
            ranges: Ranges::default(),
            blend: 0.1,
            tracking: None,
            saturation: None,
            guard: None,
        }
    }
}

impl Settings {
    /// The output at which no oil flows with the LVDT at `displacement` (m), m: what a loop behind the device subtracts, and
    /// the valve's null bias where the valve is the device's own.
    pub fn zero_flow(&self, displacement: f32) -> f32 {
        let null_bias = if self.mode == Mode::Modifier { 0.0 } else { self.valve.null_bias };
        self.cancellation() * displacement + null_bias
    }

    /// The share of the LVDT's reading that a loop behind the device subtracts, 1. An existing position controller does, and its
    /// own null bias is not ours to know.
    pub(crate) fn cancellation(&self) -> f32 {
        if self.mode == Mode::Modifier { 1.0 } else { self.inner_loop.cancellation(1.0) }
    }

    /// Whether a second displacement sensor is fitted.
    pub(crate) fn reads_second_displacement(&self) -> bool {
        self.guard.is_some_and(|guard| guard.inputs.second_displacement.is_some())
    }

    /// Whether anything looks at the pressure difference.
    pub(crate) fn reads_pressure(&self) -> bool {
        let limits = self.guard.is_some_and(|guard| guard.envelope.force.is_some());
        limits || self.tracking.is_some_and(|tracking| tracking.pressure.is_some())
    }
}
