//! The guard: what lies between any law, ours or another's, and the actuator.

pub(crate) mod creep;
pub(crate) mod envelope;
mod gain;
pub(crate) mod input_gate;
pub(crate) mod inputs;
pub(crate) mod noise;
pub(crate) mod plausibility;
pub(crate) mod still;
pub(crate) mod supervisor;
mod test_state;
pub(crate) mod valve;
pub(crate) mod witness;

pub(crate) use creep::Creep;
pub(crate) use envelope::{Envelope, EnvelopeSettings};
pub(crate) use input_gate::InputGate;
pub(crate) use inputs::{InputMonitor, InputSettings, InputState};
pub(crate) use noise::{NoiseMonitor, NoiseState};
pub(crate) use plausibility::{Plausibility, PlausibilitySettings};
pub(crate) use still::{StillMonitor, StillState};
pub(crate) use supervisor::Supervisor;
pub use test_state::{OperatorRequest, Refused, State};
pub(crate) use valve::{ValveMonitor, ValveMonitorSettings, ValveMonitorState};
pub(crate) use witness::{DisplacementWitness, WitnessSettings, WitnessState};

/// Everything the guard needs to be told.
///
/// ```
/// use shakedown_core::Settings;
/// use shakedown_core::settings::{EnvelopeSettings, GuardSettings};
///
/// let envelope = EnvelopeSettings { velocity: 0.25, ..EnvelopeSettings::default() };
/// let guard = GuardSettings { envelope, ..GuardSettings::default() };
/// assert!(Settings { guard: Some(guard), ..Settings::default() }.validate().is_ok());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct GuardSettings {
    /// Where the table may be and how it may move.
    pub envelope: EnvelopeSettings,
    /// When a sensor is not believed.
    pub plausibility: PlausibilitySettings,
    /// When LVDT and accelerometer contradict each other over a window.
    pub witness: WitnessSettings,
    /// When the valve is not believed.
    pub valve: ValveMonitorSettings,
    /// Which inputs there are beside the sensors.
    pub inputs: InputSettings,
    /// How the test starts, holds and ends.
    pub ramps: RampSettings,
}

/// How long things take.
///
/// ```
/// use shakedown_core::settings::{GuardSettings, RampSettings};
///
/// // Fade a test in and out over 5 s.
/// let guard = GuardSettings { ramps: RampSettings { test: 5.0, ..RampSettings::default() }, ..GuardSettings::default() };
/// assert_eq!(guard.ramps.safe, 0.05);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct RampSettings {
    /// From a stand into the reference, and back, s.
    pub test: f32,
    /// From any command to the one at which no oil flows, at a trip, s.
    pub safe: f32,
}

impl Default for RampSettings {
    fn default() -> Self {
        Self { test: 2.0, safe: 0.05 }
    }
}

/// Why the guard tripped.
///
/// ```
/// use shakedown_core::settings::GuardSettings;
/// use shakedown_core::{Controller, OperatorRequest, Sample, Settings, Trip};
///
/// let guarded = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
/// let mut controller = Controller::new(&guarded)?;
/// controller.step(&Sample::default());
/// controller.request(OperatorRequest::Trip).unwrap(); // the emergency stop
/// assert_eq!(controller.trip(), Some(Trip::External));
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[repr(u8)]
#[non_exhaustive]
pub enum Trip {
    /// The table could no longer be stopped inside its stroke.
    Displacement = 1,
    /// Faster than the envelope allows.
    Velocity,
    /// Acceleration beyond the envelope.
    Acceleration,
    /// Jerk beyond the envelope.
    Jerk,
    /// Force of the actuator beyond the envelope.
    Force,
    /// The table is too far from the reference it was given.
    Tracking,
    /// A channel was not a number or out of range for too long: open wire, saturated amplifier, dead converter.
    SensorLost,
    /// The LVDT did not change while the accelerometer showed motion.
    DisplacementStuck,
    /// The accelerometer did not change while the LVDT showed motion.
    AccelerationStuck,
    /// LVDT and accelerometer contradict each other.
    SensorsDisagree,
    /// The LVDT is noisier than it can be.
    DisplacementNoisy,
    /// The accelerometer is noisier than it can be.
    AccelerationNoisy,
    /// The table does not do what the valve is told: stuck, shut or hard over; or its LVDT creeps.
    ValveStuck,
    /// The law's own state was not a number: it was reset.
    Internal,
    /// Asked for from outside: emergency stop, overrun, supply.
    External,
    /// The table is at a limit switch.
    LimitSwitch,
    /// The relay's contact is not where its coil was told to be: welded, or open with the coil energised.
    RelayAstray,
}

impl Trip {
    /// Whether the valve is not believed after this trip: no command is then known to stop the table, whatever the wiring.
    pub(crate) fn doubts_valve(self) -> bool {
        matches!(self, Self::ValveStuck)
    }

    /// Whether the LVDT is not believed after this trip. A loop that subtracts it then has no output that is known to be zero flow.
    pub(crate) fn doubts_displacement(self) -> bool {
        matches!(self, Self::DisplacementStuck | Self::DisplacementNoisy | Self::SensorsDisagree)
    }
}
