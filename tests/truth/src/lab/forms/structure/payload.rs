//! Specimens.

use crate::lab::closure::States;
use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::{Law, Now, Place};
use crate::lab::plant::Plant;
use std::f64::consts::TAU;

/// Mass ratio (1), frequency (Hz), damping ratio (1), and the stretch that the tests reach (m).
fn drawn(dial: &Dial) -> (f64, f64, f64, f64, Parameters) {
    let ratio = 1.2 * dial.s;
    let frequency = dial.draw.log_between(0, 0.25, 1.4) * dial.scales.top;
    let damping = dial.draw.log_between(1, 0.008, 0.06);
    let stretch = dial.scales.acceleration / (TAU * frequency).powi(2);
    (ratio, frequency, damping, stretch, vec![("mass_ratio", ratio), ("frequency", frequency), ("damping", damping)])
}

/// Two storeys of a shear frame; the stated frequency is the first mode's.
pub(super) fn storeys(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (ratio, frequency, damping, _, parameters) = drawn(dial);
    let upper = dial.draw.between(2, 0.1, 0.5);
    let apart = dial.draw.between(3, 2.0, 3.2);
    // With the upper storey stiff, the lower spring carries both masses.
    let w2 = (TAU * frequency).powi(2) * (1.0 + 1.0 / (apart * apart) * upper);
    let wu2 = (TAU * frequency * apart).powi(2);
    let (c, cu) = (2.0 * damping * TAU * frequency, 2.0 * damping * TAU * frequency * apart);
    let lower = ratio / (1.0 + upper);
    let shear = move |now: &Now, y: &[f64]| (1.0 + upper) * (w2 * y[0] + c * (y[1] - now.ground));
    plant.add(
        Place::Force,
        States {
            count: 4,
            fastest: 1.5 * TAU * frequency * apart,
            rates: move |now, _, y: &[f64], dy: &mut [f64]| {
                let above = wu2 * y[2] + cu * (y[3] - y[1]);
                dy[0] = y[1] - now.ground;
                dy[1] = -shear(now, y) + upper * above;
                dy[2] = y[3] - y[1];
                dy[3] = -above;
            },
            out: move |now, f: f64, y: &[f64]| f - lower * shear(now, y),
        },
    );
    parameters
}

/// A tank: the mass that sloshes hardens as its wave grows, and its wave breaks.
pub(super) fn sloshing(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (ratio, frequency, damping, stretch, parameters) = drawn(dial);
    let w = TAU * frequency;
    let (harder, breaking) = (dial.draw.between(2, 0.02, 0.2), dial.draw.between(3, 0.0, 0.05));
    let push = move |now: &Now, y: &[f64]| {
        let filled = (y[0] / (3.0 * stretch)).powi(2).min(4.0);
        w * w * y[0] * (1.0 + harder * filled) + 2.0 * (damping + breaking * filled) * w * (y[1] - now.ground)
    };
    plant.add(
        Place::Force,
        States {
            count: 2,
            fastest: 2.0 * w,
            rates: move |now, _, y: &[f64], dy: &mut [f64]| {
                dy[0] = y[1] - now.ground;
                dy[1] = -push(now, y);
            },
            out: move |now, f: f64, y: &[f64]| f - ratio * push(now, y),
        },
    );
    parameters
}

/// A frame that yields, with Bouc and Wen's hysteresis.
pub(super) fn yielding(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (ratio, frequency, damping, stretch, parameters) = drawn(dial);
    let w = TAU * frequency;
    let (post, yields) = (dial.draw.between(2, 0.1, 0.4), dial.draw.between(3, 3.0, 10.0) * stretch);
    let push = move |now: &Now, y: &[f64]| {
        w * w * (post * y[0] + (1.0 - post) * y[2]) + 2.0 * damping * w * (y[1] - now.ground)
    };
    plant.add(
        Place::Force,
        States {
            count: 3,
            fastest: 2.0 * w,
            rates: move |now, _, y: &[f64], dy: &mut [f64]| {
                let slip = y[1] - now.ground;
                let r = y[2] / yields;
                dy[0] = slip;
                dy[1] = -push(now, y);
                // Exponent two: beta = gamma = 1/2.
                dy[2] = slip - 0.5 * r * r * (slip + slip.abs() * r.signum());
            },
            out: move |now, f: f64, y: &[f64]| f - ratio * push(now, y),
        },
    );
    parameters
}

/// A wall that cracks: its stiffness sinks with the largest drift it has seen.
#[derive(Debug, Clone, Copy)]
struct Cracking {
    ratio: f64,
    w: f64,
    damping: f64,
    loss: f64,
    drift: f64,
}

impl Cracking {
    fn push(&self, now: &Now, y: &[f64], m: &[f64]) -> f64 {
        let sound = 1.0 - self.loss * (1.0 - (-m[0] / self.drift).exp());
        self.w * self.w * sound * y[0] + 2.0 * self.damping * self.w * (y[1] - now.ground)
    }
}

impl Law for Cracking {
    fn states(&self) -> usize {
        2
    }

    fn memories(&self) -> usize {
        2
    }

    fn rates(&self, now: &Now, _: f64, y: &[f64], m: &[f64], dy: &mut [f64]) {
        dy[0] = y[1] - now.ground;
        dy[1] = -self.push(now, y, m);
    }

    fn watch(&self, y: &[f64], m: &mut [f64]) {
        m[0] = m[0].max(y[0].abs());
    }

    fn out(&self, now: &Now, input: f64, y: &[f64], m: &[f64]) -> f64 {
        input - self.ratio * self.push(now, y, m)
    }

    fn fastest(&self) -> f64 {
        2.0 * self.w
    }
}

pub(super) fn cracking(plant: &mut Plant, dial: &Dial) -> Parameters {
    let (ratio, frequency, damping, stretch, parameters) = drawn(dial);
    let law = Cracking {
        ratio,
        w: TAU * frequency,
        damping: damping + 0.01,
        loss: dial.draw.between(2, 0.03, 0.15),
        drift: dial.draw.between(3, 1.0, 4.0) * stretch,
    };
    plant.add(Place::Force, law);
    parameters
}
