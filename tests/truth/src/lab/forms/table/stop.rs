//! Ends of the stroke.

use crate::lab::closure::{Map, States};
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::Place;
use crate::lab::plant::Plant;

/// Position (m) and stiffness (1/s2).
fn drawn(dial: &Dial) -> (f64, f64, Parameters) {
    let position = dial.scales.stroke * (1.0 - 0.5 * dial.s);
    let stiffness = dial.draw.log_between(0, 10.0, 80.0) * dial.scales.acceleration / dial.scales.stroke;
    (position, stiffness, vec![("position", position), ("stiffness", stiffness)])
}

/// An elastomer that stiffens; a little is lost in it.
pub(super) fn elastomer(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (position, k, parameters) = drawn(dial);
    let (n, scale) = (dial.draw.between(1, 1.1, 1.5), 0.2 * dial.scales.stroke);
    plant.add(
        Place::Force,
        Map(move |now, f: f64| {
            let depth = (now.x.abs() - position).max(0.0);
            let into = 1.0 + 0.15 * (now.v * now.x.signum() / 0.05).tanh();
            f + now.x.signum() * k * scale * (depth / scale).powf(n) * into
        }),
    );
    parameters
}

/// Contact whose damping grows with its depth.
pub(super) fn hunt_crossley(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (position, k, parameters) = drawn(dial);
    let (loss, scale) = (dial.draw.between(1, 0.5, 2.0), 0.2 * dial.scales.stroke);
    let reach = dial.scales.velocity;
    plant.add(
        Place::Force,
        Map(move |now, f: f64| {
            let depth = (now.x.abs() - position).max(0.0);
            let force = k * scale * (depth / scale).powf(1.25) * (1.0 + loss * now.v * now.x.signum() / reach);
            f + now.x.signum() * force.max(0.0)
        }),
    );
    parameters
}

/// An oil cushion: the throttle's resistance while going in, a spring behind it that fills slowly.
pub(super) fn oil(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (position, k, parameters) = drawn(dial);
    let time = dial.draw.log_between(1, 0.01, 0.05);
    plant.add(
        Place::Force,
        States {
            count: 1,
            fastest: 1.0 / time,
            rates: move |now, _, y: &[f64], dy: &mut [f64]| {
                let depth = (now.x.abs() - position).max(0.0) * now.x.signum();
                dy[0] = (depth - y[0]) / time;
            },
            out: move |now, f: f64, y: &[f64]| {
                let depth = (now.x.abs() - position).max(0.0) * now.x.signum();
                // Ahead of the filled volume the throttle pushes as well; it never pulls.
                let force = k * (depth + 1.5 * (depth - y[0]));
                f + if force * now.x > 0.0 { force } else { 0.0 }
            },
        },
    );
    parameters
}
