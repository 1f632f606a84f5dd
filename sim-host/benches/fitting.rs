//! Fitting 60 s at 1 kHz, and one tick of each online modifier: `cargo bench -p shakedown --bench fitting`.
//!
//! Fits are timed by the wall and by the processor: on a machine that does other work only the second says what a fit
//! costs. The least of several runs counts.

#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    reason = "a bench prints its figures and stops where it cannot"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use shakedown::blocks::motion::{convex, taut};
use shakedown::fit::generate::{self, NEAR_FIELD_STRONG};
use shakedown::fit::{Limits, Norm, Recipe, Reference, Step};
use shakedown_core::blocks::record::{self, causal, clip, preview};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// The strong near-field motion for 60 s at 1 kHz, 0.1 Hz high-passed.
fn reference() -> Option<Reference> {
    let recipe = generate::Recipe { duration: 60.0, rate: 1000.0, ..NEAR_FIELD_STRONG };
    let record = recipe.generate(1).ok()?;
    let high_pass = Recipe { steps: vec![Step::HighPassMotion { corner_hz: 0.1, order: 2 }] };
    let motion = high_pass.apply(&record).ok()?;
    Reference::new(motion.dt, motion.velocity, 0.0).ok()
}

/// Processor time of this process so far.
#[cfg(unix)]
fn processor() -> Option<Duration> {
    let now = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Some(Duration::new(now.tv_sec.try_into().ok()?, now.tv_nsec.try_into().ok()?))
}

#[cfg(not(unix))]
fn processor() -> Option<Duration> {
    None
}

/// Prints the least wall time and the least processor time of `runs` of `work`, ms.
fn timed<T>(name: &str, runs: usize, mut work: impl FnMut() -> T) {
    let (mut wall, mut cpu) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..runs {
        let (begin, before) = (Instant::now(), processor());
        black_box(work());
        wall = wall.min(begin.elapsed().as_secs_f64());
        if let (Some(before), Some(after)) = (before, processor()) {
            cpu = cpu.min(after.saturating_sub(before).as_secs_f64());
        }
    }
    println!("{name:32} {:10.2} ms {:10.2} ms", 1e3 * wall, 1e3 * cpu);
}

fn offline(_: &mut Criterion) {
    let Some(reference) = reference() else { return };
    println!("{:32} {:>13} {:>13}", "fit 60 s at 1 kHz", "wall", "processor");
    let string = Limits::velocity(0.242);
    timed("taut string", 50, || taut::fit(black_box(&reference), &string));
    let ending = Limits { end: Some(0.0), ..string };
    timed("taut string, end given", 20, || taut::fit(black_box(&reference), &ending));
    let table = Limits::table(0.242, 0.12);
    timed("convex, velocity and stroke", 5, || convex::fit(black_box(&reference), &table, Norm::Two));
}

fn online(c: &mut Criterion) {
    let Some(reference) = reference() else { return };
    let x: Vec<f32> = reference.displacement(&reference.velocity).iter().map(|&x| x as f32).collect();
    let limits = record::ReferenceLimits::new(1000.0, 0.242, 0.12);
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
    if let Ok(config) = causal::Config::new(&limits, &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY) {
        group.bench_function("causal", |b| {
            b.iter(|| {
                let mut state = causal::State::at(0.0);
                x.iter().map(|&x| causal::step(&config, &mut state, x, 0.242)).sum::<f32>()
            });
        });
    }
    if let Ok(config) = preview::Config::new::<512>(&limits, &preview::Config::DRIFT_RECOVERY, 0.5) {
        group.bench_function("preview of 0.5 s", |b| {
            b.iter(|| {
                let mut state = preview::State::<512, { preview::places(512) }>::at(0.0);
                x.iter().map(|&x| preview::step(&config, &mut state, x, 0.242)).sum::<f32>()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, offline, online);
criterion_main!(benches);
