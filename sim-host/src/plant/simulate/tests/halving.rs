//! Halving the integration step: the simulated answer converges at the order that every effect's entry promises.
//!
//! A tick's command is held, as a converter holds it, while the steps within it are halved again and again. Where a corner falls
//! within a step is chance, and so is what one halving does to the error of a single run: errors are taken over several drives.

use super::super::dynamics::Dynamics;
use super::super::*;
use crate::plant::effects::{ENTRIES, Entry, Order, SignalScale};
use crate::plant::model::Kind;

/// A control tick, s, and how many there are.
const TICK: f64 = 4e-3;
const TICKS: usize = 300;

/// Displacement and sensed velocity after every tick, for so many steps in a tick.
fn moved(effects: &[EffectParameters<f64>], steps: usize, (phase, size): (f64, f64)) -> Vec<[f64; 2]> {
    let paper = Baseline::Servo { b1: 0.69, b0: 138.0, a1: 57.65, velocity_limit: 0.242 };
    let mut dynamics = Dynamics::new(&paper, effects).unwrap();
    let mut state = dynamics.rest(&Start { displacement: 0.0, velocity: 0.0, states: Vec::new(), time: 0.0 });
    let h = TICK / steps as f64;
    let sine = |t: f64, hz: f64, size: f64| size * (std::f64::consts::TAU * hz * t + phase).sin();
    let mut tick = |k: usize| {
        let t = k as f64 * TICK;
        state.command = size * (sine(t, 1.3, 0.05) + sine(t, 3.7, 0.012));
        for _ in 0..steps {
            dynamics.begin_step(&mut state, h);
            dynamics.advance(&mut state, h);
        }
        [dynamics.sense_displacement(&state), dynamics.velocities(&state).0]
    };
    (0..TICKS).map(&mut tick).collect()
}

/// What each halving leaves of the root mean square difference to the halving before, in powers of two on average: of the
/// displacement, and of the velocity that the accelerometer feels.
fn orders(effects: &[EffectParameters<f64>], size: f64, drives: usize, steps: &[usize]) -> [f64; 2] {
    let phases: Vec<f64> = (0..drives).map(|i| 0.77 * i as f64).collect();
    let answer = |&steps: &usize| -> Vec<[f64; 2]> {
        phases.iter().flat_map(|&phase| moved(effects, steps, (phase, size))).collect()
    };
    let answers: Vec<_> = steps.iter().map(answer).collect();
    let square = |(a, b): (&[f64; 2], &[f64; 2]), i: usize| (a[i] - b[i]).powi(2);
    [0, 1].map(|i| {
        let apart = |w: &[Vec<[f64; 2]>]| w[0].iter().zip(&w[1]).map(|pair| square(pair, i)).sum::<f64>().sqrt();
        let errors: Vec<f64> = answers.windows(2).map(apart).collect();
        (errors[0] / errors[errors.len() - 1]).log2() / (errors.len() - 1) as f64
    })
}

/// What an effect's starting values are multiples of, under these drives.
fn size(signal_scale: SignalScale) -> f64 {
    match signal_scale {
        SignalScale::One | SignalScale::Force => 1.0,
        SignalScale::Command => 0.05,
        SignalScale::CommandRate => 2.0,
        SignalScale::Speed => 0.1,
        SignalScale::Displacement => 0.02,
        SignalScale::Curvature => 2500.0,
        SignalScale::Duration => 30.0,
        SignalScale::Line => 50.0,
    }
}

/// Parameters at which the effect is at work, off round values.
fn at_work(entry: &'static Entry) -> Vec<EffectParameters<f64>> {
    let largest = entry.parameters.iter().map(|p| 1.037 * size(p.signal_scale) * p.starts.last().unwrap());
    vec![EffectParameters { id: entry.id, parameters: largest.collect() }]
}

/// Whether a sensor's velocity depends on where the table has been.
fn remembers(effects: &[EffectParameters<f64>]) -> bool {
    let hooks = effects.iter().filter_map(|placed| build(placed.id, &placed.parameters)).map(|effect| effect.hooks());
    hooks.into_iter().any(|hooks| hooks.after && hooks.velocity)
}

#[test]
fn every_effect_converges_at_the_order_it_promises() {
    let mut wrong = Vec::new();
    for entry in ENTRIES.iter().filter(|e| e.kinds.contains(&Kind::Servo)) {
        let effects = at_work(entry);
        let (promised, mut found) = match entry.order {
            Order::Fourth => (4.0, orders(&effects, 1.0, 1, &[4, 8, 16, 32])),
            Order::Second => (2.0, orders(&effects, 1.0, 6, &[8, 16, 32, 64, 128])),
        };
        // What the accelerometer feels behind a joint is taken by strides of the joint's own: steps count where they are shorter.
        if remembers(&effects) {
            found[1] = orders(&effects, 1.0, 2, &[64, 128, 256, 512])[1];
        }
        // A velocity that is read at an instant shows the command's mean over the step that ends there: one order less.
        if found[0] < promised - 0.25 || found[1] < promised - 1.25 {
            wrong.push(format!("{}: {found:.2?} for {promised}", entry.id));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The velocity limit of the model itself is a corner too; away from it the model is smooth.
#[test]
fn the_limit_converges_at_second_order() {
    let free = orders(&[], 1.0, 1, &[4, 8, 16, 32]);
    let limited = orders(&[], 3.0, 6, &[8, 16, 32, 64, 128]);
    assert!(free[0] > 3.75 && limited[0] > 1.75, "{free:?} {limited:?}");
}

/// How an effect's equations are written is no matter of the step they are taken in: an orifice under load answers to long steps
/// as to short ones, within what the short ones differ by among themselves.
#[test]
fn equations_do_not_depend_on_the_step() {
    for (id, parameters) in
        [("load_dependent_flow", vec![12.0, 1000.0, 0.2]), ("leakage", vec![1e-4]), ("leakage", vec![1e-3, 1.7])]
    {
        let effects = [EffectParameters { id, parameters }];
        let [long, short, fine] = [8, 32, 256].map(|steps| moved(&effects, steps, (0.3, 1.0)));
        let apart = |a: &[[f64; 2]]| a.iter().zip(&fine).map(|(a, b)| (a[0] - b[0]).abs()).fold(0.0, f64::max);
        // A ten-thousandth of the LVDT's step of 0.04 mm.
        assert!(apart(&long) < 1e-7 && apart(&short) < 4e-9, "{id}: {:e} {:e}", apart(&long), apart(&short));
    }
}
