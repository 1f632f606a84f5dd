//! What goes into a tick and what comes out of it.

use crate::guard::{State, Trip};

/// What the sensors and the reference say at one tick. Plain numbers in SI, as they come: the controller decides what
/// it can believe. Which of the optional ones are read is a matter of the settings; the others may hold anything.
///
/// ```
/// use shakedown_core::Sample;
///
/// // The reference asks for 10 mm, the LVDT reads 9 mm, and a pressure sensor is fitted.
/// let sample = Sample { pressure_difference: 2e6, ..Sample::new(0.01, 0.009, 0.3) };
/// assert_eq!(sample.displacement, 0.009);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Reference displacement, m. Read in modifier and controller mode.
    pub reference: f32,
    /// Table displacement from the LVDT, m.
    pub displacement: f32,
    /// Table acceleration, m/s2. Read where an accelerometer is fitted.
    pub acceleration: f32,
    /// The existing controller's command, m. Read in guard mode.
    pub external: f32,
    /// Table velocity from a sensor of its own, m/s. Read where the velocity source is the sensor.
    pub velocity: f32,
    /// Pressure difference across the piston, Pa. Read where a force limit is set.
    pub pressure_difference: f32,
    /// Reference velocity, m/s. Read where the rates are supplied.
    pub reference_velocity: f32,
    /// Reference acceleration, m/s2. Read where the rates are supplied.
    pub reference_acceleration: f32,
    /// Table displacement from a second sensor, m. Read where one is fitted.
    pub second_displacement: f32,
    /// Whether the table is at a limit switch. Read where there are any.
    pub limit_switch: bool,
    /// Whether the relay's contact reads closed. Read where there is read-back.
    pub relay_closed: bool,
}

impl Sample {
    /// Reference (m), LVDT (m) and accelerometer (m/s2); the rest zero.
    pub const fn new(reference: f32, displacement: f32, acceleration: f32) -> Self {
        Self {
            reference,
            displacement,
            acceleration,
            external: 0.0,
            velocity: 0.0,
            pressure_difference: 0.0,
            reference_velocity: 0.0,
            reference_acceleration: 0.0,
            second_displacement: 0.0,
            limit_switch: false,
            relay_closed: false,
        }
    }
}

/// A set of the channels of a [`Sample`].
///
/// ```
/// use shakedown_core::Channels;
///
/// let sensors = Channels::DISPLACEMENT.union(Channels::ACCELERATION);
/// assert!(sensors.intersects(Channels::DISPLACEMENT));
/// assert!(!sensors.intersects(Channels::REFERENCE));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Channels(u8);

impl Channels {
    /// No channel.
    pub const NONE: Self = Self(0);
    /// Reference displacement.
    pub const REFERENCE: Self = Self(1);
    /// LVDT.
    pub const DISPLACEMENT: Self = Self(2);
    /// Accelerometer.
    pub const ACCELERATION: Self = Self(4);
    /// Existing controller's command.
    pub const EXTERNAL: Self = Self(8);
    /// Velocity sensor.
    pub const VELOCITY: Self = Self(16);
    /// Pressure difference.
    pub const PRESSURE_DIFFERENCE: Self = Self(32);
    /// Velocity and acceleration of the reference.
    pub const REFERENCE_RATES: Self = Self(64);
    /// Second displacement sensor.
    pub const SECOND_DISPLACEMENT: Self = Self(128);

    /// Whether any channel of `other` is in this set.
    #[inline]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether this is no channel at all.
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The channels of either set.
    #[inline]
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The set as bits, in the order of the constants, for telemetry.
    pub const fn bits(self) -> u8 {
        self.0
    }
}

/// What the relay of the hydraulic block is to do.
///
/// ```
/// use shakedown_core::settings::GuardSettings;
/// use shakedown_core::{Controller, Relay, Settings};
///
/// // A guarded controller opens its relay until it is armed.
/// let guarded = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
/// assert_eq!(Controller::new(&guarded)?.relay(), Relay::Open);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Relay {
    /// De-energised: no oil reaches the valve.
    #[default]
    Open,
    /// Energised.
    Closed,
}

/// What happened during a tick, beside the command itself.
///
/// ```
/// use shakedown_core::{Channels, Controller, Sample, Settings};
///
/// let mut controller = Controller::new(&Settings::default())?;
/// controller.step(&Sample::new(0.01, 0.0, 0.0));
/// let held = controller.step(&Sample::new(0.01, f32::NAN, 0.0)).status;
/// assert!(held.held && held.missing == Channels::DISPLACEMENT);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Status {
    /// The table's velocity is at its limit.
    pub saturated: bool,
    /// An input that is needed was not a number or out of range: the last good output was held.
    pub held: bool,
    /// Which inputs.
    pub missing: Channels,
    /// The command is at its limit.
    pub limited: bool,
    /// The velocity limit now in force, m/s: the set one, or less where saturation showed less.
    pub velocity_limit: f32,
    /// Where the test stands; always running without a guard.
    pub state: State,
    /// Why the guard tripped, until it is reset.
    pub trip: Option<Trip>,
    /// The relay of the hydraulic block; always closed without a guard.
    pub relay: Relay,
}

impl Default for Status {
    fn default() -> Self {
        Self {
            saturated: false,
            held: false,
            missing: Channels::NONE,
            limited: false,
            velocity_limit: 0.0,
            state: State::Running,
            trip: None,
            relay: Relay::Closed,
        }
    }
}

impl Status {
    /// The status in 16 bits, for telemetry: bit 0 saturated, 1 held, 2 limited, 3 relay closed; 4 to 6 the state; 8 to 12 the
    /// trip, 0 for none.
    pub fn bits(&self) -> u16 {
        let flags = [self.saturated, self.held, self.limited, self.relay == Relay::Closed];
        let mut bits = flags.iter().rev().fold(0, |bits, &flag| bits << 1 | u16::from(flag));
        bits |= (self.state as u16) << 4;
        bits | self.trip.map_or(0, |trip| trip as u16) << 8
    }
}

/// What the valve is told.
///
/// ```
/// use shakedown_core::{Controller, Sample, Settings};
///
/// let command = Controller::new(&Settings::default())?.step(&Sample::new(0.01, 0.0, 0.0));
/// assert_eq!(command.reference, 0.01);
/// assert!(command.valve > 0.0); // toward the reference
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// What goes out, m: the valve command; in modifier mode the reference handed to the existing controller.
    pub valve: f32,
    /// The reference after the test's ramps and record modification, m.
    pub reference: f32,
    /// What happened.
    pub status: Status,
}
