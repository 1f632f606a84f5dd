//! The noise of a case: what it truly is, with what the loop feeds back, and what the experiment states of it.

use super::Misstated;
use super::sensing::Sensor;
use crate::lab::scene::{Scene, Wish, rounded};
use crate::lab::stated::{Run, predict};
use crate::refit::Sigma;
use crate::rng::Stream;

/// Longest stretch that a noise is measured on (rows).
const ENOUGH: usize = 20_000;

/// Finds the effective noise, and what the experiment states of it: an estimate from a stretch of its own at rest, the truth
/// within a factor, or nothing.
pub fn stated_noise(scene: &mut Scene, wish: Wish, rng: &mut Stream) {
    let accelerometer = scene.says.channels[1];
    let (mut d, mut a, mut n) = (0.0, 0.0, 0.0);
    let noise = noise_only(&scene.sensor);
    for run in &scene.runs {
        let short = Run { reference: run.reference[..run.reference.len().min(ENOUGH)].to_vec(), ..run.clone() };
        let clean = predict(&scene.truth, &short, None);
        let noisy = predict(&scene.truth, &short, Some(&noise));
        let squares = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| (p - q).powi(2)).sum::<f64>();
        d += squares(&noisy.displacement, &clean.displacement);
        a += squares(&noisy.acceleration, &clean.acceleration);
        n += short.reference.len() as f64;
        if n > 2.0 * ENOUGH as f64 {
            break;
        }
    }
    scene.sigma = Sigma { displacement: (d / n).sqrt(), acceleration: accelerometer.then(|| (a / n).sqrt()) };
    let estimate = at_rest(scene, &noise, rng.uniform(2.0, 12.0));
    let manner = if wish.perfect { 0.0 } else { rng.unit() };
    let factor = rng.sign() * rng.log_uniform(0.03, 0.5);
    let of = |estimated: f64, true_one: f64| match manner {
        m if m < 0.5 => Some(rounded(estimated, 3)),
        m if m < 0.8 => Some(rounded(true_one * factor.exp(), 3)),
        _ => None,
    };
    scene.says.noise.0 = of(estimate.0, scene.sigma.displacement);
    scene.says.noise.1 = scene.sigma.acceleration.and_then(|s| of(estimate.1, s));
    let kind = if manner < 0.5 { "noise estimated" } else { "noise" };
    let mut entries = vec![("displacement", scene.says.noise.0, scene.sigma.displacement, "m")];
    entries.extend(scene.sigma.acceleration.map(|s| ("acceleration", scene.says.noise.1, s, "m/s2")));
    for (channel, stated, is, unit) in entries {
        let entry = Misstated {
            kind,
            channel,
            run: None,
            quantity: "standard deviation",
            stated,
            is,
            unit,
            sigma: None,
            tolerated: &[],
        };
        scene.misstated.push(entry);
    }
}

/// The sensors with their noise and counts alone: no lag, drift, spikes, hum or end of range.
fn noise_only(sensor: &Sensor) -> Sensor {
    let mut only = *sensor;
    for channel in [&mut only.displacement, &mut only.acceleration] {
        (channel.lag, channel.range) = (0.0, 0.0);
        (channel.drift, channel.spikes, channel.hum, channel.saw) = (None, None, None, None);
    }
    only
}

/// Standard deviations (m, m/s2) of a recording of its own at rest, in closed loop.
fn at_rest(scene: &Scene, noise: &Sensor, seconds: f64) -> (f64, f64) {
    let run = &scene.runs[0];
    let rows = ((seconds / run.dt) as usize).clamp(200, ENOUGH);
    // The table stands somewhere between two counts.
    let place = scene.scales.stroke * 0.137;
    let rest = Run { reference: vec![place; rows], number: 99, ..run.clone() };
    let made = predict(&scene.truth, &rest, Some(noise));
    let spread = |x: &[f64]| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (x.len() - 1) as f64).sqrt()
    };
    let floor = 0.28867 * scene.sensor.displacement.step;
    (spread(&made.displacement).max(floor), spread(&made.acceleration))
}
