//! Converters of 16 bits outboard: what a converter that fails, and a wire to it, come to.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use crate::common::{near_field, outboard, seen::Mischief, seen::Seen, setup_outboard};
use shakedown::blocks::device::{DriveError, Progress};
use shakedown_core::link::StopCause;
use shakedown_core::{Mode, Trip};
use shakedown_replay::Ran;

/// When the fault begins: in the middle of a run.
const AT: usize = 6000;

fn seen(seconds: usize) -> Seen {
    let mut seen = Seen::new(setup_outboard(Mode::Controller), near_field(seconds));
    seen.limit = 1000 * seconds + 4000;
    seen
}

fn run(seen: Seen) -> Ran<Seen> {
    shakedown_replay::run(&outboard(), seen).unwrap()
}

/// That it ends with a lost sensor, and how long after the fault the relay opens, ms.
fn loses_the_sensor(seen: Seen) -> f64 {
    let seen = run(seen).world;
    let lost = StopCause::Guard(Trip::SensorLost);
    assert!(
        matches!(seen.progress, Progress::Failed(DriveError::Stopped { cause, .. }) if cause == lost),
        "{:?}",
        seen.progress
    );
    assert_eq!(seen.resets, 0);
    assert!(seen.codes[AT - 1].relay, "the fault met no run");
    let open = (AT..seen.codes.len()).find(|&tick| !seen.codes[tick].relay).expect("the relay stayed closed");
    (seen.times[open] - seen.times[AT]) as f64 / 1e6
}

#[test]
fn a_converter_that_stays_busy_trips() {
    let mut dead = seen(12);
    dead.dead_from = Some(AT);
    let opened = loses_the_sensor(dead);
    assert!(opened <= 70.0, "{opened} ms");
}

#[test]
fn a_broken_wire_at_a_rail_trips() {
    let mut broken = seen(12);
    let rail: Mischief = Box::new(|tick, _| {
        if tick.index as usize >= AT {
            tick.inputs[1] = 3;
        }
    });
    broken.mischief = Some(rail);
    let opened = loses_the_sensor(broken);
    assert!(opened <= 70.0, "{opened} ms");
}

#[test]
fn a_conversion_that_takes_too_long_once_is_coasted_over() {
    let mut late = seen(8);
    late.lost_at = Some(AT);
    let late = run(late).world;
    assert_eq!((late.progress, late.resets), (Progress::Done, 0));
}

/// What this image touches and the emulator has no model for: the generator of random numbers.
#[test]
fn the_emulator_is_blind_to_the_generator_alone() {
    let ran = run(seen(2));
    let blind = |spot: &&String| !spot.starts_with("RNG.");
    assert_eq!(ran.blind_spots.iter().filter(blind).count(), 0, "{:?}", ran.blind_spots);
}
