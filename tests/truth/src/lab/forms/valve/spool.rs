//! Spools that take their time, or move no faster than their pilot lets them.

use crate::lab::closure::States;
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;
use std::f64::consts::TAU;

/// Frequency (Hz) and damping ratio.
fn band(dial: &Dial) -> (f64, f64) {
    let slowest = 0.8 * dial.scales.crossover / TAU;
    (slowest / dial.s.max(1e-3), dial.draw.between(0, 0.5, 1.0))
}

/// Beyond this (Hz) a pole is left out: nothing of the tests reaches it.
const FASTEST: f64 = 900.0;

fn parameters(frequency: f64, damping: f64) -> Parameters {
    vec![("frequency", frequency), ("damping", damping)]
}

/// A torque motor in front of a second-order spool.
pub(super) fn third_order(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping) = band(dial);
    let w = TAU * frequency.min(FASTEST);
    let motor = (dial.draw.between(1, 3.0, 8.0) * w).min(TAU * FASTEST);
    plant.add(
        Place::Valve,
        States {
            count: 3,
            fastest: motor.max(w),
            rates: move |_, u, y, dy| {
                dy[0] = motor * (u - y[0]);
                dy[1] = y[2];
                dy[2] = w * w * (y[0] - y[1]) - 2.0 * damping * w * y[2];
            },
            out: |_, _, y| y[1],
        },
    );
    parameters(frequency, damping)
}

/// A second-order spool whose drive saturates: large steps are slower than small ones.
pub(super) fn limited_force(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping) = band(dial);
    let w = TAU * frequency.min(FASTEST);
    let most = dial.draw.between(1, 0.25, 0.8) * w * w * dial.scales.command_rate / w;
    plant.add(
        Place::Valve,
        States {
            count: 2,
            fastest: w,
            rates: move |_, u, y, dy| {
                dy[0] = y[1];
                dy[1] = most * (w * w * (u - y[0]) / most).tanh() - 2.0 * damping * w * y[1];
            },
            out: |_, _, y| y[0],
        },
    );
    parameters(frequency, damping)
}

/// Flow forces close the spool: stiffness and damping grow with the opening.
pub(super) fn flow_forces(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping) = band(dial);
    let w = TAU * frequency.min(FASTEST);
    let (full, more) = (0.7 * dial.scales.command, dial.draw.between(1, 0.3, 1.0));
    plant.add(
        Place::Valve,
        States {
            count: 2,
            fastest: 2.0 * w,
            rates: move |_, u: f64, y: &[f64], dy: &mut [f64]| {
                let grown = 1.0 + more * (y[0] / full).powi(2).min(1.0);
                dy[0] = y[1];
                dy[1] = grown * w * w * (u - y[0]) - 2.0 * damping * grown * w * y[1];
            },
            out: |_, _, y| y[0],
        },
    );
    parameters(frequency, damping)
}

fn rate(dial: &Dial) -> f64 {
    0.05 * dial.scales.command_rate / dial.s.max(1e-3)
}

/// A pilot whose flow saturates softly with the error of the spool.
pub(super) fn pilot(plant: &mut Plant, dial: &Dial) -> Parameters {
    let rate = rate(dial);
    let pace = dial.draw.log_between(0, 300.0, 1500.0);
    plant.add(
        Place::Valve,
        States {
            count: 1,
            fastest: pace,
            rates: move |_, u, y, dy| dy[0] = rate * (pace * (u - y[0]) / rate).tanh(),
            out: |_, _, y| y[0],
        },
    );
    vec![("rate", rate)]
}

/// A pilot with inertia: its rate builds up and is limited.
pub(super) fn inertial(plant: &mut Plant, dial: &Dial) -> Parameters {
    let rate = rate(dial);
    let w = dial.draw.log_between(0, 400.0, 1200.0);
    plant.add(
        Place::Valve,
        States {
            count: 2,
            fastest: 2.0 * w,
            rates: move |_, u: f64, y: &[f64], dy: &mut [f64]| {
                let wanted = (0.5 * w * (u - y[0])).clamp(-rate, rate);
                dy[0] = y[1];
                dy[1] = 2.0 * w * (wanted - y[1]);
            },
            out: |_, _, y| y[0],
        },
    );
    vec![("rate", rate)]
}

/// A pilot that opens faster than it closes.
pub(super) fn unequal(plant: &mut Plant, dial: &Dial) -> Parameters {
    let rate = rate(dial);
    let pace = dial.draw.log_between(0, 500.0, 1500.0);
    let off = dial.draw.between(1, 0.03, 0.12) * dial.draw.sign;
    plant.add(
        Place::Valve,
        States {
            count: 1,
            fastest: pace,
            rates: move |_, u: f64, y: &[f64], dy: &mut [f64]| {
                dy[0] = (pace * (u - y[0])).clamp(-rate * (1.0 - off), rate * (1.0 + off));
            },
            out: |_, _, y| y[0],
        },
    );
    vec![("rate", rate)]
}
