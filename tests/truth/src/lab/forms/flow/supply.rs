//! Supplies that sink under a long draught. State: pressure over its start (1).

use crate::lab::forms::{Dial, Parameters};
use crate::lab::law::{Law, Now, Place};
use crate::lab::plant::Plant;

/// What feeds the accumulator.
#[derive(Debug, Clone, Copy)]
enum Pump {
    /// As much as the pressure asks for, up to a share of the flow at the limit.
    Compensated,
    /// The same, through a line whose resistance is turbulent.
    Line,
    /// All or little, by two pressures.
    Loading,
}

/// Accumulator and pump.
#[derive(Debug, Clone, Copy)]
struct Supply {
    pump: Pump,
    depth: f64,
    recovery: f64,
    exponent: f64,
    limit: f64,
}

impl Law for Supply {
    fn states(&self) -> usize {
        2
    }

    fn memories(&self) -> usize {
        1
    }

    fn at_rest(&self, _: f64, y: &mut [f64], _: &mut [f64]) {
        y.fill(1.0);
    }

    fn remember(&self, now: &Now, _: f64, h: f64, m: &mut [f64]) {
        // Where the pump's switch stands follows the draught of the last seconds: it loads while much is drawn.
        let drawn = now.v.abs() / self.limit;
        m[0] += (drawn - m[0]) * (1.0 - (-h / (0.3 * self.recovery)).exp());
    }

    fn rates(&self, _: &Now, input: f64, y: &[f64], m: &[f64], dy: &mut [f64]) {
        let r = y[0].clamp(0.05, 1.2);
        let drawn = self.depth * input.abs() * pressed(y) / self.limit;
        let feed = match self.pump {
            Pump::Compensated => (1.0 - r).clamp(0.0, 0.8),
            Pump::Line => (1.0 - r).max(0.0).sqrt() * 0.7 * self.depth.sqrt(),
            Pump::Loading => (1.0 - r).max(0.0) * if m[0] > 0.25 { 1.2 } else { 0.6 },
        };
        dy[0] = r.powf(1.0 + 1.0 / self.exponent) * (feed - drawn) / self.recovery;
        // The valve sees the accumulator through its own line.
        dy[1] = (y[0] - y[1]) / 0.02;
    }

    fn out(&self, _: &Now, input: f64, y: &[f64], _: &[f64]) -> f64 {
        input * pressed(y)
    }

    fn supply(&self, y: &[f64]) -> Option<f64> {
        Some(y[1])
    }

    fn fastest(&self) -> f64 {
        50.0
    }
}

/// Flow at this pressure over that at the start (1).
fn pressed(y: &[f64]) -> f64 {
    y[1].max(0.0).sqrt()
}

fn with(plant: &mut Plant, dial: &Dial, pump: Pump) -> Parameters {
    let law = Supply {
        pump,
        depth: 0.8 * dial.s,
        recovery: dial.draw.log_between(0, 0.5, 6.0),
        exponent: dial.draw.between(1, 1.1, 1.4),
        limit: dial.scales.limit,
    };
    plant.add(Place::Flow, law);
    vec![("depth", law.depth), ("recovery", law.recovery)]
}

pub(super) fn polytropic(plant: &mut Plant, dial: &Dial) -> Parameters {
    with(plant, dial, Pump::Compensated)
}

pub(super) fn line(plant: &mut Plant, dial: &Dial) -> Parameters {
    with(plant, dial, Pump::Line)
}

pub(super) fn loading(plant: &mut Plant, dial: &Dial) -> Parameters {
    with(plant, dial, Pump::Loading)
}
