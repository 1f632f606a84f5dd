//! The envelope: where the table may be and how it may move, with the distance it needs to stop.
//!
//! ```text
//! d = v latency + v |v| / (2 deceleration)                             stopping distance in the direction of v, m
//! |x + d| > stroke - margin   or   |x| > stroke - margin   or   |v| > velocity          trips at once
//! ```
//! Acceleration, jerk, actuator force and distance from the reference trip when one or another of them has been beyond
//! its limit for `persistence` without a break. Acceleration comes low-passed from the observer and is
//! differenced for jerk; force is the pressure difference times the piston's area.

use super::Trip;
use crate::block::{BlockError, require, whole_ticks};
use crate::math::{Magnitude, max, min};

/// Largest force of the actuator and how it is measured.
///
/// ```
/// use shakedown_core::settings::{EnvelopeSettings, ForceSettings};
///
/// // At most 280 kN on a piston of 0.024 m2: 11.7 MPa.
/// let force = ForceSettings { limit: 280e3, piston_area: 0.024 };
/// let envelope = EnvelopeSettings { force: Some(force), ..EnvelopeSettings::default() };
/// assert!(envelope.force.is_some());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct ForceSettings {
    /// Largest force, N.
    pub limit: f32,
    /// Area of the piston, m2.
    pub piston_area: f32,
}

/// Limits of the envelope. The stroke is the settings' own.
///
/// ```
/// use shakedown_core::settings::EnvelopeSettings;
///
/// let slow = EnvelopeSettings { velocity: 0.1, acceleration: 5.0, ..EnvelopeSettings::default() };
/// assert_eq!(slow.margin, 0.005);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
pub struct EnvelopeSettings {
    /// Room kept free at each end of the stroke, m.
    pub margin: f32,
    /// From a trip to the table slowing down, s: the valve's lag and the safe ramp.
    pub stopping_latency: f32,
    /// Slowing down from then on, m/s2.
    pub stopping_deceleration: f32,
    /// Largest speed, m/s.
    pub velocity: f32,
    /// Largest acceleration, m/s2.
    pub acceleration: f32,
    /// Largest jerk, m/s3.
    pub jerk: f32,
    /// Largest force; none where no pressure is measured.
    pub force: Option<ForceSettings>,
    /// Largest distance between table and reference, m; not judged in guard mode.
    pub tracking: f32,
    /// How long acceleration, jerk, force and tracking may be beyond, s.
    pub persistence: f32,
}

impl Default for EnvelopeSettings {
    fn default() -> Self {
        Self {
            margin: 0.005,
            stopping_latency: 0.05,
            stopping_deceleration: 5.0,
            velocity: 0.3,
            acceleration: 30.0,
            jerk: 5000.0,
            force: None,
            tracking: 0.2,
            persistence: 0.02,
        }
    }
}

impl EnvelopeSettings {
    /// Farthest from the middle that a reference may come which brakes with `braking` (m/s2) from at most `speed` (m/s) on a table of
    /// this `stroke` (m), m: a table that follows it can be stopped inside the envelope at every moment. Half of the margin is left for
    /// a table that is not quite where its reference is; never less than a tenth of the stroke.
    ///
    /// ```text
    /// reach + d(v) - v^2 / (2 braking) <= stroke - margin for every v up to speed         d: stopping distance, see above
    /// ```
    pub(crate) fn reach(&self, stroke: f32, speed: f32, braking: f32) -> f32 {
        // What the envelope needs beyond what the reference brakes in, v latency - bend v^2, is largest at the top of its parabola.
        let bend = 0.5 / braking - 0.5 / self.stopping_deceleration;
        let top = 0.5 * self.stopping_latency / bend;
        let worst = if (0.0..speed).contains(&top) { top } else { speed };
        let beyond = worst * (self.stopping_latency - bend * worst);
        min(max(stroke - 1.5 * self.margin - max(beyond, 0.0), 0.1 * stroke), stroke)
    }
}

/// What of the table's motion may be beyond its limit for a while.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DebouncedSignals {
    /// Acceleration, low-passed, m/s2.
    pub acceleration: f32,
    /// Pressure difference, Pa.
    pub pressure_difference: f32,
    /// Reference less displacement, m.
    pub error: f32,
}

/// The envelope's configuration.
///
/// ```
/// use shakedown_core::Trip;
/// use shakedown_core::blocks::guard::Envelope;
/// use shakedown_core::settings::EnvelopeSettings;
///
/// let envelope = Envelope::new(&EnvelopeSettings::default(), 0.12, 1e-3)?;
/// assert_eq!(envelope.left_by(0.0, 0.1), None);
/// // 10 mm before the end of the stroke at 0.2 m/s there is no room left to stop in.
/// assert_eq!(envelope.left_by(0.11, 0.2), Some(Trip::Displacement));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    latency: f32,
    half_inverse_deceleration: f32,
    room: Magnitude,
    velocity: Magnitude,
    acceleration: Magnitude,
    jerk_step: Magnitude,
    pressure: Magnitude,
    tracking: Magnitude,
    persistence: u32,
}

/// What the envelope remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnvelopeState {
    acceleration: f32,
    lasted: u32,
}

impl Envelope {
    /// An envelope inside `stroke` (m) at ticks of `dt` (s).
    pub fn new(settings: &EnvelopeSettings, stroke: f32, dt: f32) -> Result<Self, BlockError> {
        let s = settings;
        let margin = require("guard.envelope.margin", s.margin, 0.0, 0.9 * stroke)?;
        let deceleration = require("guard.envelope.stopping_deceleration", s.stopping_deceleration, 0.01, 1000.0)?;
        let pressure = match s.force {
            Some(force) => {
                require("guard.envelope.force.limit", force.limit, 1.0, 1e9)?
                    / require("guard.envelope.force.piston_area", force.piston_area, 1e-6, 10.0)?
            }
            None => f32::INFINITY,
        };
        Ok(Self {
            room: Magnitude::new(stroke - margin),
            latency: require("guard.envelope.stopping_latency", s.stopping_latency, 0.0, 10.0)?,
            half_inverse_deceleration: 0.5 / deceleration,
            velocity: Magnitude::new(require("guard.envelope.velocity", s.velocity, 1e-3, 100.0)?),
            acceleration: Magnitude::new(require("guard.envelope.acceleration", s.acceleration, 0.01, 1e4)?),
            jerk_step: Magnitude::new(require("guard.envelope.jerk", s.jerk, 0.1, 1e7)? * dt),
            pressure: Magnitude::new(pressure),
            tracking: Magnitude::new(require("guard.envelope.tracking", s.tracking, 1e-4, 100.0)?),
            persistence: whole_ticks(require("guard.envelope.persistence", s.persistence, 0.0, 10.0)?, dt),
        })
    }

    /// Distance in which the table comes to rest from `velocity` (m/s), in its direction, m.
    #[inline]
    pub fn stopping_distance(&self, velocity: f32) -> f32 {
        velocity * (self.latency + velocity.abs() * self.half_inverse_deceleration)
    }

    /// How fast a table slows down that stops, m/s2.
    pub(crate) fn stopping_deceleration(&self) -> f32 {
        0.5 / self.half_inverse_deceleration
    }

    /// Whether a table at `displacement` (m) with `velocity` (m/s) can no longer be stopped inside, or is too fast: why.
    pub fn left_by(&self, displacement: f32, velocity: f32) -> Option<Trip> {
        let rest = displacement + self.stopping_distance(velocity);
        if !self.room.holds(rest) || !self.room.holds(displacement) {
            Some(Trip::Displacement)
        } else if !self.velocity.holds(velocity) {
            Some(Trip::Velocity)
        } else {
            None
        }
    }

    /// The same without a limit on the distance from the reference.
    #[must_use]
    pub(crate) const fn without_tracking(self) -> Self {
        Self { tracking: Magnitude::new(f32::INFINITY), ..self }
    }

    /// One turn of what may last: the limit that has been passed for `persistence`, if one has.
    pub fn advance(&self, state: &mut EnvelopeState, motion: &DebouncedSignals) -> Option<Trip> {
        let jerk_step = motion.acceleration - state.acceleration;
        state.acceleration = motion.acceleration;
        let beyond = if !self.acceleration.holds(motion.acceleration) {
            Trip::Acceleration
        } else if !self.jerk_step.holds(jerk_step) {
            Trip::Jerk
        } else if !self.pressure.holds(motion.pressure_difference) {
            Trip::Force
        } else if !self.tracking.holds(motion.error) {
            Trip::Tracking
        } else {
            state.lasted = 0;
            return None;
        };
        state.lasted = state.lasted.saturating_add(1);
        (state.lasted > self.persistence).then_some(beyond)
    }
}
