//! Fitting 60 s at 1 kHz, and one tick of each online modifier: `cargo bench -p shakedown --bench fitting`.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a bench prints its figures and stops where it cannot"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shakedown::motion::condition::{Recipe, Step};
use shakedown::motion::fit::{Limits, Norm, Reference, convex, taut};
use shakedown::motion::generate::{self, NEAR_FIELD_STRONG};
use shakedown_core::record::{self, causal, clip, preview};
use std::hint::black_box;

/// The strong near-field motion for 60 s at 1 kHz, 0.1 Hz high-passed.
fn reference() -> Option<Reference> {
    let recipe = generate::Recipe { duration: 60.0, rate: 1000.0, ..NEAR_FIELD_STRONG };
    let record = recipe.generate(1).ok()?;
    let high_pass = Recipe { steps: vec![Step::HighPassMotion { corner_hz: 0.1, order: 2 }] };
    let motion = high_pass.apply(&record).ok()?;
    Reference::new(motion.dt, motion.velocity, 0.0).ok()
}

fn offline(c: &mut Criterion) {
    let Some(reference) = reference() else { return };
    let mut group = c.benchmark_group("fit 60 s at 1 kHz");
    let string = Limits::velocity(0.242);
    group.bench_function("taut string", |b| b.iter(|| taut::fit(black_box(&reference), &string)));
    let ending = Limits { end: Some(0.0), ..string };
    group.bench_function("taut string, end given", |b| b.iter(|| taut::fit(black_box(&reference), &ending)));
    group.sample_size(10);
    let table = Limits::table(0.242, 0.12);
    group.bench_function("convex, velocity and stroke", |b| {
        b.iter(|| convex::fit(black_box(&reference), &table, Norm::Two));
    });
    group.finish();
}

fn online(c: &mut Criterion) {
    let Some(reference) = reference() else { return };
    let x: Vec<f32> = reference.displacement(&reference.velocity).iter().map(|&x| x as f32).collect();
    let limits = record::Limits::new(1000.0, 0.242, 0.12);
    let mut group = c.benchmark_group("60,000 ticks of");
    group.throughput(Throughput::Elements(x.len() as u64));
    if let Ok(config) = clip::Config::new(&limits) {
        group.bench_function("clip", |b| {
            b.iter(|| {
                let mut state = clip::State::at(0.0);
                x.iter().map(|&x| clip::step(&config, &mut state, x, 0.242)).sum::<f32>()
            });
        });
    }
    if let Ok(config) = causal::Config::new(&limits, &causal::Config::WASHOUT, causal::Config::MEMORY) {
        group.bench_function("causal", |b| {
            b.iter(|| {
                let mut state = causal::State::at(0.0);
                x.iter().map(|&x| causal::step(&config, &mut state, x, 0.242)).sum::<f32>()
            });
        });
    }
    if let Ok(config) = preview::Config::new::<512>(&limits, &preview::Config::WASHOUT, 0.5) {
        group.bench_function("preview of 0.5 s", |b| {
            b.iter(|| {
                let mut state = preview::State::<512>::at(0.0);
                x.iter().map(|&x| preview::step(&config, &mut state, x, 0.242)).sum::<f32>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, offline, online);
criterion_main!(benches);
