//! Foundations: a reaction mass that the actuator pushes against. The accelerometer is absolute, the displacement relative.

use crate::lab::closure::States;
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::{Law, Now, Place};
use crate::lab::plant::Plant;
use std::f64::consts::TAU;

/// Frequency (Hz), damping ratio (1), table mass over reaction mass (1).
fn drawn(dial: &Dial) -> (f64, f64, f64, Parameters) {
    let frequency = dial.draw.log_between(0, 4.0, 15.0);
    let damping = dial.draw.between(1, 0.03, 0.12);
    let ratio = dial.s;
    (frequency, damping, ratio, vec![("frequency", frequency), ("damping", damping), ("mass_ratio", ratio)])
}

/// Velocity of the base from its momentum over the whole mass and the actuator's velocity.
fn moving(ratio: f64, v: f64, momentum: f64) -> f64 {
    momentum - ratio / (1.0 + ratio) * v
}

pub(super) fn hardening(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping, ratio, parameters) = drawn(dial);
    let w = TAU * frequency;
    let reach = 0.5 * ratio * dial.scales.acceleration / (w * w);
    let harder = dial.draw.between(2, 0.05, 0.4);
    plant.add(
        Place::Frame,
        States {
            count: 2,
            fastest: 2.0 * w,
            rates: move |_, v: f64, y: &[f64], dy: &mut [f64]| {
                let speed = moving(ratio, v, y[1]);
                let filled = (y[0] / (reach + 1e-9)).powi(2).min(4.0);
                dy[0] = speed;
                dy[1] = -w * w * y[0] * (1.0 + harder * filled) - 2.0 * damping * w * speed;
            },
            out: move |_, v: f64, y: &[f64]| v + moving(ratio, v, y[1]),
        },
    );
    parameters
}

/// Soil that slips grain by grain: springs with plays, so that the loss does not grow with frequency.
#[derive(Debug, Clone, Copy)]
struct Soil {
    w: f64,
    damping: f64,
    ratio: f64,
    widths: [f64; 3],
    share: f64,
}

impl Soil {
    fn pull(&self, y: &[f64], m: &[f64]) -> f64 {
        let held: f64 = m.iter().zip(&self.widths).map(|(play, width)| (y[0] - play).clamp(-width, *width)).sum();
        self.w * self.w * ((1.0 - self.share) * y[0] + self.share * held / 3.0)
    }
}

impl Law for Soil {
    fn states(&self) -> usize {
        2
    }

    fn memories(&self) -> usize {
        3
    }

    fn rates(&self, _: &Now, input: f64, y: &[f64], m: &[f64], dy: &mut [f64]) {
        let speed = moving(self.ratio, input, y[1]);
        dy[0] = speed;
        dy[1] = -self.pull(y, m) - 2.0 * self.damping * self.w * speed;
    }

    fn watch(&self, y: &[f64], m: &mut [f64]) {
        for (play, width) in m.iter_mut().zip(&self.widths) {
            *play = play.clamp(y[0] - width, y[0] + width);
        }
    }

    fn out(&self, _: &Now, input: f64, y: &[f64], _: &[f64]) -> f64 {
        input + moving(self.ratio, input, y[1])
    }

    fn fastest(&self) -> f64 {
        2.0 * self.w
    }
}

pub(super) fn hysteretic(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping, ratio, parameters) = drawn(dial);
    let w = TAU * frequency;
    let reach = 0.5 * ratio * dial.scales.acceleration / (w * w);
    let share = dial.draw.between(2, 0.1, 0.3);
    plant.add(
        Place::Frame,
        Soil { w, damping: 0.7 * damping, ratio, widths: [0.1, 0.3, 1.0].map(|k| k * reach), share },
    );
    parameters
}

/// Sway and, above it, rocking, which moves the table's level too.
pub(super) fn rocking(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (frequency, damping, ratio, parameters) = drawn(dial);
    let (w, wr) = (TAU * frequency, TAU * frequency * dial.draw.between(2, 1.6, 2.6));
    let share = dial.draw.between(3, 0.05, 0.25);
    plant.add(
        Place::Frame,
        States {
            count: 4,
            fastest: 2.0 * wr,
            rates: move |_, v: f64, y: &[f64], dy: &mut [f64]| {
                let (sway, rock) = (moving(ratio, v, y[1]), moving(share * ratio, v, y[3]));
                dy[0] = sway;
                dy[1] = -w * w * y[0] - 2.0 * damping * w * sway;
                dy[2] = rock;
                dy[3] = -wr * wr * y[2] - 2.0 * damping * wr * rock;
            },
            out: move |_, v: f64, y: &[f64]| v + moving(ratio, v, y[1]) + moving(share * ratio, v, y[3]),
        },
    );
    parameters
}
