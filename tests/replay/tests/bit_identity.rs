//! The image on the emulated processor and the same sources on the host give the same command codes, all of them.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{image, near_field, outboard, seen::Seen, setup, setup_outboard, twin};
use shakedown::blocks::device::Progress;
use shakedown_core::link::Setup;
use shakedown_core::{Mode, State};
use shakedown_replay::World as _;
use std::path::PathBuf;

const SECONDS: usize = 60;
/// The laws are the same behind other converters, whose drivers show in any tick.
const OUTBOARD_SECONDS: usize = 20;

/// Runs `image` under `setup`, and the host; the first tick at which they differ.
fn first_difference(
    image: PathBuf,
    setup: Setup,
    seconds: usize,
    spoil: impl FnMut(usize, u16) -> u16,
) -> (Seen, Option<usize>) {
    let record = near_field(seconds);
    let seen = shakedown_replay::run(&image, Seen::new(setup, record.clone())).unwrap().world;
    assert_eq!(seen.progress, Progress::Done);
    assert_eq!(seen.drive.telemetry().gaps(), []);
    assert_eq!(seen.drive.telemetry().dropped(), 0);
    let ticks = seen.codes.len() - 1;
    let twin = twin::run(setup, &record, seen.drive.telemetry(), ticks, spoil);
    let difference = (0..ticks).find(|&tick| seen.codes[tick] != twin.codes[tick]);
    if difference.is_none() {
        telemetry_says_what_was_done(&seen, &twin);
    }
    (seen, difference)
}

/// Every record of telemetry is, bit for bit, what the twin did in that tick and what was at the converters.
fn telemetry_says_what_was_done(seen: &Seen, twin: &twin::Twin) {
    let rows = seen.drive.telemetry().rows();
    assert!(rows.len() > seen.codes.len() - 200);
    for row in rows {
        let codes = seen.codes[row.tick as usize];
        let output = seen.fitted().at_the_output(row.record.output);
        assert_eq!((row.record.inputs, output), (codes.inputs, codes.output), "tick {}", row.tick);
        let Some(entry) = twin.entries.get(row.tick as usize) else { continue };
        let bits = |r: &shakedown_core::link::Record| (r.reference.to_bits(), r.fitted.to_bits(), r.flags);
        assert_eq!(bits(&row.record), bits(&entry.record), "tick {}", row.tick);
        assert_eq!(row.state, entry.state, "tick {}", row.tick);
    }
}

fn identical(image: PathBuf, setup: Setup, seconds: usize) {
    let (seen, difference) = first_difference(image, setup, seconds, |_, code| code);
    assert_eq!(difference, None);
    let running = seen.drive.telemetry().run().count();
    assert!(running >= seconds * 1000, "{running} ticks ran");
    let outputs: std::collections::BTreeSet<u16> = seen.drive.telemetry().run().map(|row| row.record.output).collect();
    assert!(outputs.len() > 100, "only {} different codes: the run showed nothing", outputs.len());
}

#[test]
fn guard_mode_is_bit_identical() {
    identical(image(), setup(Mode::Guard), SECONDS);
}

#[test]
fn modifier_mode_is_bit_identical() {
    identical(image(), setup(Mode::Modifier), SECONDS);
}

#[test]
fn controller_mode_is_bit_identical() {
    identical(image(), setup(Mode::Controller), SECONDS);
}

#[test]
fn guard_mode_is_bit_identical_with_outboard_converters() {
    identical(outboard(), setup_outboard(Mode::Guard), OUTBOARD_SECONDS);
}

#[test]
fn modifier_mode_is_bit_identical_with_outboard_converters() {
    identical(outboard(), setup_outboard(Mode::Modifier), OUTBOARD_SECONDS);
}

#[test]
fn controller_mode_is_bit_identical_with_outboard_converters() {
    identical(outboard(), setup_outboard(Mode::Controller), OUTBOARD_SECONDS);
}

/// The control of the tests above: one bit wrong in one code, and they fail at that tick.
#[test]
fn one_wrong_bit_is_found() {
    let mut at = None;
    let spoil = |tick, code: u16| {
        if tick == 2500 {
            at = Some(tick);
            code ^ 1
        } else {
            code
        }
    };
    let (seen, difference) = first_difference(image(), setup(Mode::Controller), 4, spoil);
    assert_eq!(difference, at);
    assert!(seen.drive.telemetry().rows().iter().any(|row| row.tick == 2500 && row.state == State::Running));
}
