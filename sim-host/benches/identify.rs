//! A servo model fitted to 4 runs of 60 s at 1 kHz: six parameters and where each run starts; beside it SciPy's
//! `least_squares` over the same simulation compiled by numba (`identify.py`), on the same cores and data.
//!
//! `cargo bench -p shakedown --bench identify`

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a bench prints its figures and stops where it cannot"
)]

use criterion::Criterion;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use shakedown::blocks::identify::{
    Channel, Effort, Fit, Local, Measured, Model, ModelEffect, Run, SignalScales, Value, predict,
};
use shakedown::blocks::plant::{Kind, SimulatedLaw, entry};
use std::error::Error;
use std::process::Command;
use std::time::Instant;

const DT: f64 = 1e-3;
const SECONDS: f64 = 60.0;
const RUNS: usize = 4;
/// `b1`, `b0`, `a1`, `velocity_limit`, the bias of the command and that of the accelerometer.
const TRUTH: [f64; 6] = [0.69, 138.0, 57.65, 0.242, 1e-3, 0.02];
const START: [f64; 6] = [0.62, 155.0, 52.0, 0.26, 0.0, 0.0];
const GAINS: (f64, f64) = (8.0, 1.0);
const NOISE: [f64; 2] = [2e-5, 0.2];

fn model(values: [f64; 6]) -> Model {
    let own = values.iter().zip(Kind::Servo.parameters()).map(|(&value, own)| Value {
        value,
        low: if own.positive { 0.1 * value } else { f64::NEG_INFINITY },
        high: if own.positive { 10.0 * value } else { f64::INFINITY },
        positive: own.positive,
        free: true,
        prior: None,
    });
    let model = Model::bare(Kind::Servo, own.collect());
    let placed = |id: &str, value: f64| {
        let mut placed = ModelEffect::start(entry(id).expect("listed"), 0, &SignalScales::TYPICAL).expect("a start");
        placed.values[0].value = value;
        placed
    };
    model.with(placed("null_bias", values[4])).with(placed("acceleration_bias", values[5]))
}

fn gauss(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| f64::from(random.next_u32()) / f64::from(u32::MAX)).sum::<f64>() - 6.0
}

fn recorded(number: usize) -> Run {
    let n = (SECONDS / DT) as usize;
    let tone = |k: usize, i: i32| {
        let hz = 0.2 * 1.6_f64.powi(i);
        0.05 / f64::from(i + 1) * (std::f64::consts::TAU * hz * k as f64 * DT + f64::from(i) * number as f64).sin()
    };
    let input: Vec<f64> = (0..n).map(|k| (k as f64 * DT).min(1.0) * (0..8).map(|i| tone(k, i)).sum::<f64>()).collect();
    let channel = |channel, noise| Measured { channel, values: vec![0.0; n], noise, stated: Some(noise), judged: true };
    let mut run = Run {
        name: format!("run {number}"),
        dt: DT,
        elapsed: 0.0,
        from: 0.0,
        ticks: 1,
        input,
        added: Vec::new(),
        law: SimulatedLaw::Pi { kp: GAINS.0, ki: GAINS.1 },
        shaping: shakedown::blocks::plant::Shaping::default(),
        loop_noise: None,
        sent_before: Vec::new(),
        moving_start: false,
        measured: vec![channel(Channel::Displacement, NOISE[0]), channel(Channel::Acceleration, NOISE[1])],
        motion: None,
        filter: None,
    };
    let model = model(TRUTH);
    let predicted = predict(&model, &run, &Local::start(&model, &run)).expect("the truth runs");
    let mut random = ChaCha8Rng::seed_from_u64(number as u64);
    for (measured, clean) in run.measured.iter_mut().zip(predicted.channels) {
        measured.values = clean.iter().map(|v| v + measured.noise * gauss(&mut random)).collect();
    }
    run
}

fn fitted(runs: &[Run]) -> Fit {
    let mut fit = Fit::begin(model(START), runs).expect("the model runs");
    fit.improve(runs, Effort::FULL).expect("the model runs");
    fit
}

/// SciPy's answer on the same data: its best seconds, its sum of squares, its parameters.
fn scipy(runs: &[Run]) -> Result<Option<(f64, f64, Vec<f64>)>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("runs.bin");
    let mut bytes = Vec::new();
    for run in runs {
        for series in [&run.input, &run.measured[0].values, &run.measured[1].values] {
            bytes.extend(series.iter().flat_map(|x| x.to_le_bytes()));
        }
    }
    std::fs::write(&path, bytes)?;
    let numbers = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/identify.py");
    let told = Command::new("python3").arg(script).arg(&path).args([RUNS.to_string(), numbers(&START)]).output();
    let Ok(output) = told else { return Ok(None) };
    if !output.status.success() {
        println!("{}", String::from_utf8_lossy(&output.stderr));
        return Ok(None);
    }
    let text = String::from_utf8(output.stdout)?;
    let fields: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    match fields.as_slice() {
        [seconds, squares, rest @ ..] => Ok(Some((*seconds, *squares, rest.to_vec()))),
        _ => Err(format!("unexpected output: {text}").into()),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let runs: Vec<Run> = (1..=RUNS).map(recorded).collect();
    let mut criterion = Criterion::default().configure_from_args().sample_size(10);
    criterion.bench_function("servo, 4 x 60 s at 1 kHz, 6 parameters", |b| b.iter(|| fitted(&runs)));
    criterion.final_summary();
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        std::hint::black_box(fitted(&runs));
        best = best.min(start.elapsed().as_secs_f64());
    }
    let fit = fitted(&runs);
    println!("fit: {best:.3} s (under 2), {} evaluations, chi2 {:.5}", fit.evaluations, fit.chi2());
    for (name, value) in fit.model.names().iter().zip(fit.model.values()) {
        println!("  {name:20} {:.6}", value.value);
    }
    let Some((seconds, squares, values)) = scipy(&runs)? else {
        println!("SciPy: left out, python3 with scipy and numba is not at hand");
        return Ok(());
    };
    println!("SciPy with numba: {seconds:.3} s, chi2 {:.5}, {values:?}", squares / fit.rows as f64);
    println!("ratio {:.1} (at least 5)", seconds / best);
    // Both found the same minimum, else the comparison says nothing.
    if (squares / fit.squares - 1.0).abs() > 1e-3 {
        return Err(format!("the two differ: {} and {squares} squares", fit.squares).into());
    }
    Ok(())
}
