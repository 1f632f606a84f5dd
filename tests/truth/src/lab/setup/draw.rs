//! Draws the sensors and what is misstated of the set-up.

use super::Misstated;
use crate::lab::scene::{Kind, Scene, Wish, rounded};
use crate::lab::stated::Kind as Law;
use crate::rng::Stream;

/// Draws sensors and misstatements into the scene.
pub fn setup(scene: &mut Scene, wish: Wish, rng: &mut Stream) {
    sensors(scene, rng);
    let servo = scene.kind == Kind::Servo;
    let accelerometer = wish.accelerometer || rng.chance(0.8);
    let accelerometer = wish.test.map_or(accelerometer, |test| test.accelerometer);
    let command = rng.chance(0.85);
    let displacement = !accelerometer || wish.accelerometer || rng.chance(0.97);
    let displacement = displacement || wish.test.is_some();
    scene.says.channels = [displacement, accelerometer, command];
    scene.says.pressures = (servo && rng.chance(0.3), servo && rng.chance(0.15));
    scene.says.laboratory_units = rng.chance(0.4);
    if !wish.perfect {
        loop_and_clock(scene, rng);
        displacement_faults(scene, rng);
        if accelerometer {
            accelerometer_faults(scene, rng);
        }
    }
}

/// Noise and counts of sound sensors.
fn sensors(scene: &mut Scene, rng: &mut Stream) {
    let stroke = scene.scales.stroke.max(0.02);
    let d = &mut scene.sensor.displacement;
    if scene.kind == Kind::Axis {
        (d.step, d.white) = (1e-6, rng.log_uniform(1e-6, 3e-6));
    } else {
        // Between twelve and sixteen bits over three times the stroke; the noise is never far below the count.
        d.step = 6.0 * stroke / 2.0_f64.powf(rng.uniform(12.5, 16.0));
        d.white = (rng.log_uniform(3e-5, 4e-4) * stroke).max(0.4 * d.step);
    }
    scene.sensor.acceleration.white = rng.log_uniform(0.003, 0.1) * scene.scales.acceleration.clamp(0.3, 5.0);
    if rng.chance(0.3) {
        scene.sensor.acceleration.colour = rng.uniform(0.2, 0.9);
    }
}

fn misstated(
    kind: &'static str,
    channel: &'static str,
    quantity: &'static str,
    stated: f64,
    is: f64,
    unit: &'static str,
) -> Misstated {
    Misstated { kind, channel, run: None, quantity, stated: Some(stated), is, unit, sigma: None, tolerated: &[] }
}

fn loop_and_clock(scene: &mut Scene, rng: &mut Stream) {
    if rng.chance(0.15) {
        controller_gain(scene, rng);
    }
    if rng.chance(0.05) {
        for run in &mut scene.runs {
            run.controller.late = 1;
        }
        let is = scene.runs[0].dt;
        let mut entry = misstated("controller delay", "", "late", 0.0, is, "s");
        entry.tolerated = &["command_delay", "displacement_lag"];
        scene.misstated.push(entry);
    }
    if rng.chance(0.1) {
        let off = rng.sign() * rng.log_uniform(1e-4, 5e-3);
        scene.says.clock = 1.0 + off;
        let stated = scene.runs[0].dt;
        for run in &mut scene.runs {
            run.dt *= 1.0 + off;
        }
        scene.misstated.push(misstated("clock", "time", "interval", stated, stated * (1.0 + off), "s"));
    }
    if rng.chance(0.1) {
        let scatter = rng.log_uniform(0.003, 0.15) * scene.runs[0].dt;
        scene.says.stamps.0 = scatter;
        scene.misstated.push(misstated("clock jitter", "time", "scatter", 0.0, scatter, "s"));
    }
    if rng.chance(0.08) {
        let places = 1 + rng.below(4);
        scene.says.stamps.1 = places;
        scene.says.rows_left_out = rng.chance(0.5);
        scene.misstated.push(misstated("lost rows", "time", "places", 0.0, places as f64, "1"));
    }
}

fn controller_gain(scene: &mut Scene, rng: &mut Stream) {
    let controller = scene.runs[0].controller;
    let factor = 1.0 + rng.sign() * rng.log_uniform(0.003, 0.08);
    let (which, name, is) = match controller.kind {
        Law::Pi { ki, .. } if ki > 0.0 && rng.chance(0.3) => (1, "ki", ki),
        Law::Pi { kp, .. } => (0, "kp", kp),
        Law::Cascade { kv, .. } if rng.chance(0.5) => (1, "kv", kv),
        Law::Cascade { kp, .. } => (0, "kp", kp),
    };
    let (which, name, is) =
        if controller.kvf != 0.0 && rng.chance(0.4) { (2, "kvf", controller.kvf) } else { (which, name, is) };
    let stated = rounded(is * factor, 5);
    scene.says.gains[which] = stated / is;
    scene.misstated.push(misstated("controller gain", "command", name, stated, is, "1"));
}

fn displacement_faults(scene: &mut Scene, rng: &mut Stream) {
    let size = scene.sensor.displacement.white;
    let duration = scene.scales.duration;
    let crossover = scene.scales.crossover;
    let mut found = Vec::new();
    let d = &mut scene.sensor.displacement;
    let mut say = |kind, quantity, is, unit, tolerated| {
        let mut entry = misstated(kind, "displacement", quantity, 0.0, is, unit);
        entry.tolerated = tolerated;
        found.push(entry);
    };
    if rng.chance(0.06) {
        d.lag = rng.log_uniform(0.002, 0.03) / crossover;
        say("sensor lag", "time", d.lag, "s", &["displacement_lag"]);
    }
    if rng.chance(0.08) {
        let drift = rng.log_uniform(0.5, 8.0) * size;
        d.drift = Some((drift, rng.log_uniform(0.2, 3.0) * duration));
        say("drift", "size", drift, "m", &[]);
    }
    if rng.chance(0.07) {
        let hum = (rng.log_uniform(0.3, 3.0) * size, mains(rng));
        d.hum = Some(hum);
        say("hum", "amplitude", hum.0, "m", &["mains_hum"]);
    }
    if rng.chance(0.06) {
        let spikes = (rng.log_uniform(10.0, 60.0) * size, rng.log_uniform(0.03, 0.5));
        d.spikes = Some(spikes);
        say("spikes", "size", spikes.0, "m", &[]);
    }
    if rng.chance(0.06) {
        let saw = (rng.log_uniform(0.5, 3.0) * size, rng.log_uniform(0.05, 3.0));
        d.saw = Some(saw);
        say("saw-tooth", "amplitude", saw.0, "m", &[]);
    }
    if rng.chance(0.1) {
        (d.growth, d.scale) = (rng.log_uniform(0.2, 3.0), scene.scales.velocity);
        say("noise grows with motion", "share", d.growth, "1", &[]);
    }
    if rng.chance(0.1) {
        d.colour = rng.uniform(0.3, 0.95);
        say("coloured noise", "correlation", d.colour, "1", &[]);
    }
    scene.misstated.extend(found);
}

fn accelerometer_faults(scene: &mut Scene, rng: &mut Stream) {
    let a = &mut scene.sensor.acceleration;
    let (size, duration) = (a.white, scene.scales.duration);
    let mut found = Vec::new();
    let mut say = |kind, quantity, is, unit, tolerated| {
        let mut entry = misstated(kind, "acceleration", quantity, 0.0, is, unit);
        entry.tolerated = tolerated;
        found.push(entry);
    };
    if rng.chance(0.06) {
        a.lag = rng.log_uniform(2e-4, 3e-3);
        say("sensor lag", "time", a.lag, "s", &["acceleration_lag"]);
    }
    if rng.chance(0.1) {
        let drift = rng.log_uniform(0.3, 5.0) * size;
        a.drift = Some((drift, rng.log_uniform(0.2, 3.0) * duration));
        say("drift", "size", drift, "m/s2", &["acceleration_bias"]);
    }
    if rng.chance(0.1) {
        let hum = (rng.log_uniform(0.2, 3.0) * size, mains(rng));
        a.hum = Some(hum);
        say("hum", "amplitude", hum.0, "m/s2", &["mains_hum"]);
    }
    if rng.chance(0.06) {
        let spikes = (rng.log_uniform(10.0, 60.0) * size, rng.log_uniform(0.03, 1.0));
        a.spikes = Some(spikes);
        say("spikes", "size", spikes.0, "m/s2", &[]);
    }
    if rng.chance(0.05) {
        a.range = rng.uniform(0.6, 0.98) * scene.scales.acceleration;
        say("clipped", "range", a.range, "m/s2", &[]);
    }
    if rng.chance(0.15) {
        a.step = rng.log_uniform(0.5, 4.0) * size;
        say("coarse counts", "count", a.step, "m/s2", &[]);
    }
    if rng.chance(0.1) {
        (a.growth, a.scale) = (rng.log_uniform(0.2, 3.0), scene.scales.acceleration);
        say("noise grows with motion", "share", a.growth, "1", &[]);
    }
    scene.misstated.extend(found);
}

fn mains(rng: &mut Stream) -> f64 {
    (if rng.chance(0.7) { 50.0 } else { 60.0 }) + rng.uniform(-0.05, 0.05)
}
