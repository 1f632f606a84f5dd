//! The record modifiers, through everything that a reference and a limit in force can do.

use crate::tape::{Noise, Tape, hold, run};
use shakedown_core::blocks::record::{DriftRecovery, ReferenceLimits, causal, clip, preview};

const RATE: f32 = 1000.0;

/// A reference of swings, runs to and beyond the stroke, leaps, gaps and stands; and the limit in force beside it, m/s.
fn course(seed: u32, ticks: u32) -> impl Iterator<Item = (f32, f32)> {
    let mut noise = Noise::new(seed);
    let (mut x, mut slope, mut limit, mut lost) = (0.0_f32, 0.0_f32, 0.242_f32, 0_u32);
    (0..ticks).map(move |k| {
        if k % 60 == 0 {
            let any = noise.next();
            slope = noise.of(&[0.0, 0.242, -0.242, 1.5 * any, any, -8.0 * x]);
            x += noise.of(&[0.0, 0.0, 0.0, 0.0, 0.05 * any, 0.005]);
            lost = noise.of(&[0, 0, 0, 1, 7]);
        }
        if k % 350 == 0 {
            limit = noise.of(&[0.242, 0.242, 0.121, 0.2, 0.0, f32::NAN, -1.0, 9.0]);
        }
        x += (slope + 0.3 * libm::sinf(k as f32 * 0.03)) / RATE;
        lost = lost.saturating_sub(1);
        (if lost > 0 { noise.of(&[f32::NAN, f32::INFINITY, f32::MIN]) } else { x }, limit)
    })
}

/// Where the run stops listening for a while, and goes on.
fn gap(k: usize) -> bool {
    k % 900 == 850
}

fn clipped(limits: &ReferenceLimits) -> impl FnOnce(&mut Tape) {
    let config = clip::Config::new(limits).unwrap();
    move |tape| {
        let mut state = clip::State::at(0.002);
        for (k, (x, limit)) in course(71, 6000).enumerate() {
            if gap(k) {
                state.resume(x);
            }
            tape.note(clip::step(&config, &mut state, x, limit));
            tape.count(u32::from(state.held()) | u32::from(state.limited()) << 1);
        }
    }
}

fn caused(limits: &ReferenceLimits, washout: DriftRecovery, memory: f32) -> impl FnOnce(&mut Tape) {
    let config = causal::Config::new(limits, &washout, memory).unwrap();
    move |tape| {
        let mut state = causal::State::at(-0.003);
        for (k, (x, limit)) in course(73, 9000).enumerate() {
            if gap(k) {
                state.resume(x);
            }
            tape.note(causal::step(&config, &mut state, x, limit));
            tape.count(u32::from(state.held()) | u32::from(state.limited()) << 1);
        }
    }
}

fn foreseen<const N: usize, const PLACES: usize>(limits: &ReferenceLimits, seconds: f32) -> impl FnOnce(&mut Tape) {
    let config = preview::Config::new::<N>(limits, &preview::Config::DRIFT_RECOVERY, seconds).unwrap();
    move |tape| {
        let mut state = preview::State::<N, PLACES>::at(0.001);
        tape.count(config.delay());
        for (k, (x, limit)) in course(79, 9000).enumerate() {
            if gap(k) {
                state.resume(x);
            }
            if k == 7000 {
                state.restart(x);
            }
            tape.note(preview::step(&config, &mut state, x, limit));
            tape.count(u32::from(state.held()) | u32::from(state.limited()) << 1);
        }
    }
}

#[test]
fn modifiers() {
    let limits = ReferenceLimits::new(RATE, 0.242, 0.12);
    let tight = ReferenceLimits { braking: 0.4, leap: 2.0, ..ReferenceLimits::new(RATE, 0.3, 0.03) };
    hold(
        "record",
        &[
            run("clip", clipped(&limits)),
            run("clip, tight", clipped(&tight)),
            run("causal", caused(&limits, causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY)),
            run("causal, tight", caused(&tight, DriftRecovery { frequency: 2.0, damping: 0.5 }, 0.3)),
            run("preview of nothing", foreseen::<64, { preview::places(64) }>(&limits, 0.0)),
            run("preview of 2 samples", foreseen::<2, { preview::places(2) }>(&limits, 0.001)),
            run("preview of 8", foreseen::<8, { preview::places(8) }>(&limits, 0.007)),
            run("preview of 32", foreseen::<32, { preview::places(32) }>(&limits, 0.03)),
            run("preview of 64", foreseen::<64, { preview::places(64) }>(&tight, 0.05)),
            run("preview of 128", foreseen::<128, { preview::places(128) }>(&limits, 0.127)),
            run("preview of 256", foreseen::<256, { preview::places(256) }>(&limits, 0.2)),
            run("preview of 512", foreseen::<512, { preview::places(512) }>(&limits, 0.511)),
            run("preview of 512, tight", foreseen::<512, { preview::places(512) }>(&tight, 0.4)),
        ],
    );
}
