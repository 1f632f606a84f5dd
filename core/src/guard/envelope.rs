//! The envelope: where the table may be and how it may move, with the distance it needs to stop.
//!
//! ```text
//! d = |v| latency + v^2 / (2 deceleration)                stopping distance, m
//! x sgn(v) + d > stroke - margin   or   |x| > stroke - margin          trips at once
//! ```
//! Velocity, acceleration, jerk, actuator force and distance from the reference trip when one or another of them has
//! been beyond its limit for `persistence` without a break. Acceleration is low-passed (`smoothing`) before it is
//! judged and differenced for jerk; force is the pressure difference times the piston's area.

use serde::{Deserialize, Serialize};

use super::Trip;
use crate::block::{Block, BlockError, require};
use crate::filter::Lag;
use crate::filter::lag::LagState;

/// Largest force of the actuator and how it is measured.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ForceSettings {
    /// Largest force, N.
    pub limit: f32,
    /// Area of the piston, m2.
    pub piston_area: f32,
}

/// Limits of the envelope. The stroke is the settings' own.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
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
    /// How long velocity, acceleration, jerk, force and tracking may be beyond, s.
    pub persistence: f32,
    /// Time constant of the acceleration's low-pass, s.
    pub smoothing: f32,
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
            smoothing: 0.005,
        }
    }
}

/// How the table moves at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Displacement, m.
    pub displacement: f32,
    /// Velocity, m/s.
    pub velocity: f32,
    /// Acceleration, m/s2.
    pub acceleration: f32,
    /// Pressure difference, Pa.
    pub pressure_difference: f32,
    /// Reference less displacement, m.
    pub error: f32,
}

/// The envelope's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Envelope {
    room: f32,
    latency: f32,
    half_inverse_deceleration: f32,
    velocity: f32,
    acceleration: f32,
    jerk_step: f32,
    pressure: f32,
    tracking: f32,
    persistence: u32,
    smoothing: Lag,
}

/// What the envelope remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnvelopeState {
    acceleration: LagState,
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
            room: stroke - margin,
            latency: require("guard.envelope.stopping_latency", s.stopping_latency, 0.0, 10.0)?,
            half_inverse_deceleration: 0.5 / deceleration,
            velocity: require("guard.envelope.velocity", s.velocity, 1e-3, 100.0)?,
            acceleration: require("guard.envelope.acceleration", s.acceleration, 0.01, 1e4)?,
            jerk_step: require("guard.envelope.jerk", s.jerk, 0.1, 1e7)? * dt,
            pressure,
            tracking: require("guard.envelope.tracking", s.tracking, 1e-4, 100.0)?,
            persistence: (require("guard.envelope.persistence", s.persistence, 0.0, 10.0)? / dt) as u32,
            smoothing: Lag::new(require("guard.envelope.smoothing", s.smoothing, 0.0, 1.0)?, dt)?,
        })
    }

    /// Distance in which the table comes to rest from `velocity` (m/s), m.
    #[inline]
    pub fn stopping_distance(&self, velocity: f32) -> f32 {
        let speed = if velocity < 0.0 { -velocity } else { velocity };
        speed * (self.latency + speed * self.half_inverse_deceleration)
    }

    /// One tick.
    #[inline]
    pub fn advance(&self, state: &mut EnvelopeState, motion: &Motion) -> Option<Trip> {
        let before = state.acceleration;
        let acceleration = self.smoothing.advance(&mut state.acceleration, motion.acceleration);
        let jerk_step = acceleration - self.smoothing.last(&before);
        let toward = if motion.velocity < 0.0 { -motion.displacement } else { motion.displacement };
        if toward + self.stopping_distance(motion.velocity) > self.room || beyond(motion.displacement, self.room) {
            return Some(Trip::Displacement);
        }
        let cause = if beyond(motion.velocity, self.velocity) {
            Trip::Velocity
        } else if beyond(acceleration, self.acceleration) {
            Trip::Acceleration
        } else if beyond(jerk_step, self.jerk_step) {
            Trip::Jerk
        } else if beyond(motion.pressure_difference, self.pressure) {
            Trip::Force
        } else if beyond(motion.error, self.tracking) {
            Trip::Tracking
        } else {
            state.lasted = 0;
            return None;
        };
        state.lasted = state.lasted.saturating_add(1);
        (state.lasted > self.persistence).then_some(cause)
    }
}

#[inline]
fn beyond(value: f32, limit: f32) -> bool {
    value > limit || value < -limit
}
