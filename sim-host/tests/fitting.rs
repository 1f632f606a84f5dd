//! Real records fitted to the paper's table: 0.242 m/s and 0.12 m. Prints the figures it asserts:
//! `cargo test -p shakedown --test fitting -- --nocapture --test-threads 1`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

#[path = "support/skipped.rs"]
mod skipped;

use shakedown::blocks::motion::certificate::{self, Relaxed};
use shakedown::blocks::motion::online::{self, Modifier};
use shakedown::blocks::motion::{Band, convex, spectrum, taut};
use shakedown::fit::{
    Limits, Method, Motion, Norm, Recipe, Reference, generate, modify, peak, peak_acceleration, read,
};
use shakedown::simulate::{Named, Setup};
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

const VELOCITY: f64 = 0.242;
const STROKE: f64 = 0.12;

/// Record, peak it is scaled to, the best `E_a` that is known for it with velocity and stroke limited.
const RECORDS: [(&str, &str, Option<&str>, f64); 5] = [
    ("Kobe 0.74 g", "RSN1106_KOBE_KJM000.AT2", Some("0.74g"), 0.397),
    ("Kobe", "RSN1106_KOBE_KJM000.AT2", None, 0.441),
    ("Rinaldi", "Rinaldi228.AT2", None, 0.562),
    ("El Centro", "IELC180.AT2", None, 0.027),
    ("Taft", "RSN15_KERN_TAF021.AT2", None, 0.0),
];

/// A record of the development data prepared as the figures are stated for, or nothing and a line that says so.
fn prepared(file: &str, scale: Option<&str>) -> Option<Motion> {
    let folder = std::env::var_os("SHAKEDOWN_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    let path = folder.join("records").join(file);
    if !path.exists() {
        skipped::without(&path);
        return None;
    }
    let record = read::record(&path, &read::Options::default()).unwrap();
    Some(Recipe::fitting(scale.map(|s| peak_acceleration(s).unwrap())).apply(&record).unwrap())
}

fn reference(motion: &Motion) -> Reference {
    Reference::new(motion.dt, motion.velocity.clone(), 0.0).unwrap()
}

fn largest_error(reference: &Reference, velocity: &[f64]) -> f64 {
    let errors = reference.velocity.windows(2).zip(velocity.windows(2));
    errors.map(|(r, v)| ((r[1] - r[0]) - (v[1] - v[0])).abs() / reference.dt).fold(0.0, f64::max)
}

#[test]
fn offline_fits_reach_the_best_possible() {
    println!("{:12} {:>8} {:>8} {:>8} {:>8}", "record", "clip", "taut", "convex", "bound");
    for (name, file, scale, best) in RECORDS {
        let Some(motion) = prepared(file, scale) else { return };
        let reference = reference(&motion);
        let velocity_only = Limits { end: Some(0.0), ..Limits::velocity(VELOCITY) };
        let clip = online::fit(&reference, &Limits::table(VELOCITY, STROKE), Modifier::Clip).unwrap();
        let string = taut::fit(&reference, &velocity_only).unwrap();
        let alone = convex::fit(&reference, &velocity_only, Norm::Two).unwrap();
        let both = convex::fit(&reference, &Limits::table(VELOCITY, STROKE), Norm::Two).unwrap();
        let error = |velocity: &[f64]| reference.acceleration_error(velocity);
        let (clip, taut, alone) = (error(&clip.velocity), error(&string.velocity), error(&alone.velocity));
        let (fitted, bound) = (error(&both.velocity), both.bound.unwrap());
        println!("{name:12} {clip:8.4} {taut:8.4} {fitted:8.4} {bound:8.4}");
        assert!(taut <= alone * 1.001 + 1e-5, "{name}: taut {taut} against {alone}");
        assert!(fitted <= best * 1.01 + 2e-3, "{name}: {fitted} against {best}");
        assert!(fitted <= bound * 1.001 + 1e-4, "{name}: {fitted}, proven {bound}");
        let x = reference.displacement(&both.velocity);
        assert!(peak(&x) <= STROKE * (1.0 + 1e-5) && x[x.len() - 1].abs() < 1e-6, "{name}");
        assert!(peak(&both.velocity) <= VELOCITY && both.velocity[x.len() - 1].abs() < 1e-9, "{name}");
    }
}

#[test]
fn online_modifiers_keep_their_promises_on_records() {
    println!(
        "{:12} {:>7} {:>7} {:>7} {:>7} {:>9} {:>9}",
        "record", "clip", "causal", "0.1 s", "0.5 s", "peak err", "end mm"
    );
    let limits = Limits::table(VELOCITY, STROKE);
    for (name, file, scale, _) in RECORDS {
        let Some(motion) = prepared(file, scale) else { return };
        let reference = reference(&motion);
        let run = |modifier| online::fit(&reference, &limits, modifier).unwrap().velocity;
        let (clip, causal) = (run(Modifier::Clip), run(Modifier::Causal));
        let (short, long) = (run(Modifier::Preview(0.1)), run(Modifier::Preview(0.5)));
        let error = |velocity: &[f64]| reference.acceleration_error(velocity);
        // The modifiers take backward differences, so their displacement is the plain sum.
        let end = |velocity: &[f64]| velocity.iter().sum::<f64>() * motion.dt;
        let apart = 1e3 * (end(&causal) - end(&reference.velocity));
        let (worst, clipped) = (largest_error(&reference, &causal), largest_error(&reference, &clip));
        let (e_clip, e_causal, e_long) = (error(&clip), error(&causal), error(&long));
        println!(
            "{name:12} {e_clip:7.4} {e_causal:7.4} {:7.4} {e_long:7.4} {:9.3} {apart:9.5}",
            error(&short),
            worst / clipped.max(1e-9)
        );
        // What single precision makes of a displacement: one place in 0.1 m, twice differenced.
        let noise = 4.0 * 7.5e-9 / motion.dt.powi(2);
        let share = if name.starts_with("Kobe") || name == "El Centro" { 0.95 } else { 1.0 };
        assert!(e_causal <= share * e_clip + 1e-4, "{name}: {e_causal} against {e_clip}");
        assert!(worst <= clipped + noise, "{name}: {worst} against {clipped}");
        assert!(apart.abs() < 1.0, "{name}: {apart} mm");
        if name == "Kobe 0.74 g" {
            assert!(e_long <= 0.42, "{e_long}");
        }
    }
}

#[test]
fn the_spectrum_of_kobe_is_kept() {
    let Some(motion) = prepared("RSN1106_KOBE_KJM000.AT2", Some("0.74g")) else { return };
    let band = Band { shortest: 0.05, longest: 0.5, damping: 0.05, tolerance: 0.05 };
    let limits = Limits::table(VELOCITY, STROKE);
    let found = modify(&motion, &limits, Method::Spectrum(band), |line| eprintln!("{line}")).unwrap();
    let (x, v, _) = found.motion.peaks();
    assert!(v <= VELOCITY * (1.0 + 1e-4) && x <= STROKE * (1.0 + 1e-4), "{v} m/s, {x} m");
    assert!(found.motion.displacement[found.motion.len() - 1].abs() < 1e-4);
    // Judged by the independent spectrum, at periods the fit was not told.
    let periods = spectrum::periods(0.05, 0.5, 101);
    let of = |m: &Motion| spectrum::response_spectrum(&m.acceleration, m.dt, 0.05, &periods).unwrap().s_a;
    let (asked, got) = (of(&motion), of(&found.motion));
    let worst = asked.iter().zip(&got).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max);
    println!("Kobe 0.74 g, S_a (5 %) over 0.05 to 0.5 s: within {:.2} % at {v:.4} m/s and {x:.4} m", 100.0 * worst);
    assert!(worst <= 0.05, "{worst}");
}

#[test]
fn what_is_written_keeps_the_limits_when_it_is_read() {
    let Some(motion) = prepared("RSN1106_KOBE_KJM000.AT2", Some("0.74g")) else { return };
    let limits = Limits::table(VELOCITY, STROKE);
    for method in [Method::Clip, Method::Taut, Method::Convex(Norm::Two), Method::Causal, Method::Preview(0.5)] {
        let found = modify(&motion, &limits, method, |_| {}).unwrap();
        let read = Motion::from_acceleration(motion.dt, found.motion.acceleration.clone());
        assert!(peak(&read.velocity) <= VELOCITY * 1.0001, "{method:?}: {}", peak(&read.velocity));
        if !matches!(method, Method::Clip | Method::Taut) {
            assert!(peak(&read.displacement) <= STROKE * 1.0001, "{method:?}: {}", peak(&read.displacement));
        }
        let end = read.displacement[read.len() - 1];
        println!("{method:?}: ends {:.4} mm off", 1e3 * end);
        assert!(end.abs() < 1e-3 || method == Method::Clip, "{method:?}: {end}");
    }
}

#[test]
fn a_missed_target_says_what_it_takes() {
    let Some(motion) = prepared("RSN1106_KOBE_KJM000.AT2", Some("0.74g")) else { return };
    let reference = reference(&motion);
    let limits = Limits { end: Some(0.0), ..Limits::velocity(VELOCITY) };
    let found = certificate::relaxation(&reference, &limits, Relaxed::Velocity, 0.2).unwrap().unwrap();
    println!(
        "E_a 0.2 on Kobe 0.74 g takes {:.3} times the velocity; {:.3} times is not enough",
        found.met_at, found.missed_at
    );
    assert!(found.error <= 0.2 && found.bound > 0.2);
    assert!(found.met_at / found.missed_at < 1.005);
    assert!(certificate::relaxation(&reference, &limits, Relaxed::Velocity, 0.5).unwrap().is_none());
}

/// The causal modifier on motions that nobody has chosen its constants for.
#[test]
fn the_causal_modifier_beats_clipping_on_generated_records() {
    let limits = Limits::table(VELOCITY, STROKE);
    let (mut compared, mut left) = (0, 0);
    for recipe in generate::RECIPES {
        for seed in 1..=8 {
            let motion = Recipe::fitting(None).apply(&recipe.generate(seed).unwrap()).unwrap();
            let reference = reference(&motion);
            let run = |modifier| online::fit(&reference, &limits, modifier).unwrap().velocity;
            let (clip, causal) = (run(Modifier::Clip), run(Modifier::Causal));
            let sum = |velocity: &[f64]| velocity.iter().sum::<f64>() * motion.dt;
            let apart = sum(&causal) - sum(&reference.velocity);
            assert!(apart.abs() < 1e-3, "{} {seed}: {apart} m", recipe.name);
            // Where clipping itself runs out of the stroke it is no motion of this table, and no measure.
            if peak(&reference.displacement(&clip)) > STROKE {
                left += 1;
                continue;
            }
            let (e_clip, e_causal) = (reference.acceleration_error(&clip), reference.acceleration_error(&causal));
            assert!(e_causal <= e_clip + 1e-4, "{} {seed}: {e_causal} against {e_clip}", recipe.name);
            let noise = 4.0 * 7.5e-9 / motion.dt.powi(2);
            let (worst, clipped) = (largest_error(&reference, &causal), largest_error(&reference, &clip));
            assert!(worst <= clipped + noise, "{} {seed}: {worst} against {clipped}", recipe.name);
            compared += 1;
        }
    }
    println!(
        "causal: E_a and peak error at most clip's on {compared} generated records; clip leaves the stroke on {left} more"
    );
    assert!(compared >= 8);
}

const METHODS: [(&str, Method); 5] = [
    ("clip", Method::Clip),
    ("taut", Method::Taut),
    ("convex", Method::Convex(Norm::Two)),
    ("causal", Method::Causal),
    ("preview", Method::Preview(0.5)),
];

/// Strong PI on the paper's plant follows a fitted record without the spikes that saturation brings.
#[test]
fn fitted_records_leave_no_spike_in_the_closed_loop() {
    let limits = Limits::table(VELOCITY, STROKE);
    println!("{:22} {:14} {:>8} {:>8} {:>9}", "record", "given", "peak g", "spike", "saturated");
    let mut given: Vec<(String, Motion)> = Vec::new();
    for (name, file, scale, _) in RECORDS {
        let Some(motion) = prepared(file, scale) else { return };
        given.push((name.into(), motion));
    }
    for recipe in generate::RECIPES {
        for seed in 1..=2 {
            let motion = Recipe::fitting(None).apply(&recipe.generate(seed).unwrap()).unwrap();
            given.push((format!("{} {seed}", recipe.name), motion));
        }
    }
    for (name, motion) in given {
        let setup = Setup::paper(Named::Strong);
        let asked = peak(&motion.acceleration);
        let spike = |label: &str, given: &Motion| {
            let trace = setup.play(given).unwrap().trace;
            let found = peak(&trace.acceleration);
            println!(
                "{name:22} {label:14} {:8.3} {:8.3} {:7.2} s",
                found / 9.80665,
                found / asked,
                trace.saturated_s()
            );
            found / asked
        };
        spike("as it is", &motion);
        for (label, method) in METHODS {
            let given = modify(&motion, &limits, method, |_| {}).unwrap().motion;
            let ratio = spike(label, &given);
            assert!(ratio <= 1.05 || label == "clip", "{name} {label}: {ratio}");
        }
    }
}

/// The same problem by an independent road: SciPy's NNLS. Skipped, with a line that says so, where there is no SciPy.
#[test]
fn an_independent_solver_agrees() {
    let (dt, limit, stroke) = (0.05, 0.242, 0.05);
    let velocity: Vec<f64> = (0..240)
        .map(|k| {
            let t = dt * f64::from(k);
            let slow = 0.6 * (4.4 * t).sin() * (-((t - 5.0) / 2.5).powi(2)).exp();
            slow + 0.25 * (14.5 * t).sin() * (-((t - 4.0) / 3.0).powi(2)).exp()
        })
        .collect();
    let task = serde_json::json!({"dt": dt, "velocity": velocity, "limit": limit, "stroke": stroke}).to_string();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/independent_fit.py");
    let child =
        Command::new("python3").arg(script).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let Ok(mut child) = child else {
        skipped::skipped("no python3");
        return;
    };
    child.stdin.take().unwrap().write_all(task.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains("ModuleNotFoundError"), "{message}");
        skipped::skipped("python3 has no SciPy");
        return;
    }
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let theirs = answer["e_a"].as_f64().unwrap();
    let reference = Reference::new(dt, velocity, 0.0).unwrap();
    let fitted = convex::fit(&reference, &Limits::table(limit, stroke), Norm::Two).unwrap();
    let ours = reference.acceleration_error(&fitted.velocity);
    println!("independent solver: E_a {theirs:.6}, ours {ours:.6}, proven {:.6}", fitted.bound.unwrap());
    assert!((ours / theirs - 1.0).abs() < 0.01, "{ours} against {theirs}");
    assert!(fitted.bound.unwrap() <= theirs * 1.000_01);
}
