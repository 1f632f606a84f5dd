//! What looks on: saturation detection and the monitors of the guard, on readings that are often exactly at a limit.

use crate::tape::{Noise, Tape, hold, run};
use shakedown_core::blocks::filter::MotionState;
use shakedown_core::blocks::guard::{
    Creep, DebouncedSignals, Detector, Envelope, EnvelopeState, Evidence, Plausibility, PlausibilityState,
    ValveMonitor, ValveMonitorState,
};
use shakedown_core::settings::{
    Detection, EnvelopeSettings, ForceSettings, PlausibilitySettings, ValveMonitorSettings,
};

const DT: f32 = 0.003;
const LIMIT: f32 = 0.25;

/// Evidence that lasts for a while, changes a little, or is another altogether.
fn detected(settings: Detection) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let detector = Detector::new(&settings, LIMIT, 0.017, DT).unwrap();
        let mut state = detector.start();
        let mut noise = Noise::new(83);
        let mut seen = Evidence { velocity: 0.0, acceleration: 0.0, error: 0.0, demand: 0.0 };
        for k in 0..6000 {
            if k % 7 == 0 {
                let slowest = settings.floor * LIMIT;
                let speed =
                    noise.of(&[slowest, slowest, 0.92 * state.limit(), 0.92 * LIMIT, LIMIT, 0.3, 0.1, 0.2, 0.0]);
                let side = noise.of(&[1.0, 1.0, 1.0, -1.0]);
                seen.velocity = side * speed;
                seen.demand = side * noise.of(&[(1.0 + settings.shortfall) * speed, 1.0, 2.0, 0.0]);
                seen.error = side * noise.of(&[0.1, 0.1, 0.1, settings.error, -0.1]);
                seen.acceleration = noise.of(&[0.0, settings.plateau, -settings.plateau, 0.5 * settings.plateau]);
            }
            let jolt = noise.of(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 3.0]);
            detector.advance(&mut state, Evidence { acceleration: jolt * seen.acceleration, ..seen });
            let (positive, negative) = state.limits();
            tape.note_all([positive, negative, state.limit()]);
            tape.word(&state.blocked());
        }
    }
}

fn enveloped(tape: &mut Tape) {
    let force = Some(ForceSettings { limit: 1000.0, piston_area: 0.01 });
    let settings = EnvelopeSettings { acceleration: 5.0, jerk: 1000.0, force, tracking: 0.05, ..Default::default() };
    let envelope = Envelope::new(&settings, 0.12, DT).unwrap();
    let mut state = EnvelopeState::default();
    let mut noise = Noise::new(89);
    for k in 0..6000 {
        let calm = k % 40 < 25;
        let often = |noise: &mut Noise, limit: f32| {
            let value = noise.of(&[limit, -limit, 1.01 * limit, -1.01 * limit, 0.0]);
            if calm { 0.5 * value } else { value }
        };
        let motion = DebouncedSignals {
            acceleration: if k % 400 < 200 { 0.4 * often(&mut noise, 5.0) } else { often(&mut noise, 5.0) },
            pressure_difference: often(&mut noise, 100_000.0),
            error: often(&mut noise, 0.05),
        };
        tape.word(&envelope.advance(&mut state, &motion));
        let (x, v) = (0.12 * noise.next(), 0.31 * noise.next());
        tape.note(envelope.stopping_distance(v));
        tape.word(&envelope.left_by(x, v));
    }
}

fn plausible(tape: &mut Tape) {
    let monitor = Plausibility::new(&PlausibilitySettings::default(), DT).unwrap();
    let mut state = PlausibilityState::default();
    let mut noise = Noise::new(97);
    let (mut x, mut a) = (0.0, 0.0);
    for k in 0..9000 {
        // A sensor that stands, one that wanders, both and neither in turn.
        let kind = k / 60 % 5;
        x = if kind == 1 { x } else { x + 1e-4 * noise.next() };
        a = if kind == 2 { a } else { noise.next() * if kind == 3 { 8.0 } else { 0.5 } };
        let size = noise.of(&[4e-4, 1e-3, 6e-4, 4e-3]);
        let innovation = if k / 300 % 2 == 0 { size } else { size * noise.next() };
        let seen = MotionState { innovation, offset: noise.of(&[0.0, 0.0, 3.0, -3.0, 3.1]), ..MotionState::at(x) };
        tape.word(&monitor.advance(&mut state, x, a, &seen));
    }
}

fn believed(settings: ValveMonitorSettings) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let monitor = ValveMonitor::new(&settings, 0.02, 0.242, DT).unwrap();
        let mut state = ValveMonitorState::default();
        let mut noise = Noise::new(101);
        let (mut asked, mut x, mut share) = (0.0_f32, 0.0_f32, 1.0);
        for k in 0..6000 {
            if k % 90 == 0 {
                asked = 0.5 * noise.next();
                share = noise.of(&[1.0, 1.0, 1.0, 0.0, 0.4, 1.6]);
            }
            let velocity = share * asked.clamp(-LIMIT, LIMIT);
            x += if k % 1500 < 300 { 0.0 } else { DT * velocity };
            tape.count(monitor.advance(&mut state, asked, LIMIT, velocity, x));
            tape.count(monitor.creep(&state) == Creep::Certain);
            tape.word(&state);
        }
    }
}

#[test]
fn monitors() {
    let blunt = Detection { hold: 0.0, shortfall: 0.0, error: 0.0, follow: 1e-3, recovery: 0.05, ..Default::default() };
    hold(
        "monitors",
        &[
            run("saturation", detected(Detection::default())),
            run("saturation, told at once", detected(blunt)),
            run("envelope", enveloped),
            run("plausibility", plausible),
            run("valve", believed(ValveMonitorSettings::default())),
            run("valve, quick to doubt", believed(ValveMonitorSettings { mismatch: 0.002, memory: 0.011 })),
        ],
    );
}
