//! A belt-driven table of a teaching laboratory: the core fits the reference to the motor's speed and travel as it comes, an error
//! accumulator turns it into step pulses. No valve, no pressure, no accelerometer; the position is the count of steps.
//!
//! A board's timer calls [`Axis::tick`] a thousand times a second and sends the pulses it returns, evenly, within the tick.
#![no_std]

use shakedown_core::settings::{EnvelopeSettings, GuardSettings, Mode, ObserverSettings};
use shakedown_core::{Controller, Modification, OperatorRequest, Relay, Sample, Settings, SettingsError, State};

/// Control rate, Hz.
pub const RATE: f32 = 1000.0;
/// Travel of one step, m: 40 mm a turn, 200 steps in 16 parts.
pub const STEP: f32 = 0.04 / 3200.0;
/// Fastest speed, m/s: beyond it the motor loses steps.
pub const FASTEST: f32 = 0.45;
/// Farthest position either way, m.
pub const STROKE: f32 = 0.1;
/// Most steps of one tick: one more than the fastest speed takes, for what was rounded off before.
pub const MOST: i32 = (FASTEST / RATE / STEP) as i32 + 1;

/// What goes to the drive at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Pulses {
    /// Whether the motor's current is on.
    pub enabled: bool,
    /// Steps of this tick, with their direction.
    pub steps: i32,
}

/// What the timer interrupt owns.
#[derive(Debug)]
pub struct Axis {
    controller: Controller,
    /// Steps from the place where the power came.
    counted: i32,
    /// Whether the key has been off since the power came or the test tripped: one that is on already arms nothing.
    released: bool,
}

impl Axis {
    /// At rest, where the table is.
    pub fn new() -> Result<Self, SettingsError> {
        // What the count says of the speed jumps by whole steps; the guard leaves a fifth for it.
        let limits = EnvelopeSettings { velocity: 1.2 * FASTEST, ..EnvelopeSettings::default() };
        // A motor answers at once and stops at 10 m/s2 where oil needs 50 ms and half of that.
        let envelope = EnvelopeSettings { stopping_latency: 0.005, stopping_deceleration: 10.0, ..limits };
        let settings = Settings {
            rate: RATE,
            mode: Mode::Modifier,
            modification: Modification::Causal,
            velocity_limit: FASTEST,
            stroke: STROKE,
            // No sensor's noise is in the count of steps: it is believed up to 20 Hz.
            observer: ObserverSettings { accelerometer: false, frequency: 20.0, ..ObserverSettings::default() },
            guard: Some(GuardSettings { envelope, ..GuardSettings::default() }),
            ..Settings::default()
        };
        Ok(Self { controller: Controller::new(&settings)?, counted: 0, released: false })
    }

    /// One tick: the reference (m) and the operator's key in, pulses out.
    pub fn tick(&mut self, reference: f32, key: bool) -> Pulses {
        let command = self.controller.step(&Sample::new(reference, self.position(), 0.0));
        let (enabled, state) = (command.status.relay == Relay::Closed, command.status.state);
        // What a tick leaves over is still missing at the next.
        let missing = (command.valve - self.position()) / STEP;
        let steps = if enabled { (missing as i32).clamp(-MOST, MOST) } else { 0 };
        self.counted += steps;
        self.released = state != State::Tripped && (self.released || !key);
        let wanted = match (key, state) {
            (true, State::Off) if self.released => Some(OperatorRequest::Arm),
            (true, State::Ready) => Some(OperatorRequest::Start),
            (false, State::Running) => Some(OperatorRequest::Stop),
            (false, State::Ready) => Some(OperatorRequest::Off),
            _ => None,
        };
        if let Some(request) = wanted {
            // Refused: asked again at the next tick.
            let _ = self.controller.request(request);
        }
        Pulses { enabled, steps }
    }

    /// Where the steps say the table is, m.
    pub fn position(&self) -> f32 {
        self.counted as f32 * STEP
    }

    /// Where the test stands.
    pub fn state(&self) -> State {
        self.controller.state()
    }
}
