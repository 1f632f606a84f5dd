//! Closed-loop simulation: 60 s at 1 kHz control with 10 plant steps a tick, around the control core and around the
//! plain PI law; and the latter against the same arithmetic in plain C (`closed_loop.c`, compiled here with `cc -O3`).
//!
//! `cargo bench -p shakedown --bench closed_loop`

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a bench prints its figures and stops where it cannot"
)]

use criterion::Criterion;
use shakedown::blocks::plant::paper::{FixedStep, Paper};
use shakedown::blocks::plant::sensors::{SensorModel, Sensors};
use shakedown::simulate::{Clock, ControlLaw, Named, PlainPi, Trace, run};
use shakedown_core::Controller;
use std::error::Error;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

const SECONDS: f64 = 60.0;
const RATE: f64 = 1000.0;
const STEPS: usize = 10;

/// 75 mm at 2 Hz with a slow swing below it: both limits, their edges, and stretches between them.
fn reference() -> Vec<f64> {
    let value = |t: f64| 0.075 * (TAU * 2.0 * t).sin() * (TAU * 0.05 * t).sin();
    (0..(SECONDS * RATE) as usize).map(|k| value(k as f64 / RATE)).collect()
}

fn simulate(law: &mut impl ControlLaw, reference: &[f64]) -> Result<Trace, Box<dyn Error>> {
    let clock = Clock::new(RATE, STEPS)?;
    let mut plant = FixedStep::new(Paper::default(), clock.plant_step(), 0.0)?;
    Ok(run(&mut plant, law, &mut Sensors::new(SensorModel::default()), reference, clock))
}

fn plain() -> PlainPi {
    PlainPi::new(3.70205, 0.61701, RATE)
}

/// Best seconds of `n` runs.
fn best(n: usize, mut run: impl FnMut() -> Result<Trace, Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let mut best = f64::INFINITY;
    for _ in 0..n {
        let start = Instant::now();
        drop(black_box(run()?));
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(best)
}

/// Rust and C by turns, so that both meet the same machine.
fn against_c(reference: &[f64]) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let program = folder.path().join("closed_loop");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/closed_loop.c");
    // The baseline instruction set on both sides, and no fused operation that Rust would not make.
    let flags = ["-O3", "-std=c11", "-D_POSIX_C_SOURCE=199309L", "-ffp-contract=off", source, "-lm", "-o"];
    let built = Command::new("cc").args(flags).arg(&program).status();
    if !built.is_ok_and(|status| status.success()) {
        println!("plain C: left out, `cc` did not build {source}");
        return Ok(());
    }
    let (mut rust, mut c) = (f64::INFINITY, f64::INFINITY);
    let last = simulate(&mut plain(), reference)?.displacement.last().copied().unwrap_or(f64::NAN);
    for _ in 0..10 {
        rust = rust.min(best(10, || simulate(&mut plain(), reference))?);
        let text = String::from_utf8(Command::new(&program).arg("10").output()?.stdout)?;
        let mut fields = text.split_whitespace().map(str::parse::<f64>);
        let (Some(Ok(seconds)), Some(Ok(final_x))) = (fields.next(), fields.next()) else {
            return Err(format!("unexpected output of the C program: {text:?}").into());
        };
        // Bit for bit where libm agrees; its exponentials may differ in their last digit.
        if (final_x - last).abs() > 1e-12 {
            return Err(format!("the two ran different arithmetic: {final_x} m in C, {last} m in Rust").into());
        }
        c = c.min(seconds);
    }
    println!(
        "plain PI: Rust {:.2} ms, C {:.2} ms, ratio {:.3} (at most 1.2); final displacements differ by less than 1e-12 m",
        rust * 1e3,
        c * 1e3,
        rust / c
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let reference = reference();
    let core = || -> Result<Trace, Box<dyn Error>> {
        let mut controller = Controller::new(&Named::Current.settings(RATE))?;
        simulate(&mut controller, &reference)
    };
    let mut criterion = Criterion::default().configure_from_args();
    criterion.bench_function("60 s, control core", |b| b.iter(core));
    criterion.bench_function("60 s, plain PI", |b| b.iter(|| simulate(&mut plain(), &reference)));
    criterion.final_summary();
    let seconds = best(50, core)?;
    println!("control core: {:.2} ms, {:.0} times real time (at least 5,000)", seconds * 1e3, SECONDS / seconds);
    let seconds = best(50, || simulate(&mut plain(), &reference))?;
    println!("plain PI: {:.2} ms, {:.0} times real time", seconds * 1e3, SECONDS / seconds);
    against_c(&reference)
}
