//! Tests as laboratories run them that show little: slow, small, at one speed, or with one sensor.

use crate::excitation::{Excitation, Shape, reference};
use crate::lab::stated::{Controller, Kind as Law, Run};
use crate::plant::Machine;
use crate::refit::Parameter;
use crate::rng::Stream;
use std::f64::consts::{PI, TAU};

/// What the runs of a test are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Motion {
    /// Far below the loop's crossover.
    Slow,
    /// Small, about a place off the middle of the stroke.
    OffMiddle,
    /// One stroke a run, there and back in turn, each at a speed of its own.
    Strokes,
}

/// A test that shows little.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Test {
    /// Its motion.
    pub motion: Motion,
    /// Whether the acceleration is recorded beside the displacement.
    pub accelerometer: bool,
    /// Parameters of the servo model that its experiment lets be re-estimated.
    pub free: &'static [Parameter],
}

/// Rate (Hz), length of a run (s), and number of runs.
pub(super) struct Extent {
    pub(super) rate: f64,
    pub(super) seconds: f64,
    pub(super) count: usize,
}

/// Rate and length: a few short runs, as one look at a machine takes.
pub(super) fn extent(motion: Motion, rng: &mut Stream) -> Extent {
    let rate = rng.pick([100.0, 128.0, 200.0, 250.0, 256.0, 500.0]);
    Extent {
        rate,
        seconds: rng.uniform(8.0, 14.0),
        count: if motion == Motion::Strokes { 3 } else { 2 } + rng.below(2),
    }
}

/// The runs of a test in the loop of `controller`, and their largest frequency (Hz).
pub(super) fn runs(
    motion: Motion,
    truth: &Machine,
    controller: Controller,
    extent: &Extent,
    rng: &mut Stream,
) -> (Vec<Run>, f64) {
    let (limit, gain) = match *truth {
        Machine::Servo { b0, a1, velocity_limit, .. } => (velocity_limit, b0 / a1),
        Machine::Rigid { viscous, gain, .. } => (0.3, gain / viscous),
    };
    let crossover = match controller.kind {
        Law::Pi { kp, .. } => kp * gain,
        Law::Cascade { kp, .. } => 0.5 * kp,
    };
    let (references, top) = references(motion, extent, (limit, crossover), rng);
    let run = |(number, mut reference): (usize, Vec<f64>)| {
        as_filed(&mut reference);
        Run { reference, dt: 1.0 / extent.rate, controller, number: number as u64 }
    };
    (references.into_iter().enumerate().map(run).collect(), top)
}

/// The file holds tenths of a micrometre, and the controller saw what the file holds.
pub(super) fn as_filed(x: &mut [f64]) {
    for v in x {
        *v = (*v * 1e7).round() / 1e7;
    }
}

/// Reference displacements (m) of all runs of a test, and their largest frequency (Hz), under a velocity limit (m/s) and a
/// crossover (rad/s).
fn references(
    motion: Motion,
    extent: &Extent,
    (limit, crossover): (f64, f64),
    rng: &mut Stream,
) -> (Vec<Vec<f64>>, f64) {
    let (speed, top) = match motion {
        Motion::Slow => (rng.uniform(0.05, 0.4), rng.uniform(0.03, 0.15) * crossover / TAU),
        Motion::OffMiddle => (rng.uniform(0.1, 0.7), rng.uniform(1.0, 5.0)),
        Motion::Strokes => (rng.uniform(0.05, 0.5), 0.3),
    };
    let shape = Shape {
        dt: 1.0 / extent.rate,
        count: (extent.seconds * extent.rate) as usize,
        velocity: speed * limit,
        displacement: if motion == Motion::OffMiddle {
            rng.log_uniform(0.002, 0.02)
        } else {
            rng.log_uniform(0.1, 0.6) * limit.max(0.2)
        },
        top: top.clamp(0.2, 0.04 * extent.rate),
    };
    let rise = rng.uniform(0.3, 1.0);
    let place = if motion == Motion::OffMiddle { rng.sign() * rng.log_uniform(0.1, 0.5) } else { 0.0 };
    let list = (0..extent.count).map(|i| match motion {
        Motion::Strokes => stroke(&shape, if i % 2 == 0 { 1.0 } else { -1.0 } * rng.uniform(0.3, 1.0), rise),
        _ => any(&shape, rng).iter().map(|x| x + place).collect(),
    });
    (list.collect(), shape.top)
}

fn any(shape: &Shape, rng: &mut Stream) -> Vec<f64> {
    use Excitation as E;
    reference(rng.pick([E::Noise, E::Multisine, E::Quake, E::Pulses, E::Steps]), shape, rng)
}

/// From rest to a share `way` of the speed of `shape` in `rise` seconds, and on to the end.
fn stroke(shape: &Shape, way: f64, rise: f64) -> Vec<f64> {
    let mut x = 0.0;
    let speed = |t: f64| way * shape.velocity * (0.5 - 0.5 * (PI * ((t - 0.25) / rise).clamp(0.0, 1.0)).cos());
    (0..shape.count)
        .map(|k| {
            x += shape.dt * speed(k as f64 * shape.dt);
            x
        })
        .collect()
}
