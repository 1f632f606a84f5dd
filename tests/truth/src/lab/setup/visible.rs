//! How visible each fault of the set-up is by itself, in standard deviations over all rows.

use super::Misstated;
use super::sensing::{Channel, Sensor};
use crate::lab::scene::Scene;
use crate::lab::stated::{Kind as Law, Run, predict};

/// Rows of a run that are looked at; the rest counts alike.
const ROWS: usize = 20_000;

/// Measures every entry that can be measured.
pub fn measure(scene: &mut Scene) {
    let sigmas: Vec<Option<f64>> = scene.misstated.iter().map(|entry| sigma(scene, entry)).collect();
    for (entry, sigma) in scene.misstated.iter_mut().zip(sigmas) {
        entry.sigma = sigma;
    }
}

fn sigma(scene: &Scene, entry: &Misstated) -> Option<f64> {
    let rows = scene.rows() as f64;
    match entry.kind {
        "controller gain" | "controller delay" | "clock" => {
            Some(deviation(scene, |run| stated(scene, run, entry.kind), None))
        }
        "noise" => entry.stated.map(|stated| (stated / entry.is).ln().abs() * (2.0 * rows).sqrt()),
        "sensor lag" | "drift" | "hum" | "spikes" | "saw-tooth" | "clipped" | "coarse counts" => {
            let sensor = only(scene, entry);
            Some(deviation(scene, Run::clone, Some(&sensor)))
        }
        _ => None,
    }
}

/// The run with one thing as the experiment states it.
fn stated(scene: &Scene, run: &Run, kind: &str) -> Run {
    let mut run = run.clone();
    match kind {
        "clock" => run.dt /= scene.says.clock,
        "controller delay" => run.controller.late = 0,
        _ => {
            let [first, second, forward] = scene.says.gains;
            run.controller.kvf *= forward;
            match &mut run.controller.kind {
                Law::Pi { kp, ki } => (*kp, *ki) = (*kp * first, *ki * second),
                Law::Cascade { kp, kv } => (*kp, *kv) = (*kp * first, *kv * second),
            }
        }
    }
    run
}

/// Sensors that have nothing but this fault.
fn only(scene: &Scene, entry: &Misstated) -> Sensor {
    let mut sensor = Sensor { seed: scene.sensor.seed, ..Sensor::default() };
    let (from, to) = if entry.channel == "displacement" {
        (&scene.sensor.displacement, &mut sensor.displacement)
    } else {
        (&scene.sensor.acceleration, &mut sensor.acceleration)
    };
    let none = Channel::default();
    *to = match entry.kind {
        "sensor lag" => Channel { lag: from.lag, ..none },
        "drift" => Channel { drift: from.drift, ..none },
        "hum" => Channel { hum: from.hum, ..none },
        "spikes" => Channel { spikes: from.spikes, ..none },
        "saw-tooth" => Channel { saw: from.saw, ..none },
        "clipped" => Channel { range: from.range, ..none },
        _ => Channel { step: from.step, ..none },
    };
    sensor
}

/// Root of the sum of squares between the recordings with the change and without it, over all rows.
fn deviation(scene: &Scene, change: impl Fn(&Run) -> Run, sensor: Option<&Sensor>) -> f64 {
    let mut sum = 0.0;
    for run in &scene.runs {
        let rows = run.reference.len().min(ROWS);
        let short = Run { reference: run.reference[..rows].to_vec(), ..run.clone() };
        let clean = predict(&scene.truth, &short, None);
        let odd = predict(&scene.truth, &change(&short), sensor);
        let squares = |x: &[f64], y: &[f64], s: f64| x.iter().zip(y).map(|(a, b)| ((a - b) / s).powi(2)).sum::<f64>();
        let mut own = 0.0;
        if scene.says.channels[0] {
            own += squares(&odd.displacement, &clean.displacement, scene.sigma.displacement);
        }
        if let Some(sigma) = scene.sigma.acceleration {
            own += squares(&odd.acceleration, &clean.acceleration, sigma);
        }
        sum += own * run.reference.len() as f64 / rows.max(1) as f64;
    }
    sum.sqrt()
}
