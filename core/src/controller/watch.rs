//! What looks on: observer, envelope, and monitors that take turns.
//!
//! The observer runs at every tick, and so does the part of the envelope that must not wait: displacement with its
//! stopping distance, and velocity. The other monitors judge what lasts ten milliseconds and more; each has its turn at
//! every third tick, which costs a third and adds two ticks to their latency.

mod words;

use super::config::{Config, Guard};
use crate::block::Block;
use crate::control::Blocked;
use crate::filter::fusion::FusionState;
use crate::filter::lag::LagState;
use crate::guard::envelope::{EnvelopeState, Motion};
use crate::guard::plausibility::PlausibilityState;
use crate::guard::{InputState, NoiseState, Trip, ValveMonitorState, WitnessState};
use crate::sample::{Channels, Sample};
use crate::saturation::{DetectorState, Evidence};
use crate::settings::Mode;
pub(super) use words::Drive;
use words::{Cause, Word};

/// Ticks from one turn of a monitor to its next.
pub(crate) const TURNS: u8 = 3;

/// Ticks without sensors over which the table is taken to go on as it went.
const COAST: u32 = 20;

/// The channels without which nothing can be said of the table.
const SENSORS: Channels = Channels::DISPLACEMENT.and(Channels::ACCELERATION).and(Channels::VELOCITY);

/// What the monitors remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Watch {
    observer: FusionState,
    acceleration: LagState,
    velocity_limit: f32,
    detector: DetectorState,
    envelope: EnvelopeState,
    plausibility: PlausibilityState,
    noise: NoiseState,
    witness: WitnessState,
    inputs: InputState,
    valve: ValveMonitorState,
    lost: u32,
    turn: u8,
    cause: Cause,
}

impl Watch {
    /// Monitors that have seen nothing, and would not let a test begin.
    pub(super) fn new(config: &Config) -> Self {
        Self {
            observer: FusionState::default(),
            acceleration: LagState::default(),
            velocity_limit: config.velocity_limit,
            detector: DetectorState::at(config.velocity_limit),
            envelope: EnvelopeState::default(),
            plausibility: PlausibilityState::default(),
            noise: NoiseState::default(),
            witness: WitnessState::default(),
            inputs: InputState::default(),
            valve: ValveMonitorState::default(),
            lost: 0,
            turn: 0,
            cause: Cause::of(Trip::SensorLost),
        }
    }

    /// The first believable readings: the table is at rest at `displacement` (m).
    pub(super) fn begin(&mut self, displacement: f32) {
        self.observer = FusionState::at(displacement);
    }

    /// A test is armed: the table's gain is learned anew, since another payload may be on it.
    pub(super) fn arm(&mut self) {
        self.valve.forget_gain();
    }

    /// Goes on under new settings; the limit in force is forgotten where the set one changed.
    pub(super) fn retune(&mut self, config: &Config, before: &Config) {
        if !config.parts.detector || !before.parts.detector || config.velocity_limit != before.velocity_limit {
            self.detector = DetectorState::at(config.velocity_limit);
            self.velocity_limit = config.velocity_limit;
        }
        if config.mode != before.mode {
            self.valve = ValveMonitorState::default();
        }
        self.valve.forget_gain();
    }

    /// Measured velocity, m/s.
    #[inline]
    pub(super) fn velocity(&self, config: &Config, readings: &Sample) -> f32 {
        if config.parts.observer && !config.parts.velocity_sensor { self.observer.velocity } else { readings.velocity }
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

    /// Why the guard would trip: as of the last tick, or of the last turn of a monitor.
    pub(super) fn cause(&self) -> Option<Trip> {
        self.cause.standing()
    }

    /// One tick with every needed reading there, under a [`Config::complete`] configuration where `ALL`, in guard mode where
    /// `GUARD`. Gives why the guard should trip.
    #[inline(always)]
    pub(super) fn step<const ALL: bool, const GUARD: bool>(
        &mut self,
        config: &Config,
        readings: &Sample,
        drive: Drive,
    ) -> Option<Trip> {
        if !ALL && !config.parts.observer {
            return None;
        }
        self.observe(config, readings);
        let mode = if GUARD { Mode::Guard } else { config.mode };
        let word = self.take_turn::<ALL, GUARD>(mode, config, readings, drive);
        if !ALL && !config.parts.guard {
            return None;
        }
        let noisy = self.hear_sensors(config, readings, drive);
        // A whole tick follows one that found nothing, or the test would not run: there is nothing to forget.
        match word {
            Word::Nothing if ALL => {
                let left = config.guard.envelope.left_by(readings.displacement, self.observer.velocity).or(noisy);
                if left.is_some() {
                    self.cause.now = left;
                }
                left
            }
            Word::Nothing => self.blame(config, readings, noisy, None),
            Word::Unusual(doubt) => self.blame(config, readings, noisy, doubt),
        }
    }

    /// What the envelope says, which must not wait, or else a sensor that is `noisy`, or else the `doubt` of a monitor.
    #[cold]
    #[inline(never)]
    fn blame(&mut self, config: &Config, readings: &Sample, noisy: Option<Trip>, doubt: Option<Trip>) -> Option<Trip> {
        let left = config.guard.envelope.left_by(readings.displacement, self.velocity(config, readings));
        self.cause.hear(left.or(noisy), doubt)
    }

    /// The same under any configuration.
    #[inline(never)]
    pub(super) fn step_partly(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        self.step::<false, false>(config, readings, drive)
    }

    /// The same after a tick that missed a reading.
    pub(super) fn step_again(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        self.lost = 0;
        self.step_partly(config, readings, drive)
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
            if config.parts.observer && lost <= COAST {
                config.observer.coast(&mut self.observer);
                config.guard.witness.coast(&mut self.witness, readings.acceleration);
            }
            None
        } else {
            self.step_again(config, readings, drive)
        };
        self.lost = lost;
        if !config.parts.guard {
            return None;
        }
        self.cause.now = seen.or((lost > config.guard.lost).then_some(Trip::SensorLost));
        self.cause.now
    }

    /// What must not wait of what the sensors say of themselves and of each other.
    #[inline]
    fn hear_sensors(&mut self, config: &Config, readings: &Sample, drive: Drive) -> Option<Trip> {
        let (guard, x, a) = (&config.guard, readings.displacement, readings.acceleration);
        let noisy = guard.noise.advance(&mut self.noise, x, a);
        let disagree = if !config.parts.plausibility {
            false
        } else if drive.moves {
            guard.witness.advance(&mut self.witness, x, a)
        } else {
            guard.witness.follow(&mut self.witness, &self.observer, x);
            false
        };
        let inputs = guard.inputs.advance(&mut self.inputs, readings, drive.relay);
        inputs.or(if disagree { Some(Trip::SensorsDisagree) } else { noisy })
    }

    /// Velocity and low-passed acceleration of the table. A reading that is not there stands at zero.
    #[inline]
    fn observe(&mut self, config: &Config, readings: &Sample) {
        config.observer.advance(&mut self.observer, readings.displacement, readings.acceleration);
        config.smoothing.advance(&mut self.acceleration, readings.acceleration + self.observer.offset);
    }

    /// The monitor whose turn it is.
    #[inline(always)]
    fn take_turn<const ALL: bool, const GUARD: bool>(
        &mut self,
        mode: Mode,
        config: &Config,
        readings: &Sample,
        drive: Drive,
    ) -> Word {
        let parts = config.parts;
        let velocity = if ALL { self.observer.velocity } else { self.velocity(config, readings) };
        // Each says whose turn is next, which spares counting.
        match self.turn {
            0 => {
                self.turn = 2;
                if ALL || parts.detector {
                    self.detect(mode, velocity, config, readings, drive);
                }
                // In modifier mode there is nothing to explain, and so nothing unexplained.
                if (ALL || parts.guard) && config.guard.valve.creeps(&mut self.valve) {
                    return Word::Unusual(Some(Trip::ValveStuck));
                }
                Word::Nothing
            }
            1 => {
                self.turn = 0;
                if ALL || parts.guard {
                    self.judge::<GUARD>(mode, velocity, config, readings, drive)
                } else {
                    Word::Nothing
                }
            }
            _ => {
                self.turn = 1;
                if !ALL && !parts.plausibility {
                    return Word::Nothing;
                }
                let (monitor, x, a) = (&config.guard.plausibility, readings.displacement, readings.acceleration);
                if monitor.look(&mut self.plausibility, x, a, &self.observer) {
                    Word::Nothing
                } else {
                    Word::Unusual(monitor.doubt(&self.plausibility, &self.observer))
                }
            }
        }
    }

    /// Looks for velocity saturation.
    #[inline(always)]
    fn detect(&mut self, mode: Mode, velocity: f32, config: &Config, readings: &Sample, drive: Drive) {
        let acceleration = config.smoothing.last(&self.acceleration);
        let error = if mode == Mode::Guard { drive.excess } else { drive.reference - readings.displacement };
        let demand = if mode == Mode::Modifier {
            config.detector.existing(&mut self.detector, velocity, acceleration, error)
        } else {
            drive.excess * config.valve_gain
        };
        let seen = Evidence { velocity, acceleration, error, demand };
        config.detector.advance(&mut self.detector, seen);
        self.velocity_limit = self.detector.limit();
    }

    /// What the guard has against the table's motion and against the valve. Where `GUARD`, the pressure has no limit and the
    /// reference is an existing controller's.
    #[inline(always)]
    fn judge<const GUARD: bool>(
        &mut self,
        mode: Mode,
        velocity: f32,
        config: &Config,
        readings: &Sample,
        drive: Drive,
    ) -> Word {
        let guard = &config.guard;
        let stuck = mode != Mode::Modifier && {
            let asked = drive.excess * config.valve_gain;
            guard.valve.advance(&mut self.valve, asked, self.velocity_limit, velocity, readings.displacement)
        };
        let acceleration = config.smoothing.last(&self.acceleration);
        let pressure_difference = if GUARD { 0.0 } else { readings.pressure_difference };
        let error = if GUARD { 0.0 } else { drive.reference - readings.displacement };
        if stuck {
            return Word::Unusual(Some(self.stuck(guard, acceleration, pressure_difference, error)));
        }
        let motion = Motion { acceleration, pressure_difference, error };
        match guard.envelope.look(&mut self.envelope, &motion) {
            None => Word::Nothing,
            Some(jerk) => Word::Unusual(guard.envelope.beyond(&mut self.envelope, pressure_difference, jerk)),
        }
    }

    /// A valve that is not believed, whatever the envelope has to say.
    #[cold]
    #[inline(never)]
    fn stuck(&mut self, guard: &Guard, acceleration: f32, pressure_difference: f32, error: f32) -> Trip {
        let _ = guard.envelope.advance(&mut self.envelope, &Motion { acceleration, pressure_difference, error });
        Trip::ValveStuck
    }
}
