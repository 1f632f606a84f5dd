//! Unlisted flaws of command, valve, flow and sensors.

use crate::lab::closure::{Map, Memories, States};
use crate::lab::forms::Dial;
use crate::lab::law::Place;
use crate::lab::plant::Plant;
use std::f64::consts::TAU;

pub(super) fn hysteresis(plant: &mut Plant, dial: &Dial) {
    let widths = [0.05, 0.12, 0.3].map(|w| w * dial.scales.command);
    let share = 0.33 * dial.s;
    plant.add(
        Place::Command,
        Memories {
            count: 3,
            fastest: 0.0,
            remember: move |_, u, _, m| {
                for (play, width) in m.iter_mut().zip(widths) {
                    *play = play.clamp(u - width, u + width);
                }
            },
            out: move |_, u, m| u * (1.0 - 3.0 * share) + share * (m[0] + m[1] + m[2]),
        },
    );
}

pub(super) fn clipped(plant: &mut Plant, dial: &Dial) {
    let most = dial.scales.command * (1.0 - 0.9 * dial.s);
    plant.add(Place::Command, Map(move |_, u| u.clamp(-most, most)));
}

pub(super) fn oscillating(plant: &mut Plant, dial: &Dial) {
    let (size, frequency) = (0.5 * dial.s * dial.scales.command, dial.draw.log_between(0, 0.8, 4.0) * dial.scales.top);
    plant.add(Place::Command, Map(move |now, u| u + size * (TAU * frequency * now.t + now.run as f64).sin()));
}

pub(super) fn notched(plant: &mut Plant, dial: &Dial) {
    let (from, steeper) = (dial.draw.between(0, 0.15, 0.4) * dial.scales.command, 2.0 * dial.s);
    plant.add(Place::Valve, Map(move |_, w| w + w.signum() * steeper * (w.abs() - from).max(0.0)));
}

pub(super) fn underlap(plant: &mut Plant, dial: &Dial) {
    let (half, gain) = (dial.draw.between(0, 0.02, 0.08) * dial.scales.command, 2.0 * dial.s);
    plant.add(Place::Valve, Map(move |_, w| w + gain * w.clamp(-half, half)));
}

pub(super) fn one_sided_lag(plant: &mut Plant, dial: &Dial) {
    let slow = 0.3 * dial.s / dial.scales.crossover;
    let slow = slow.max(1e-4);
    plant.add(
        Place::Command,
        States {
            count: 1,
            fastest: 2000.0,
            rates: move |_, u, y, dy| {
                let opening = (u - y[0]) * y[0] >= 0.0;
                dy[0] = (u - y[0]) / if opening { slow.max(5e-4) } else { 5e-4 };
            },
            out: |_, _, y| y[0],
        },
    );
}

pub(super) fn gain_by_place(plant: &mut Plant, dial: &Dial) {
    let (share, reach) = (0.6 * dial.s, dial.scales.stroke);
    let phase = dial.draw.between(0, 0.0, TAU);
    plant.add(Place::Flow, Map(move |now, q| q * (1.0 + share * (4.0 * now.x / reach + phase).sin())));
}

pub(super) fn pulsation(plant: &mut Plant, dial: &Dial) {
    let (share, frequency) = (0.5 * dial.s, dial.draw.log_between(0, 1.0, 5.0) * dial.scales.top);
    plant.add(Place::Flow, Map(move |now, q| q * (1.0 + share * (TAU * frequency * now.t).sin())));
}

pub(super) fn sinking_limit(plant: &mut Plant, dial: &Dial) {
    let (limit, rate) = (dial.scales.limit, 0.5 * dial.s / dial.scales.duration);
    plant.add(
        Place::Limit,
        Map(move |now, d| {
            let most = limit * (1.0 - rate * now.t).max(0.2);
            d.clamp(-most, most)
        }),
    );
}

pub(super) fn core_play(plant: &mut Plant, dial: &Dial) {
    let half = 0.02 * dial.s * dial.scales.stroke;
    plant.add(
        Place::Displacement,
        Memories {
            count: 1,
            fastest: 0.0,
            // The play's place relative to the core, so that it starts in the middle wherever the table stands.
            remember: move |now, _, h, m| m[0] = (m[0] - now.v * h).clamp(-half, half),
            out: |_, x, m| x + m[0],
        },
    );
}

pub(super) fn bracket(plant: &mut Plant, dial: &Dial) {
    let w = TAU * (1.2 * dial.scales.top / dial.s.max(1e-2)).min(300.0);
    let damping = dial.draw.between(0, 0.02, 0.08);
    plant.add(
        Place::SensedVelocity,
        States {
            count: 2,
            fastest: 2.0 * w,
            rates: move |_, v, y, dy| {
                dy[0] = v - y[1];
                dy[1] = w * w * y[0] + 2.0 * damping * w * (v - y[1]);
            },
            out: |_, _, y| y[1],
        },
    );
}

pub(super) fn crosstalk(plant: &mut Plant, dial: &Dial) {
    let gain = dial.draw.sign * 0.5 * dial.s * dial.scales.acceleration / dial.scales.command;
    plant.add(Place::Acceleration, Map(move |now, a| a + gain * now.command));
}

pub(super) fn slewing(plant: &mut Plant, dial: &Dial) {
    // The amplifier compresses large readings on one side more than on the other.
    let size = dial.scales.acceleration / (2.0 * dial.s.max(1e-3));
    let off = dial.draw.between(0, 0.2, 0.6) * size;
    plant.add(Place::Acceleration, Map(move |_, a| size * (((a + off) / size).tanh() - (off / size).tanh())));
}

pub(super) fn loose(plant: &mut Plant, dial: &Dial) {
    let (lost, way) = (dial.s, 0.5 * dial.scales.stroke);
    // It opens whenever the cable has bent far enough, here and there along the distance travelled.
    plant.add(
        Place::Acceleration,
        Map(move |now, a| {
            let bend = (2.399 * (now.path / way).floor() + now.run as f64).sin();
            if bend > 0.7 { a * (1.0 - lost) } else { a }
        }),
    );
}
