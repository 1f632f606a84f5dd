//! Inputs that a table may have beside its sensors: a second displacement sensor, limit switches, the relay's read-back.
//!
//! A switch trips at once. The second sensor trips when it has differed from the LVDT by more than its limit for as long as a
//! reading may be missing, and the relay when its contact has said for longer than its time that it is not where it was told to
//! be: welded, or open with the coil energised. Each says so with the table off as well, and so refuses arming.

use super::Trip;
use crate::block::{BlockError, require, whole_ticks};
use crate::math::Magnitude;
use crate::sample::{Relay, Sample};

/// Which of these inputs are fitted. None are where nothing is said.
///
/// ```
/// use shakedown_core::settings::InputSettings;
///
/// // A second LVDT that may differ by 2 mm, and limit switches.
/// let inputs = InputSettings { second_displacement: Some(0.002), limit_switches: true, ..InputSettings::default() };
/// assert_eq!(inputs.relay_feedback, None);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct InputSettings {
    /// Largest difference between [`Sample::second_displacement`] and the LVDT, m; none without a second sensor.
    pub second_displacement: Option<f32>,
    /// Whether [`Sample::limit_switch`] is read.
    pub limit_switches: bool,
    /// Longest time from a command of the relay to [`Sample::relay_closed`] following, s; none without read-back.
    pub relay_feedback: Option<f32>,
}

/// The monitor's configuration.
///
/// ```
/// use shakedown_core::blocks::guard::InputMonitor;
/// use shakedown_core::settings::InputSettings;
/// use shakedown_core::{Relay, Sample, Trip};
///
/// let settings = InputSettings { limit_switches: true, ..InputSettings::default() };
/// let monitor = InputMonitor::new(&settings, 0.01, 1e-3)?;
/// let at_switch = Sample { limit_switch: true, ..Sample::default() };
/// assert_eq!(monitor.advance(&mut Default::default(), &at_switch, Relay::Closed), Some(Trip::LimitSwitch));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputMonitor {
    difference: Option<Magnitude>,
    lost: u32,
    limit_switches: bool,
    relay: Option<u32>,
}

/// What the monitor remembers: for how many ticks the sensors have differed, and the relay has not followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InputState {
    differed: u32,
    astray: u32,
}

impl InputMonitor {
    /// A monitor of a second sensor that may differ for `lost` (s), at ticks of `dt` (s).
    pub fn new(settings: &InputSettings, lost: f32, dt: f32) -> Result<Self, BlockError> {
        let difference = |limit| require("guard.inputs.second_displacement", limit, 1e-5, 1.0);
        let time = |time| require("guard.inputs.relay_feedback", time, 0.0, 10.0);
        Ok(Self {
            difference: settings.second_displacement.map(difference).transpose()?.map(Magnitude::new),
            lost: whole_ticks(lost, dt),
            limit_switches: settings.limit_switches,
            relay: settings.relay_feedback.map(time).transpose()?.map(|time| whole_ticks(time, dt)),
        })
    }

    /// One tick: what the inputs say, with the relay told to be `told`.
    #[inline]
    pub fn advance(&self, state: &mut InputState, readings: &Sample, told: Relay) -> Option<Trip> {
        if self.limit_switches && readings.limit_switch {
            return Some(Trip::LimitSwitch);
        }
        if let Some(limit) = self.difference {
            let differs = !limit.holds(readings.second_displacement - readings.displacement);
            state.differed = if differs { state.differed.saturating_add(1) } else { 0 };
            if state.differed > self.lost {
                return Some(Trip::SensorsDisagree);
            }
        }
        let time = self.relay?;
        let astray = readings.relay_closed != (told == Relay::Closed);
        state.astray = if astray { state.astray.saturating_add(1) } else { 0 };
        (state.astray > time).then_some(Trip::RelayAstray)
    }
}
