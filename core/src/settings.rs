//! Everything a user may set, validated as a whole.
//!
//! The same type is read from TOML on the host and from a frame on the device. A [`crate::Controller`] takes it only
//! when [`Settings::validate`] accepts all of it; what is accepted at one end is accepted at the other, because it is the
//! same check.

mod consistency;
mod error;
mod findings;
mod named;
mod parts;
mod validate;

pub use error::{NameError, SettingsError};
pub use findings::Finding;
pub use parts::{Gains, Mode, ObserverSettings, Ranges, ReferenceRates, ValveSettings, VelocitySource};

pub use crate::control::InnerLoop;
pub use crate::control::tracking::flow::FlowSettings;
pub use crate::control::tracking::friction::FrictionSettings;
pub use crate::control::tracking::oil::OilSettings;
pub use crate::control::tracking::pressure::PressureSettings;
pub use crate::control::tracking::{NoiseSettings, NotchSettings, TrackingSettings};
pub use crate::guard::envelope::{EnvelopeSettings, ForceSettings};
pub use crate::guard::inputs::InputSettings;
pub use crate::guard::plausibility::PlausibilitySettings;
pub use crate::guard::valve::ValveMonitorSettings;
pub use crate::guard::witness::WitnessSettings;
pub use crate::guard::{GuardSettings, RampSettings};
pub use crate::modifier::{Modification, PREVIEW_PLACES, PREVIEW_WINDOW};
pub use crate::saturation::Detection;

/// Everything a user may set. What is left out of a file has the default's value: the paper's current controller,
/// bare, at 1 kHz.
///
/// ```
/// use shakedown_core::settings::Gains;
/// use shakedown_core::{Mode, Settings};
///
/// let mut settings = Settings { displacement: Gains::new(5.0, 0.5), ..Settings::default() };
/// settings.read("velocity_limit = 0.2\n[valve]\nnull_bias = 0.001").unwrap();
/// assert_eq!((settings.mode, settings.valve.null_bias), (Mode::Controller, 0.001));
/// settings.validate()?;
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
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

    /// Largest command either way beyond the one at which no oil flows, m: `valve.command_limit`, and where a guard stands before a
    /// valve no more than its model needs for full speed and the envelope's acceleration at once.
    ///
    /// ```text
    /// (velocity_limit + lag envelope.acceleration) / gain
    /// ```
    /// A command beyond moves the table no faster, but winds up the lag of the valve, and after a trip the table goes on at full
    /// speed for `lag ln(command / wide open)`. Behind the device an existing loop has a gain of its own, which is not known.
    pub(crate) fn command_limit(&self) -> f32 {
        let valve = &self.valve;
        match &self.guard {
            Some(guard) if self.mode != Mode::Modifier => {
                let asked = self.velocity_limit + valve.lag * guard.envelope.acceleration;
                crate::math::min(valve.command_limit, asked / valve.gain)
            }
            _ => valve.command_limit,
        }
    }

    /// The speed that the table reaches both ways, m/s: what a modified reference keeps to.
    pub(crate) fn slower_limit(&self) -> f32 {
        self.velocity_limit * crate::math::min(self.tracking.map_or(1.0, |tracking| tracking.flow.asymmetry), 1.0)
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
