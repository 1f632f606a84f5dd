//! Where a test stands, what an operator asks for, and why it is refused.

use super::Trip;

/// Where a test stands.
///
/// ```
/// use shakedown_core::{Controller, Settings, State};
///
/// // A bare law runs from the first tick; only a guard has states.
/// assert_eq!(Controller::new(&Settings::default())?.state(), State::Running);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[repr(u8)]
pub enum State {
    /// Relay open, no flow asked for.
    #[default]
    Off,
    /// Relay closed, the table held where it stood.
    Ready,
    /// The test runs.
    Running,
    /// The test is faded out and the table held; the reference goes on unheeded.
    Hold,
    /// On the way to a stand, then Ready.
    RampDown,
    /// No flow asked for; relay open.
    Tripped,
}

/// What an operator asks for.
///
/// ```
/// use shakedown_core::settings::GuardSettings;
/// use shakedown_core::{Controller, OperatorRequest, Sample, Settings, State};
///
/// let guarded = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
/// let mut controller = Controller::new(&guarded).unwrap();
/// for _ in 0..10 {
///     controller.step(&Sample::default()); // a table at rest
/// }
/// controller.request(OperatorRequest::Arm).unwrap();
/// controller.request(OperatorRequest::Start).unwrap();
/// assert_eq!(controller.state(), State::Running);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum OperatorRequest {
    /// Off to Ready.
    Arm,
    /// Ready to Running.
    Start,
    /// Running to Hold.
    Hold,
    /// Hold to Running.
    Resume,
    /// Running or Hold to Ready, by way of a ramp.
    Stop,
    /// Ready to Off.
    Off,
    /// Tripped to Off: the deliberate act without which a trip stands.
    Reset,
    /// Anything to Tripped, for what only the board can see: emergency stop, overrun, supply.
    Trip,
}

/// Why a request was not carried out.
///
/// ```
/// use shakedown_core::settings::GuardSettings;
/// use shakedown_core::{Controller, OperatorRequest, Refused, Settings, Trip};
///
/// // No sensor has been read yet, so the table must not be armed.
/// let guarded = Settings { guard: Some(GuardSettings::default()), ..Settings::default() };
/// let mut controller = Controller::new(&guarded)?;
/// assert_eq!(controller.request(OperatorRequest::Arm), Err(Refused::Cause(Trip::SensorLost)));
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// It does not apply in this state.
    State(State),
    /// The safe ramp after the trip has not ended.
    StillMoving(Trip),
    /// The guard sees a reason to trip already.
    Cause(Trip),
    /// There is no guard, and so nothing to ask.
    NoGuard,
}
