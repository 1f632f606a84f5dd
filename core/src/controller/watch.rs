//! What looks on: observer, saturation detection and guard monitors, in the order in which they need each other.

use super::config::Config;
use crate::control::Blocked;
use crate::filter::fusion::FusionState;
use crate::guard::envelope::{EnvelopeState, Motion};
use crate::guard::plausibility::PlausibilityState;
use crate::guard::{Trip, ValveMonitorState};
use crate::sample::{Channels, Sample};
use crate::saturation::{DetectorState, Evidence};
use crate::settings::Mode;

/// What the monitors remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Watch {
    observer: FusionState,
    velocity: f32,
    detector: Option<DetectorState>,
    envelope: EnvelopeState,
    plausibility: PlausibilityState,
    valve: ValveMonitorState,
    lost: u32,
    cause: Option<Trip>,
}

impl Watch {
    /// Monitors that have seen nothing.
    pub(super) fn new(config: &Config) -> Self {
        Self {
            observer: FusionState::default(),
            velocity: 0.0,
            detector: config.detector.map(|detector| detector.start()),
            envelope: EnvelopeState::default(),
            plausibility: PlausibilityState::default(),
            valve: ValveMonitorState::default(),
            lost: 0,
            cause: None,
        }
    }

    /// Goes on under new settings; the limit in force is forgotten where the set one changed.
    pub(super) fn retune(&mut self, config: &Config, before: &Config) {
        if config.detector.is_none() || self.detector.is_none() || config.velocity_limit != before.velocity_limit {
            self.detector = config.detector.map(|detector| detector.start());
        }
        if config.mode != before.mode {
            self.valve = ValveMonitorState::default();
        }
    }

    /// Measured velocity, m/s.
    #[inline]
    pub(super) fn velocity(&self) -> f32 {
        self.velocity
    }

    /// Whether the table is at its velocity limit.
    #[inline]
    pub(super) fn saturated(&self) -> bool {
        self.detector.is_some_and(|state| state.blocked() != Blocked::Neither)
    }

    /// The velocity limit in force, m/s.
    #[inline]
    pub(super) fn velocity_limit(&self, config: &Config) -> f32 {
        self.detector.map_or(config.velocity_limit, |state| state.limit())
    }

    /// The direction in which integrators must not go on, given whether the last command (m) stood at its limit.
    #[inline]
    pub(super) fn blocked(&self, config: &Config, limited: bool, command: f32) -> Blocked {
        if !config.anti_windup {
            return Blocked::Neither;
        }
        if limited {
            return if command > 0.0 { Blocked::Positive } else { Blocked::Negative };
        }
        self.detector.map_or(Blocked::Neither, |state| state.blocked())
    }

    /// Why the guard would trip, as of the last tick.
    pub(super) fn cause(&self) -> Option<Trip> {
        self.cause
    }

    /// One tick: readings, which channels are `missing`, what pushes the table (m) and what speed is asked for (m/s).
    #[inline]
    pub(super) fn step(
        &mut self,
        config: &Config,
        readings: &Sample,
        missing: Channels,
        error: f32,
        demand: f32,
    ) -> Option<Trip> {
        let Some(observer) = &config.observer else {
            self.velocity = readings.velocity;
            return None;
        };
        let sensors = Channels::DISPLACEMENT.and(Channels::ACCELERATION).and(Channels::VELOCITY);
        if missing.any(sensors) {
            self.cause = self.count_lost(config, missing);
            return self.cause;
        }
        let measured = if config.accelerometer { readings.acceleration } else { 0.0 };
        observer.advance(&mut self.observer, readings.displacement, measured);
        self.velocity = if config.velocity_sensor { readings.velocity } else { self.observer.velocity };
        let acceleration = measured + self.observer.offset;
        if let (Some(detector), Some(state)) = (&config.detector, &mut self.detector) {
            detector.advance(state, Evidence { velocity: self.velocity, acceleration, error, demand });
        }
        let lost = self.count_lost(config, missing);
        self.cause = lost.or_else(|| self.judge(config, readings, acceleration, error, demand));
        self.cause
    }

    #[inline]
    fn judge(
        &mut self,
        config: &Config,
        readings: &Sample,
        acceleration: f32,
        error: f32,
        demand: f32,
    ) -> Option<Trip> {
        let guard = config.guard.as_ref()?;
        let motion = Motion {
            displacement: readings.displacement,
            velocity: self.velocity,
            acceleration,
            pressure_difference: readings.pressure_difference,
            error: if config.mode == Mode::Guard { 0.0 } else { error },
        };
        let mut cause = guard.envelope.advance(&mut self.envelope, &motion);
        if config.mode != Mode::Modifier {
            let limit = self.velocity_limit(config);
            let stuck = guard.valve.advance(&mut self.valve, demand, limit, self.velocity);
            cause = if stuck { Some(Trip::ValveStuck) } else { cause };
        }
        if let Some(plausibility) = &guard.plausibility {
            let (x, a) = (readings.displacement, readings.acceleration);
            let doubt = plausibility.advance(&mut self.plausibility, x, a, &self.observer);
            cause = doubt.or(cause);
        }
        cause
    }

    /// Counts ticks without a needed reading.
    #[inline]
    fn count_lost(&mut self, config: &Config, missing: Channels) -> Option<Trip> {
        self.lost = if missing.is_empty() { 0 } else { self.lost.saturating_add(1) };
        let limit = config.guard.as_ref()?.lost;
        (self.lost > limit).then_some(Trip::SensorLost)
    }
}
