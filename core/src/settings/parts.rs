//! The parts of [`Settings`](super::Settings): gains, mode, sources, observer, valve, ranges.

/// Proportional and integral gain of one feedback loop of Fig. 12.
///
/// ```
/// use shakedown_core::settings::Gains;
///
/// let gains = Gains::new(3.7, 0.6);
/// assert_eq!((gains.proportional, gains.integral), (3.7, 0.6));
/// ```
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
///
/// ```
/// use shakedown_core::{Controller, Mode, Sample, Settings};
///
/// // Behind an existing controller its command passes through.
/// let mut guard = Controller::new(&Settings { mode: Mode::Guard, ..Settings::default() })?;
/// let command = guard.step(&Sample { external: 0.02, ..Sample::default() });
/// assert_eq!(command.valve, 0.02);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
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
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::ReferenceRates;
///
/// let settings = Settings { reference_rates: ReferenceRates::Derived { frequency: 50.0 }, ..Settings::default() };
/// assert!(settings.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum ReferenceRates {
    /// Differentiated from the modified reference ([`crate::blocks::filter::Differentiator`]).
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
///
/// ```
/// use shakedown_core::settings::VelocitySource;
///
/// assert_eq!(VelocitySource::default(), VelocitySource::Observer);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum VelocitySource {
    /// The observer ([`crate::blocks::filter::MotionObserver`]).
    #[default]
    Observer,
    /// A velocity sensor, as [`crate::Sample::velocity`].
    Sensor,
}

/// The observer of the table's velocity.
///
/// ```
/// use shakedown_core::settings::ObserverSettings;
///
/// // No accelerometer is fitted.
/// let observer = ObserverSettings { accelerometer: false, ..ObserverSettings::default() };
/// assert_eq!(observer.frequency, 2.0);
/// ```
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
///
/// ```
/// use shakedown_core::settings::ValveSettings;
///
/// // The paper's table: 2.4 m/s per metre of command, 17 ms.
/// let valve = ValveSettings::default();
/// assert!((valve.gain - 2.39).abs() < 0.01 && (valve.lag - 0.0173).abs() < 1e-4);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct ValveSettings {
    /// Velocity per command at rest, 1/s: b0 / a1 of Eq. 7.
    pub gain: f32,
    /// Time constant of the velocity, s: 1 / a1 of Eq. 7.
    pub lag: f32,
    /// Command at which no oil flows, m, beside what the inner loop asks for.
    pub null_bias: f32,
    /// Largest command either way, beyond the one at which no oil flows, m. Under a guard, but in modifier mode, no more than
    /// `(velocity_limit + lag guard.envelope.acceleration) / gain`: more moves the table no faster and stops it later.
    pub command_limit: f32,
}

impl Default for ValveSettings {
    fn default() -> Self {
        Self { gain: 138.0 / 57.65, lag: 1.0 / 57.65, null_bias: 0.0, command_limit: 10.0 }
    }
}

/// Largest readings that can be true, either way from zero. A reading beyond is not used: the last good output is held.
///
/// ```
/// use shakedown_core::settings::Ranges;
/// use shakedown_core::{Controller, Sample, Settings};
///
/// let ranges = Ranges { displacement: 0.15, ..Ranges::default() };
/// let mut controller = Controller::new(&Settings { ranges, ..Settings::default() })?;
/// controller.step(&Sample::default());
/// assert!(controller.step(&Sample::new(0.0, 0.2, 0.0)).status.held); // 0.2 m cannot be true
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
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
