//! Runs the observer, the envelope check, the sensor monitors and the round-robin monitors.
//!
//! The observer runs at every tick, and so does what must not wait: displacement with its stopping distance, velocity, noise,
//! the displacement witness and the inputs. The other monitors judge what lasts ten milliseconds and more; each has its turn
//! at every third tick, which costs a third and adds two ticks to their latency.

mod latch;

use super::config::{GuardConfig, MonitorConfig};
use crate::block::Block;
use crate::control::Blocked;
use crate::filter::lag::LagState;
use crate::filter::observer::MotionState;
use crate::guard::envelope::{DebouncedSignals, EnvelopeState};
use crate::guard::plausibility::PlausibilityState;
use crate::guard::{Creep, InputState, NoiseState, StillState, Trip, ValveMonitorState, WitnessState};
use crate::sample::{Channels, Sample};
use crate::saturation::{DetectorState, Evidence};
use crate::settings::Mode;
pub(super) use latch::MonitorInput;
use latch::TripLatch;

/// Ticks from one turn of a monitor to its next.
pub(crate) const TURNS: u8 = 3;

/// Ticks without sensors over which the table is held to go on as it went.
const COAST: u32 = 20;

/// Ticks with a reading that make up for one without.
const REGAIN: u32 = 4;

/// An existing controller corrects an error at least so fast, 1/s: a loop of 0.8 Hz.
const SLOWEST_LOOP: f32 = 5.0;

/// The channels without which nothing can be said of the table.
const SENSORS: Channels = Channels::DISPLACEMENT.union(Channels::ACCELERATION).union(Channels::VELOCITY);

/// What observer and monitors remember.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Monitors {
    observer: MotionState,
    acceleration: LagState,
    velocity_limit: f32,
    detector: DetectorState,
    envelope: EnvelopeState,
    plausibility: PlausibilityState,
    noise: NoiseState,
    witness: WitnessState,
    inputs: InputState,
    valve: ValveMonitorState,
    still: StillState,
    lost: u32,
    /// Readings missed of late: [`REGAIN`] for each, one off for every tick without.
    missed: u32,
    turn: u8,
    latch: TripLatch,
}

impl Monitors {
    /// Monitors that have observed nothing, and would not let a test begin, of a table of `velocity_limit` (m/s).
    pub(super) fn new(velocity_limit: f32) -> Self {
        Self {
            observer: MotionState::default(),
            acceleration: LagState::default(),
            velocity_limit,
            detector: DetectorState::at(velocity_limit),
            envelope: EnvelopeState::default(),
            plausibility: PlausibilityState::default(),
            noise: NoiseState::default(),
            witness: WitnessState::default(),
            inputs: InputState::default(),
            valve: ValveMonitorState::default(),
            still: StillState::default(),
            lost: 0,
            missed: 0,
            turn: 0,
            latch: TripLatch::of(Trip::SensorLost),
        }
    }

    /// The table is at rest at `displacement` (m): the first believable readings.
    pub(super) fn begin(&mut self, displacement: f32) {
        self.observer = MotionState::at(displacement);
    }

    /// A test is armed: the table's gain is learned anew, since another payload may be on it.
    pub(super) fn arm(&mut self) {
        self.valve.forget_gain();
    }

    /// Goes on under new settings, with the table at `displacement` (m); the limit in force is forgotten where the set one
    /// changed, and an observer that begins here begins where the table is.
    pub(super) fn retune(&mut self, config: &MonitorConfig, before: &MonitorConfig, displacement: f32) {
        let detected = config.detector.is_some() && before.detector.is_some();
        if !detected || config.velocity_limit != before.velocity_limit {
            self.detector = DetectorState::at(config.velocity_limit);
            self.velocity_limit = config.velocity_limit;
        }
        if before.observer.is_none() {
            self.observer = MotionState::at(displacement);
        }
        if config.mode != before.mode {
            self.valve = ValveMonitorState::default();
            self.still = StillState::default();
        }
        self.valve.forget_gain();
    }

    /// Measured velocity, m/s.
    pub(super) fn velocity(&self, config: &MonitorConfig, readings: &Sample) -> f32 {
        if config.observer.is_some() && !config.velocity_sensor { self.observer.velocity } else { readings.velocity }
    }

    /// Whether the table is at its velocity limit.
    pub(super) fn saturated(&self) -> bool {
        self.detector.blocked() != Blocked::Neither
    }

    /// The velocity limit in force, m/s.
    pub(super) fn velocity_limit(&self) -> f32 {
        self.velocity_limit
    }

    /// The direction in which the table is at its velocity limit.
    pub(super) fn blocked(&self) -> Blocked {
        self.detector.blocked()
    }

    /// Why the guard would trip: as of the last tick, or of the last turn of a monitor. A table whose readings are not all there
    /// is not known to be where it may be armed, however short the gap. One that is `held` without oil stands, so that a reading
    /// that moves is wrong.
    pub(super) fn cause(&self, config: &MonitorConfig, held: bool) -> Option<Trip> {
        let witness = config.guard.as_ref().and_then(|guard| guard.witness.as_ref());
        let moves = held && witness.is_some_and(|witness| witness.may_miss(self.observer.velocity));
        let lost = (self.lost > 0).then_some(Trip::SensorLost);
        self.latch.cause().or(lost).or(moves.then_some(Trip::SensorsDisagree))
    }

    /// What the monitors that take turns last found, whatever was found at once.
    pub(super) fn found(&self) -> Option<Trip> {
        self.latch.found
    }

    /// One tick, with these needed readings `missing`: what remains is judged, and the rest is waited for. Gives why the
    /// guard should trip.
    pub(super) fn step(
        &mut self,
        config: &MonitorConfig,
        missing: Channels,
        readings: &Sample,
        input: MonitorInput,
    ) -> Option<Trip> {
        if missing.is_empty() {
            self.lost = 0;
            self.missed = self.missed.saturating_sub(1);
            return self.judge(config, readings, input);
        }
        self.lost = self.lost.saturating_add(1);
        let found = if missing.intersects(SENSORS) {
            self.coast(config, readings);
            None
        } else {
            self.judge(config, readings, input)
        };
        let guard = config.guard.as_ref()?;
        // A loose contact is as good as lost: what is missed counts until it has been there four times as long.
        let most = guard.lost.saturating_mul(REGAIN);
        self.missed = self.missed.saturating_add(REGAIN).min(most.saturating_add(REGAIN));
        self.latch.now = found.or((self.missed > most).then_some(Trip::SensorLost));
        self.latch.now
    }

    /// A tick without sensors: the table goes on as it went, for a while.
    fn coast(&mut self, config: &MonitorConfig, readings: &Sample) {
        let Some(observer) = config.observer.as_ref().filter(|_| self.lost <= COAST) else { return };
        observer.motion.coast(&mut self.observer);
        if let Some(witness) = config.guard.as_ref().and_then(|guard| guard.witness.as_ref()) {
            witness.coast(&mut self.witness, readings.acceleration);
        }
    }

    /// A tick in which every sensor is there.
    fn judge(&mut self, config: &MonitorConfig, readings: &Sample, input: MonitorInput) -> Option<Trip> {
        let observer = config.observer.as_ref()?;
        observer.motion.advance(&mut self.observer, readings.displacement, readings.acceleration);
        observer.smoothing.advance(&mut self.acceleration, readings.acceleration + self.observer.offset);

        let turn = self.take_turn(config, readings, input);
        let guard = config.guard.as_ref()?;
        let left = guard.envelope.left_by(readings.displacement, self.velocity(config, readings));
        let doubted = self.doubt_sensors(guard, readings, input);
        self.latch.update(left.or(doubted), turn)
    }

    /// What must not wait of what the inputs say, and the sensors of each other and of themselves.
    fn doubt_sensors(&mut self, guard: &GuardConfig, readings: &Sample, input: MonitorInput) -> Option<Trip> {
        let (x, a) = (readings.displacement, readings.acceleration);
        let noisy = guard.noise.advance(&mut self.noise, x, a);
        let contradicted = guard.witness.as_ref().is_some_and(|witness| {
            if input.moves {
                witness.advance(&mut self.witness, x, a)
            } else {
                witness.follow(&mut self.witness, &self.observer, x);
                false
            }
        });
        let inputs = guard.inputs.advance(&mut self.inputs, readings, input.relay);
        inputs.or(contradicted.then_some(Trip::SensorsDisagree)).or(noisy)
    }

    /// The round-robin monitor whose turn it is.
    fn take_turn(&mut self, config: &MonitorConfig, readings: &Sample, input: MonitorInput) -> Option<Trip> {
        let turn = self.turn;
        self.turn = if turn + 1 < TURNS { turn + 1 } else { 0 };
        match turn {
            0 => {
                self.detect(config, readings, input);
                self.judge_creep(config, config.guard.as_ref()?, readings)
            }
            1 => {
                let plausibility = config.guard.as_ref()?.plausibility.as_ref()?;
                let (x, a) = (readings.displacement, readings.acceleration);
                plausibility.advance(&mut self.plausibility, x, a, &self.observer)
            }
            _ => self.judge_motion(config, config.guard.as_ref()?, readings, input),
        }
    }

    /// Looks for velocity saturation.
    fn detect(&mut self, config: &MonitorConfig, readings: &Sample, input: MonitorInput) {
        let Some(detector) = &config.detector else { return };
        let velocity = self.velocity(config, readings);
        let acceleration = self.acceleration.output();
        let tracking_error = input.reference - readings.displacement;
        let error = if config.mode == Mode::Guard { input.flow_command } else { tracking_error };
        let demand = if config.mode == Mode::Modifier {
            detector.external_demand(&mut self.detector, velocity, acceleration, error)
        } else {
            input.flow_command * config.valve_gain
        };
        detector.advance(&mut self.detector, Evidence { velocity, acceleration, error, demand });
        self.velocity_limit = self.detector.limit();
    }

    /// Whether the LVDT has crept, or the table may be where it must not if it has.
    fn judge_creep(&self, config: &MonitorConfig, guard: &GuardConfig, readings: &Sample) -> Option<Trip> {
        let (below, above) = match guard.valve.as_ref()?.creep(&self.valve) {
            Creep::None => return None,
            Creep::Certain => return Some(Trip::ValveStuck),
            Creep::Possible { below, above } => (below, above),
        };
        let (x, v) = (readings.displacement, self.velocity(config, readings));
        let left = guard.envelope.left_by(x - below, v).or(guard.envelope.left_by(x + above, v));
        left.and(Some(Trip::ValveStuck))
    }

    /// Whether the valve does what it is told, and the table's motion what it may.
    fn judge_motion(
        &mut self,
        config: &MonitorConfig,
        guard: &GuardConfig,
        readings: &Sample,
        input: MonitorInput,
    ) -> Option<Trip> {
        let velocity = self.velocity(config, readings);
        let stuck = guard.valve.as_ref().is_some_and(|valve| {
            let asked = input.flow_command * config.valve_gain;
            valve.advance(&mut self.valve, asked, self.velocity_limit, velocity, readings.displacement)
        });
        let error = input.reference - readings.displacement;
        let still = guard
            .still
            .as_ref()
            .is_some_and(|still| still.advance(&mut self.still, SLOWEST_LOOP * error, readings.displacement));
        let motion = DebouncedSignals {
            acceleration: self.acceleration.output(),
            pressure_difference: readings.pressure_difference,
            error,
        };
        let beyond = guard.envelope.advance(&mut self.envelope, &motion);
        if stuck || still { Some(Trip::ValveStuck) } else { beyond }
    }
}
