//! A test with everything in it: what the operator asks for, what breaks, and a table that answers.

use crate::tape::{Noise, Tape};
use shakedown_core::blocks::math;
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Command, Controller, Mode, OperatorRequest, Relay, Sample, Settings};

/// A table of four operations: a valve that lags, a limit, two sensors.
#[derive(Debug)]
struct Table {
    x: f32,
    v: f32,
    a: f32,
    limit: f32,
    stuck: Option<f32>,
    noise: Noise,
}

impl Table {
    fn sample(&mut self, reference: f32, before: f32) -> Sample {
        let displacement = math::floor(self.x * 25_000.0) / 25_000.0;
        let acceleration = self.a + 0.1 * self.noise.next();
        Sample {
            velocity: self.v,
            pressure_difference: 2e5 * self.a,
            reference_velocity: (reference - before) * 1000.0,
            reference_acceleration: 0.2 * self.noise.next(),
            // An existing controller's, if there is one.
            external: 8.0 * (reference - displacement),
            ..Sample::new(reference, displacement, acceleration)
        }
    }

    fn advance(&mut self, command: f32, relay: Relay) {
        let before = self.v;
        let flow = if relay == Relay::Closed { 2.4 * self.stuck.unwrap_or(command) } else { 0.0 };
        self.v += 0.06 * (flow - self.v);
        self.v = self.v.clamp(-self.limit, self.limit);
        self.x += 1e-3 * self.v;
        self.a = 1000.0 * (self.v - before);
    }
}

/// What an operator asks for, and when: what applies and what does not.
const ACTS: &[(u32, OperatorRequest)] = &[
    (1, OperatorRequest::Start),
    (3, OperatorRequest::Arm),
    (4, OperatorRequest::Arm),
    (5, OperatorRequest::Start),
    (300, OperatorRequest::Reset),
    (900, OperatorRequest::Hold),
    (1000, OperatorRequest::Hold),
    (1150, OperatorRequest::Resume),
    (1300, OperatorRequest::Off),
    (2100, OperatorRequest::Stop),
    (2150, OperatorRequest::Resume),
    (2400, OperatorRequest::Off),
    (2410, OperatorRequest::Arm),
    (2420, OperatorRequest::Start),
    (2500, OperatorRequest::Hold),
    (2510, OperatorRequest::Stop),
    (2800, OperatorRequest::Start),
    (3300, OperatorRequest::Reset),
    (3301, OperatorRequest::Arm),
    (3310, OperatorRequest::Reset),
    (3700, OperatorRequest::Reset),
    (3710, OperatorRequest::Arm),
    (3720, OperatorRequest::Start),
    (4100, OperatorRequest::Trip),
    (4101, OperatorRequest::Reset),
    (4300, OperatorRequest::Reset),
    (4310, OperatorRequest::Arm),
];

/// When it is off.
const OFF: u32 = 4305;
/// How long it takes.
const TICKS: u32 = 4500;

/// What is spoilt of a sample, and when.
fn spoil(k: u32, sample: &mut Sample) {
    match k {
        0 | 1500..=1501 => (sample.reference, sample.external) = (f32::NAN, f32::INFINITY),
        1560..=1563 => sample.displacement = f32::NAN,
        1620..=1628 => sample.acceleration = 1e4,
        1700 => sample.external = 3.0,
        1760..=1765 => sample.velocity = f32::NAN,
        1800 => sample.pressure_difference = f32::NAN,
        1840 => sample.reference_velocity = 21.0,
        1850 => sample.reference_acceleration = 1001.0,
        3200..=3240 => sample.displacement = f32::NAN,
        4200 => (sample.reference, sample.external) = (0.5, 0.0),
        4400..=4425 => sample.reference = f32::NAN,
        _ => {}
    }
}

/// Goes through the script under `settings`, exchanged for `other` from 1900 to 2300, where a running test lets them be, and while off from
/// [`OFF`] on, and notes all that can be seen.
pub(crate) fn play(tape: &mut Tape, settings: &Settings, other: &Settings) {
    let mut controller = Controller::new(settings).unwrap();
    let mut table = Table { x: 0.002, v: 0.0, a: 0.0, limit: 0.2, stuck: None, noise: Noise::new(103) };
    let (mut before, mut now) = (0.0, settings);
    for k in 0..TICKS {
        for (_, request) in ACTS.iter().filter(|(at, _)| *at == k) {
            tape.word(&controller.request(*request));
        }
        if matches!(k, 1900 | 2300 | OFF) {
            let next = if k == 2300 { settings } else { other };
            let taken = controller.retune(next);
            tape.word(&taken);
            now = if taken.is_ok() { next } else { now };
        }
        if k == 3000 || k == 3290 {
            table.stuck = (k == 3000).then_some(0.06);
        }
        let reference = 0.04 * libm::sinf(k as f32 * 0.0075) + 0.01 * libm::sinf(k as f32 * 0.041);
        let mut sample = table.sample(reference, before);
        before = reference;
        spoil(k, &mut sample);
        let command = controller.step(&sample);
        note(tape, &controller, &command);
        table.advance(answer(now, command.valve, &table), command.status.relay);
    }
}

/// What the valve gets of the output.
fn answer(settings: &Settings, output: f32, table: &Table) -> f32 {
    match (settings.mode, settings.inner_loop) {
        (Mode::Modifier, _) => 8.0 * (output - table.x),
        (_, InnerLoop::Hardwired) => output - table.x,
        (_, InnerLoop::Absent) => output,
    }
}

fn note(tape: &mut Tape, controller: &Controller, command: &Command) {
    let status = &command.status;
    assert_eq!((status.state, status.trip), (controller.state(), controller.trip()));
    assert_eq!(status.held, !status.missing.is_empty());
    tape.note_all([command.valve, command.reference, command.status.velocity_limit]);
    tape.count(command.status.bits());
    tape.count(status.missing.bits());
    tape.count(controller.changes());
}
