//! The parts of the tracking law, each by itself.

use crate::tape::{Noise, Tape, hold, run, signal};
use shakedown_core::blocks::filter::{MotionObserver, MotionState};
use shakedown_core::blocks::tracking::{
    Disturbance, DisturbanceState, FlowMap, FlowState, Friction, History, OilColumn, OilState, PressureDamping,
    ReferenceState, Stencil, Valve, ValveState,
};
use shakedown_core::settings::{FlowSettings, FrictionSettings, OilSettings, PressureSettings};

const DT: f32 = 1e-3;
const LIMIT: f32 = 0.242;

fn flow(settings: FlowSettings) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let map = FlowMap::new(&settings, LIMIT, DT).unwrap();
        let mut state = FlowState::default();
        let mut noise = Noise::new(11);
        for wanted in signal(13, 0.25, 800) {
            let wanted = noise.of(&[wanted, wanted, wanted, 0.0, LIMIT, -LIMIT]);
            let load = noise.of(&[0.0, 3.0, -3.0, 14.0, -14.0, 40.0, -40.0]);
            let (open, made) = map.advance(&mut state, wanted, load, 0.4 * noise.next());
            tape.note_all([open, made]);
        }
    }
}

#[test]
fn flow_map() {
    let plain = FlowSettings::default();
    hold(
        "flow",
        &[
            run("hard", flow(plain)),
            run("soft", flow(FlowSettings { sharpness: 3.0, ..plain })),
            run("soft, at its softest", flow(FlowSettings { sharpness: 1.0, ..plain })),
            run("unequal", flow(FlowSettings { asymmetry: 0.7, overdrive: 1.0, ..plain })),
            run("that stalls", flow(FlowSettings { stall: 30.0, overdrive: 1.5, ..plain })),
            run("of a tired supply", flow(FlowSettings { droop: 0.6, recovery: 0.2, ..plain })),
            run("of an exhausted one", flow(FlowSettings { droop: 0.95, recovery: 0.1, ..plain })),
            run(
                "all at once",
                flow(FlowSettings {
                    asymmetry: 1.4,
                    sharpness: 5.0,
                    stall: 25.0,
                    droop: 0.3,
                    recovery: 1.0,
                    overdrive: 2.0,
                }),
            ),
        ],
    );
}

fn oil(damping: f32, frequencies: [f32; 2]) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let column = OilColumn::new(&OilSettings { frequency: 12.0, damping }, frequencies, LIMIT, DT).unwrap();
        let mut state = OilState::default();
        let mut noise = Noise::new(17);
        tape.note(column.stiffness());
        for x in signal(19, 1.0, 500) {
            // Now and then more than a flow at the limit could undo.
            let push = noise.of(&[1.0, 1.0, 1.0, 400.0]);
            column.observe(&mut state, 0.1 * x, 0.1 * noise.next(), push * noise.next());
            let ahead =
                ReferenceState { displacement: x, velocity: 0.2 * x, acceleration: noise.next(), jerk: 50.0 * x };
            tape.note_all([state.load, state.disturbance, column.forward(&ahead)]);
            tape.note(column.feedback(&state, [0.01 * noise.next(), 0.1 * noise.next(), noise.next()]));
        }
    }
}

#[test]
fn oil_column() {
    hold(
        "oil",
        &[
            run("observed", oil(0.05, [6.0, 30.0])),
            run("undamped", oil(0.0, [20.0, 10.0])),
            run("without observer", oil(0.3, [6.0, 0.0])),
            run("without feedback", oil(0.3, [0.0, 30.0])),
        ],
    );
}

fn kalman(displacement: f32, acceleration: f32) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let kalman = MotionObserver::kalman(displacement, acceleration, DT).unwrap();
        let mut state = MotionState::at(0.02);
        for (x, a) in signal(23, 0.05, 400).zip(signal(29, 3.0, 400)) {
            kalman.advance(&mut state, x, a);
            tape.note_all([state.displacement, state.velocity, state.acceleration, state.offset]);
        }
    }
}

fn valve(parameters: [f32; 3], limit: f32) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let valve = Valve::new(parameters, limit, DT).unwrap();
        let mut state = ValveState::default();
        let mut noise = Noise::new(31);
        for wanted in signal(37, 0.2, 500) {
            let (command, made) = valve.advance(&mut state, wanted, noise.of(&[0.0, 0.5, -0.5]));
            tape.note_all([command, made]);
        }
    }
}

#[test]
fn observer_and_valve() {
    let paper = [138.0 / 57.65, 1.0 / 57.65, 0.69 / 138.0];
    hold(
        "valve",
        &[
            run("kalman", kalman(1.15e-5, 0.196)),
            run("kalman, LVDT alone", kalman(1e-9, 1000.0)),
            run("valve", valve(paper, 10.0)),
            run("valve at its limit", valve(paper, 0.1)),
            run("valve without lead", valve([2.0, 0.02, 0.0], 10.0)),
            run("valve quicker than its lead", valve([2.0, 0.0015, 0.0], 10.0)),
        ],
    );
}

fn stencil(spacing: f32, behind: u32) -> impl FnOnce(&mut Tape) {
    move |tape| {
        let stencil = Stencil::new(spacing, DT).unwrap();
        let mut history = History::at(-0.01);
        tape.count(stencil.reach());
        for x in signal(41, 0.05, 300) {
            history.push(x);
            let seen = stencil.at(&history, stencil.reach() + behind);
            tape.note_all([seen.displacement, seen.velocity, seen.acceleration, seen.jerk]);
        }
    }
}

#[test]
fn trajectory_and_rest() {
    let friction = FrictionSettings { coulomb: 0.4, viscous: 2.0, velocity: 0.01, deadband: 0.003 };
    hold(
        "rest",
        &[
            run("stencil of 1 tick", stencil(0.001, 0)),
            run("stencil of 3 ticks", stencil(0.003, 5)),
            run("stencil of 8 ticks", stencil(0.008, 14)),
            run("disturbance", |tape| {
                let observer = Disturbance::new(20.0, 0.05, DT).unwrap();
                let mut state = DisturbanceState::default();
                let mut noise = Noise::new(43);
                let near = 0.98 * 0.05;
                for _ in 0..500 {
                    let (v, q) = (noise.next(), noise.next());
                    let pair = [noise.of(&[near, -near, 0.2 * v, 0.2 * v]), noise.of(&[near, 0.4, 0.2 * q, q])];
                    tape.note(observer.advance(&mut state, pair[0], pair[1]));
                }
            }),
            run("friction", |tape| {
                for settings in [friction, FrictionSettings { deadband: 0.0, ..friction }] {
                    let friction = Friction::new(&settings).unwrap();
                    for v in signal(47, 0.01, 300) {
                        tape.note_all([friction.force(v), friction.open(0.1 * v)]);
                    }
                }
            }),
            run("pressure", |tape| {
                let settings = PressureSettings { area_per_mass: 5e-6, gain: 0.005, corner: 0.5 };
                let damping = PressureDamping::new(&settings, DT).unwrap();
                let mut state = shakedown_core::blocks::filter::WashoutState::default();
                for (p, a) in signal(53, 1e6, 400).zip(signal(59, 4.0, 400)) {
                    tape.note(damping.advance(&mut state, p, a));
                }
            }),
        ],
    );
}
