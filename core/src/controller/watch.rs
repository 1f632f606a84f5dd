//! What looks on: observer, envelope, and monitors that take turns.
//!
//! The observer runs at every tick, and so does the part of the envelope that must not wait: displacement with its
//! stopping distance, and velocity. The other monitors judge what lasts ten milliseconds and more; each has its turn at
//! every third tick, which costs a third and adds two ticks to their latency.

use super::config::{Config, Guard};
use crate::block::Block;
use crate::control::Blocked;
use crate::filter::Fusion;
use crate::filter::fusion::FusionState;
use crate::filter::lag::LagState;
use crate::guard::envelope::{EnvelopeState, Motion};
use crate::guard::plausibility::PlausibilityState;
use crate::guard::{Trip, ValveMonitorState};
use crate::sample::{Channels, Sample};
use crate::saturation::{DetectorState, Evidence};
use crate::settings::Mode;

/// Ticks from one turn of a monitor to its next.
pub(crate) const TURNS: u8 = 3;

/// Ticks without sensors over which the table is taken to go on as it went.
const COAST: u32 = 20;

/// The channels without which nothing can be said of the table.
const SENSORS: Channels = Channels::DISPLACEMENT.and(Channels::ACCELERATION).and(Channels::VELOCITY);

/// What pushes the table, as the monitors see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Drive {
    /// Reference after modification, m.
    pub(super) reference: f32,
    /// Its velocity, m/s.
    pub(super) reference_velocity: f32,
    /// Command beyond zero flow, m.
    pub(super) excess: f32,
}

/// What the monitors remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Watch {
    observer: FusionState,
    acceleration: LagState,
    velocity: f32,
    velocity_limit: f32,
    detector: DetectorState,
    envelope: EnvelopeState,
    plausibility: PlausibilityState,
    valve: ValveMonitorState,
    lost: u32,
    turn: u8,
    cause: Option<Trip>,
}

impl Watch {
    /// Monitors that have seen nothing, and would not let a test begin.
    pub(super) fn new(config: &Config) -> Self {
        Self {
            observer: FusionState::default(),
            acceleration: LagState::default(),
            velocity: 0.0,
            velocity_limit: config.velocity_limit,
            detector: DetectorState::at(config.velocity_limit),
            envelope: EnvelopeState::default(),
            plausibility: PlausibilityState::default(),
            valve: ValveMonitorState::default(),
            lost: 0,
            turn: 0,
            cause: Some(Trip::SensorLost),
        }
    }

    /// The first believable readings: the table is at rest at `displacement` (m).
    pub(super) fn begin(&mut self, displacement: f32) {
        self.observer = FusionState::at(displacement);
    }

    /// Goes on under new settings; the limit in force is forgotten where the set one changed.
    pub(super) fn retune(&mut self, config: &Config, before: &Config) {
        if config.detector.is_none() || before.detector.is_none() || config.velocity_limit != before.velocity_limit {
            self.detector = DetectorState::at(config.velocity_limit);
            self.velocity_limit = config.velocity_limit;
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
        self.detector.blocked() != Blocked::Neither
    }

    /// The velocity limit in force, m/s.
    #[inline]
    pub(super) fn velocity_limit(&self) -> f32 {
        self.velocity_limit
    }

    /// The direction in which integrators must not go on, given whether the last command (m) stood at its limit.
    #[inline]
    pub(super) fn blocked(&self, config: &Config, limited: bool, command: f32) -> Blocked {
        if !config.anti_windup {
            Blocked::Neither
        } else if !limited {
            self.detector.blocked()
        } else if command > 0.0 {
            Blocked::Positive
        } else {
            Blocked::Negative
        }
    }

    /// Why the guard would trip, as of the last tick.
    pub(super) fn cause(&self) -> Option<Trip> {
        self.cause
    }

    /// One tick with every needed reading there. Gives why the guard should trip.
    #[inline(always)]
    pub(super) fn step(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        let Some(observer) = &config.observer else {
            self.velocity = readings.velocity;
            return None;
        };
        self.observe(config, observer, readings);
        let doubt = self.take_turn(config, readings, drive);
        let guard = config.guard.as_ref()?;
        let left = guard.envelope.left_by(readings.displacement, self.velocity);
        self.cause = if left.is_some() { left } else { doubt };
        self.cause
    }

    /// The same after a tick that missed a reading.
    #[inline(never)]
    pub(super) fn step_again(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        self.lost = 0;
        self.step(config, readings, drive)
    }

    /// One tick without the `missing` readings: what remains is watched, and the rest is waited for.
    #[cold]
    pub(super) fn step_without(
        &mut self,
        config: &Config,
        missing: Channels,
        readings: &Sample,
        drive: Drive,
    ) -> Option<Trip> {
        let lost = self.lost.saturating_add(1);
        let seen = if missing.any(SENSORS) {
            if let Some(observer) = config.observer.as_ref().filter(|_| lost <= COAST) {
                observer.coast(&mut self.observer);
            }
            None
        } else {
            self.step_again(config, readings, drive)
        };
        self.lost = lost;
        let limit = config.guard.as_ref()?.lost;
        self.cause = seen.or((lost > limit).then_some(Trip::SensorLost));
        self.cause
    }

    /// Velocity and low-passed acceleration of the table. A reading that is not there stands at zero.
    #[inline]
    fn observe(&mut self, config: &Config, observer: &Fusion, readings: &Sample) {
        observer.advance(&mut self.observer, readings.displacement, readings.acceleration);
        self.velocity = if config.velocity_sensor { readings.velocity } else { self.observer.velocity };
        config.smoothing.advance(&mut self.acceleration, readings.acceleration + self.observer.offset);
    }

    /// The monitor whose turn it is.
    #[inline(always)]
    fn take_turn(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        // Down rather than up: the end of a turn is then a borrow and no comparison.
        let turn = self.turn;
        self.turn = turn.checked_sub(1).unwrap_or(TURNS - 1);
        match (turn, &config.guard) {
            (0, _) => {
                self.detect(config, readings, drive);
                None
            }
            (1, Some(guard)) => self.judge(config, guard, readings, drive),
            (_, Some(Guard { plausibility: Some(plausibility), .. })) => {
                let (x, a) = (readings.displacement, readings.acceleration);
                plausibility.advance(&mut self.plausibility, x, a, &self.observer)
            }
            _ => None,
        }
    }

    /// Looks for velocity saturation.
    #[inline(always)]
    fn detect(&mut self, config: &Config, readings: &Sample, drive: Drive) {
        let Some(detector) = &config.detector else { return };
        let acceleration = config.smoothing.last(&self.acceleration);
        let seen = Evidence {
            velocity: self.velocity,
            acceleration,
            error: if config.mode == Mode::Guard { drive.excess } else { drive.reference - readings.displacement },
            demand: if config.mode == Mode::Modifier {
                drive.reference_velocity
            } else {
                drive.excess * config.valve_gain
            },
        };
        detector.advance(&mut self.detector, seen);
        self.velocity_limit = self.detector.limit();
    }

    /// What the guard has against the table's motion and against the valve.
    #[inline(always)]
    fn judge(&mut self, config: &Config, guard: &Guard, readings: &Sample, drive: Drive) -> Option<Trip> {
        let motion = Motion {
            acceleration: config.smoothing.last(&self.acceleration),
            pressure_difference: readings.pressure_difference,
            error: drive.reference - readings.displacement,
        };
        let beyond = guard.envelope.advance(&mut self.envelope, &motion);
        if config.mode != Mode::Modifier {
            let asked = drive.excess * config.valve_gain;
            let x = readings.displacement;
            if guard.valve.advance(&mut self.valve, asked, self.velocity_limit, self.velocity, x) {
                return Some(Trip::ValveStuck);
            }
        }
        beyond
    }
}
