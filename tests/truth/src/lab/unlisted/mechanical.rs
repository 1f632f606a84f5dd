//! Unlisted forces on the table, per table mass (m/s2).

use crate::lab::closure::{Map, Memories, States};
use crate::lab::forms::Dial;
use crate::lab::forms::friction::{Levels, LuGre};
use crate::lab::law::{Gate, Part, Place, Variable};
use crate::lab::plant::Plant;
use std::f64::consts::TAU;
use std::sync::Arc;

fn contact(dial: &Dial) -> LuGre {
    let sliding = 2.0 * dial.s * dial.scales.acceleration;
    let levels = Levels { sliding, breakaway: 1.2 * sliding, stribeck: 0.03 * dial.scales.velocity, exponent: 2.0 };
    LuGre::new(levels, 1e-5)
}

pub(super) fn rough_patch(plant: &mut Plant, dial: &Dial) {
    let (centre, half) =
        (dial.draw.between(0, -0.4, 0.4) * dial.scales.stroke, dial.draw.between(1, 0.1, 0.3) * dial.scales.stroke);
    let gate =
        Gate::State { variable: Variable::Displacement, low: centre - half, high: centre + half, edge: 0.2 * half };
    plant.add_part(Part { place: Place::Force, law: Arc::new(contact(dial)), gate: Some(gate) });
}

pub(super) fn ripple(plant: &mut Plant, dial: &Dial) {
    let size = 2.0 * dial.s * dial.scales.acceleration;
    let (wavelength, phase) =
        (dial.draw.log_between(0, 0.08, 0.4) * dial.scales.stroke, dial.draw.between(1, 0.0, TAU));
    plant.add(Place::Force, Map(move |now, f| f + size * ((TAU * now.x / wavelength + phase).sin() - phase.sin())));
}

pub(super) fn quadratic(plant: &mut Plant, dial: &Dial) {
    let c = 5.0 * dial.s * dial.scales.acceleration / dial.scales.velocity.powi(2);
    plant.add(Place::Force, Map(move |now, f| f + c * now.v * now.v.abs()));
}

pub(super) fn binding(plant: &mut Plant, dial: &Dial) {
    let c = 3.0 * dial.s * dial.scales.pole / dial.scales.stroke.powi(2);
    let side = dial.draw.between(0, -0.3, 0.3) * dial.scales.stroke;
    plant.add(Place::Force, Map(move |now, f| f + c * (now.x - side).powi(2) * now.v));
}

/// A number in [0, 1) that a count and a run stand for.
fn chance(count: f64, run: u64) -> f64 {
    (43_758.545_3 * (12.9898 * count + 78.233 * (run as f64 + 1.0)).sin()).rem_euclid(1.0)
}

/// Bounds of the random level, as multiples of its scale.
const LEAST: f64 = 0.3;
const MOST: f64 = 3.3;

pub(super) fn random_breakaway(plant: &mut Plant, dial: &Dial) {
    let (level, slow) = (dial.s * dial.scales.acceleration, 0.02 * dial.scales.velocity);
    plant.add(
        Place::Force,
        Memories {
            count: 2,
            fastest: MOST * level / slow,
            remember: |now, _, _, m| {
                let direction = now.v.signum();
                if now.v != 0.0 && direction != m[0] {
                    m[0] = direction;
                    m[1] += 1.0;
                }
            },
            out: move |now, f, m| f + level * (now.v / slow).tanh() * (LEAST + (MOST - LEAST) * chance(m[1], now.run)),
        },
    );
}

pub(super) fn pounding(plant: &mut Plant, dial: &Dial) {
    let frequency = dial.draw.log_between(0, 0.3, 1.0) * dial.scales.top;
    let w = TAU * frequency;
    let free = 0.5 * dial.scales.acceleration / (w * w);
    let (ratio, times) = (1.2 * dial.s, dial.draw.between(1, 8.0, 25.0));
    let push = move |y: &[f64], ground: f64| {
        let beyond = (y[0].abs() - free).max(0.0) * y[0].signum();
        w * w * (y[0] + times * beyond) + 0.06 * w * (y[1] - ground)
    };
    plant.add(
        Place::Force,
        States {
            count: 2,
            fastest: 6.0 * w,
            rates: move |now, _, y, dy| {
                dy[0] = y[1] - now.ground;
                dy[1] = -push(y, now.ground);
            },
            out: move |now, f, y| f - ratio * push(y, now.ground),
        },
    );
}

pub(super) fn external(plant: &mut Plant, dial: &Dial) {
    let (size, frequency) =
        (2.0 * dial.s * dial.scales.acceleration, dial.draw.log_between(0, 0.3, 2.0) * dial.scales.top);
    plant.add(Place::Force, Map(move |now, f| f + size * (TAU * frequency * now.t + 1.7 * now.run as f64).sin()));
}

pub(super) fn ageing(plant: &mut Plant, dial: &Dial) {
    // The contact strengthens while it is slow and weakens with travel: rate and state.
    let (level, way) = (2.0 * dial.s * dial.scales.acceleration, 0.3 * dial.scales.stroke);
    let slow = 0.03 * dial.scales.velocity;
    plant.add(
        Place::Force,
        Memories {
            count: 1,
            fastest: level / slow,
            remember: move |now, _, h, m| {
                m[0] += h * ((1.0 - m[0]) / 0.4 - m[0] * now.v.abs() / way * 3.0);
                m[0] = m[0].clamp(0.0, 1.0);
            },
            out: move |now, f, m| f + level * m[0] * (now.v / slow).tanh(),
        },
    );
}
