//! Whether the sensors can be believed: each by itself, and both against the observer.
//!
//! ```text
//! n = lag(|innovation|, 50 ms),   m = lag(innovation, 50 ms)
//! ```
//! `n > disagreement`: LVDT and accelerometer contradict each other where most of n is m, and else the LVDT is noisy.
//! An offset of the accelerometer beyond `offset`, as the observer learns it: they contradict each other too. A quarter of
//! the disagreement is enough against a sensor that has not changed by a bit for `stuck`: it is that one. A table at rest
//! with quiet sensors changes nothing and trips nothing. How noisy a sensor may be by itself: [`super::noise`].
//!
//! Readings that the walls refused for longer than `lost`: open, saturated or dead.

use super::Trip;
use crate::block::{Block, BlockError, require, whole_ticks};
use crate::filter::Lag;
use crate::filter::MotionState;
use crate::filter::lag::LagState;
use crate::math::Magnitude;

/// When a sensor is not believed.
///
/// ```
/// use shakedown_core::settings::PlausibilitySettings;
///
/// // An LVDT of 10 um resolution is stuck when it has not changed for 50 ms.
/// let settings = PlausibilitySettings { stuck: 0.05, ..PlausibilitySettings::default() };
/// assert_eq!(settings.lost, 0.01);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct PlausibilitySettings {
    /// How long a reading may be missing, s.
    pub lost: f32,
    /// How long a reading may stay the same to the last bit while the other sensor moves, s.
    pub stuck: f32,
    /// Largest mean magnitude of the observer's innovation, m.
    pub disagreement: f32,
    /// Largest offset that the accelerometer can have, m/s2.
    pub offset: f32,
    /// Largest mean change of acceleration from tick to tick, above 1 kHz of its mean from millisecond to millisecond, that is noise
    /// and not motion, m/s2.
    pub acceleration_noise: f32,
}

impl Default for PlausibilitySettings {
    fn default() -> Self {
        Self { lost: 0.01, stuck: 0.02, disagreement: 2e-3, offset: 3.0, acceleration_noise: 3.0 }
    }
}

/// The monitor's configuration.
///
/// ```
/// use shakedown_core::Trip;
/// use shakedown_core::blocks::filter::MotionState;
/// use shakedown_core::blocks::guard::Plausibility;
/// use shakedown_core::settings::PlausibilitySettings;
///
/// let monitor = Plausibility::new(&PlausibilitySettings::default(), 1e-3)?;
/// // An accelerometer whose offset has gone to 5 m/s2.
/// let observed = MotionState { offset: 5.0, ..MotionState::default() };
/// let doubted = monitor.advance(&mut Default::default(), 0.0, 5.0, &observed);
/// assert_eq!(doubted, Some(Trip::SensorsDisagree));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plausibility {
    stuck: u32,
    suspicious: f32,
    disagreement: f32,
    offset: Magnitude,
    mean: Lag,
}

/// What the monitor remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlausibilityState {
    displacement: f32,
    acceleration: f32,
    displacement_same: u32,
    acceleration_same: u32,
    innovation: LagState,
    innovation_size: LagState,
}

impl Plausibility {
    /// A monitor at ticks of `dt` (s).
    pub fn new(settings: &PlausibilitySettings, dt: f32) -> Result<Self, BlockError> {
        let s = settings;
        let disagreement = require("guard.plausibility.disagreement", s.disagreement, 1e-6, 1.0)?;
        Ok(Self {
            stuck: whole_ticks(require("guard.plausibility.stuck", s.stuck, 0.0, 10.0)?, dt),
            suspicious: 0.25 * disagreement,
            disagreement,
            offset: Magnitude::new(require("guard.plausibility.offset", s.offset, 0.01, 1e3)?),
            mean: Lag::new(0.05, dt)?,
        })
    }

    /// One turn: both readings, displacement (m) and acceleration (m/s2), and what the observer made of them. Gives what to doubt.
    pub fn advance(
        &self,
        state: &mut PlausibilityState,
        displacement: f32,
        acceleration: f32,
        observed: &MotionState,
    ) -> Option<Trip> {
        state.displacement_same = count(state.displacement_same, displacement == state.displacement);
        state.acceleration_same = count(state.acceleration_same, acceleration == state.acceleration);
        state.displacement = displacement;
        state.acceleration = acceleration;

        self.mean.advance(&mut state.innovation, observed.innovation);
        let innovation = self.mean.advance(&mut state.innovation_size, observed.innovation.abs());
        let accused = if innovation > self.suspicious { self.accuse(state, innovation) } else { None };
        accused.or((!self.offset.holds(observed.offset)).then_some(Trip::SensorsDisagree))
    }

    /// Which sensor it is, given a suspicious mean magnitude of the `innovation` (m).
    fn accuse(&self, state: &PlausibilityState, innovation: f32) -> Option<Trip> {
        if state.displacement_same > self.stuck {
            Some(Trip::DisplacementStuck)
        } else if state.acceleration_same > self.stuck {
            Some(Trip::AccelerationStuck)
        } else if innovation > self.disagreement {
            let one_sided = self.mean.last(&state.innovation).abs() > 0.5 * innovation;
            Some(if one_sided { Trip::SensorsDisagree } else { Trip::DisplacementNoisy })
        } else {
            None
        }
    }
}

#[inline]
fn count(so_far: u32, goes_on: bool) -> u32 {
    if goes_on { so_far.saturating_add(1) } else { 0 }
}
