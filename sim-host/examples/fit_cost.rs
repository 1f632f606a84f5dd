//! What an evaluation costs: processor time of a simulation with values alone and with every sensitivity, for the stated
//! model and with each effect of the library beside it, and the evaluations its fit takes.
//! `cargo run --release -p shakedown --example fit_cost EXPERIMENT.toml [EFFECT+EFFECT ...]`; concealed cases to try it on
//! are written by `cargo run --release -p shakedown-truth -- DIR`.

#![allow(
    clippy::print_stdout,
    clippy::expect_used,
    clippy::unwrap_used,
    reason = "an example prints and stops where it cannot"
)]

use shakedown::blocks::identify::{Effort, Fit, Local, Model, ModelEffect, Run, predict, prepare, score};
use shakedown::blocks::plant::entry;
use shakedown::recording::Experiment;
use std::path::Path;
use std::time::Instant;

/// Microseconds a sample that `work` takes on one thread, the best of three.
fn cost(runs: &[Run], mut work: impl FnMut()) -> f64 {
    let samples: usize = runs.iter().map(Run::len).sum();
    let once = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64() * 1e6 / samples as f64
    };
    (0..3).map(once).fold(f64::INFINITY, f64::min)
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().expect("an experiment");
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool before");
    let prepared = prepare(&Experiment::load(Path::new(&path)).expect("an experiment")).expect("it can be fitted");
    let runs = &prepared.fit;
    let mut sets: Vec<String> = arguments.collect();
    if sets.is_empty() {
        sets = prepared.model.candidates().iter().map(|e| e.id.to_owned()).collect();
        sets.insert(0, String::new());
    }
    println!(
        "{:40} {:>5} {:>12} {:>12} {:>6} {:>12} {:>10}",
        "effects", "free", "values [us]", "all [us]", "evals", "chi2", "held out"
    );
    for set in sets {
        let grown = |model: Model, id: &str| {
            model.with(ModelEffect::start(entry(id).expect("an effect"), 0, &prepared.signal_scales).expect("a start"))
        };
        let model = set.split('+').filter(|id| !id.is_empty()).fold(prepared.model.clone(), grown);
        let locals: Vec<Local> = runs.iter().map(|run| Local::start(&model, run)).collect();
        let free = model.values().chain(locals[0].values()).filter(|v| v.free).count();
        let values = cost(runs, || {
            for (run, local) in runs.iter().zip(&locals) {
                std::hint::black_box(predict(&model, run, local).expect("it runs"));
            }
        });
        let all = cost(runs, || drop(std::hint::black_box(Fit::begin(model.clone(), runs))));
        let mut fit = Fit::begin(model, runs).expect("it runs");
        fit.improve(runs, Effort::FULL).expect("it runs");
        let held_back = score(&fit.model, &prepared.holdout).expect("it runs").chi2;
        println!(
            "{set:40} {free:5} {values:12.3} {all:12.3} {:6} {:12.4} {held_back:10.4}",
            fit.evaluations,
            fit.chi2()
        );
    }
}
