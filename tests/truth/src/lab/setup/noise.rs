//! The noise of a case: what it truly is, with what the loop feeds back, and what the experiment states of it.

use super::Misstated;
use super::sensing::Sensor;
use super::visible::measure;
use crate::lab::engine::simulate;
use crate::lab::plant::Plant;
use crate::lab::scene::{Scene, Wish, rounded};
use crate::lab::stated::{Run, predict};
use crate::refit::Sigma;
use crate::rng::Stream;

/// Longest stretch that a noise is measured on (rows).
const ENOUGH: usize = 20_000;
/// Rows over which noise is distinguished from a motion that takes another course, as a table that sticks does in every repeat.
const BLOCK: usize = 50;
/// Change of a noise that no estimate distinguishes from none, as a natural logarithm.
const ALIKE: f64 = 0.05;

/// Finds the effective noise, and what the experiment states of it: an estimate from a stretch of its own at rest, the truth
/// within a factor, or nothing.
pub fn stated_noise(scene: &mut Scene, wish: Wish, rng: &mut Stream) {
    let accelerometer = scene.says.channels[1];
    let (mut d, mut a, mut n) = (0.0, 0.0, 0.0);
    let noise = noise_only(&scene.sensor);
    for run in stretches(scene) {
        let clean = predict(&scene.truth, &run, None);
        let noisy = predict(&scene.truth, &run, Some(&noise));
        let squares = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(p, q)| (p - q).powi(2)).sum::<f64>();
        d += squares(&noisy.displacement, &clean.displacement);
        a += squares(&noisy.acceleration, &clean.acceleration);
        n += run.reference.len() as f64;
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
    list(scene, if manner < 0.5 { "noise estimated" } else { "noise" });
}

/// Lists what is stated of the noise beside what it is.
fn list(scene: &mut Scene, kind: &'static str) {
    let mut entries = vec![("displacement", scene.says.noise.0, scene.sigma.displacement, "m")];
    entries.extend(scene.sigma.acceleration.map(|s| ("acceleration", scene.says.noise.1, s, "m/s2")));
    scene.misstated.extend(entries.into_iter().map(|(channel, stated, is, unit)| Misstated {
        kind,
        channel,
        run: None,
        quantity: "standard deviation",
        stated,
        is,
        unit,
        sigma: None,
        tolerated: &[],
    }));
}

/// The runs that a noise is measured on, none longer than it must be.
fn stretches(scene: &Scene) -> impl Iterator<Item = Run> + '_ {
    let rows = |run: &Run| run.reference.len().min(ENOUGH);
    scene
        .runs
        .iter()
        .scan(0, move |before, run| {
            let done = *before > 2 * ENOUGH;
            *before += rows(run);
            (!done).then_some(run)
        })
        .map(move |run| Run { reference: run.reference[..rows(run)].to_vec(), ..run.clone() })
}

/// The scene with the acceleration's noise as a flawed plant has it in its loop, what is said of it being as far from it as
/// it was: a valve that lags keeps from the table what the stated model lets the controller shake it with. The displacement's
/// is its own sensor's but for little. None where the noise stays what it was.
pub fn in_loop_of(plant: &Plant, scene: &Scene) -> Option<Scene> {
    let share = share(plant, scene).filter(|s| *s > 0.0 && s.ln().abs() > ALIKE)?;
    let mut own = scene.clone();
    own.sigma.acceleration = Some(share * scene.sigma.acceleration?);
    let restated = |stated: f64| rounded(share * stated, 3);
    own.says.noise.1 = scene.says.noise.1.map(restated);
    for entry in &mut own.misstated {
        if matches!(entry.kind, "noise" | "noise estimated") && entry.channel == "acceleration" {
            entry.is *= share;
            entry.stated = entry.stated.map(restated);
        }
    }
    measure(&mut own);
    Some(own)
}

/// The acceleration's noise in the plant's loop over that in the stated model's, in the middle block.
fn share(plant: &Plant, scene: &Scene) -> Option<f64> {
    let noise = noise_only(&scene.sensor);
    let mut shares = Vec::new();
    for run in stretches(scene) {
        let (clean, noisy) = (simulate(plant, &run, None)?, simulate(plant, &run, Some(&noise))?);
        let (still, shaken) = (predict(&scene.truth, &run, None), predict(&scene.truth, &run, Some(&noise)));
        let own = spreads(&noisy.acceleration, &clean.acceleration);
        let stated = spreads(&shaken.acceleration, &still.acceleration);
        shares.extend(own.iter().zip(&stated).filter(|(_, s)| **s > 0.0).map(|(o, s)| o / s));
    }
    shares.sort_by(f64::total_cmp);
    shares.get(shares.len() / 2).copied()
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

/// Standard deviation of `x` less `y` about a line, block by block.
fn spreads(x: &[f64], y: &[f64]) -> Vec<f64> {
    let away: Vec<f64> = x.iter().zip(y).map(|(p, q)| p - q).collect();
    away.chunks_exact(BLOCK).map(about_line).collect()
}

fn about_line(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let (mean, centre) = (x.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
    let places = || x.iter().enumerate().map(|(i, v)| (i as f64 - centre, v - mean));
    let slope = places().map(|(u, v)| u * v).sum::<f64>() / places().map(|(u, _)| u * u).sum::<f64>();
    (places().map(|(u, v)| (v - slope * u).powi(2)).sum::<f64>() / n).sqrt()
}
