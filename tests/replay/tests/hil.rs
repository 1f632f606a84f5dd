//! The tests that run on a board, unchanged on the emulated one, with a wire from output to input.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests and their helpers")]

use crate::common::built;
use shakedown_replay::{Ran, Tick, World};

/// Ticks after which it ends in any case.
const LIMIT: u64 = 5000;

/// A wire from the output to the LVDT's input, or one that adds so many of the sum of 16 scans.
struct Looped {
    off: u16,
}

impl World for Looped {
    fn tick(&mut self, tick: Tick<'_>) -> bool {
        tick.inputs[1] = tick.output.unwrap_or(0).saturating_add(self.off).min(65_520);
        tick.index < LIMIT
    }
}

fn run(off: u16) -> Ran<Looped> {
    shakedown_replay::run_logged(&built("shakedown-hil"), Looped { off }).unwrap()
}

#[test]
fn the_boards_own_tests_pass_on_the_emulated_board() {
    let ran = run(0);
    print!("{}", ran.console);
    assert_eq!((ran.status, ran.resets.len()), (Some(0), 3), "{}", ran.console);
    let passed = ran.console.lines().filter(|line| line.contains("... ok")).count();
    assert_eq!(passed, 12, "{}", ran.console);
}

/// The program panics, and then its clock fails, with the relay closed: what it logs of that comes after the relay's opening.
#[test]
fn a_panic_and_a_clock_that_fails_open_the_relay_before_they_log() {
    let ran = run(0);
    for what in ["a panic", "a clock that fails"] {
        assert!(ran.console.contains(&format!("{what} ends in a reset ... ok")), "{}", ran.console);
    }
    // Each start writes the word once, for its first value.
    assert!(ran.logged.len() > ran.resets.len() + 2, "one of them logged nothing");
    assert!(ran.logged.iter().all(|closed| !closed), "it was logged with the relay closed: {:?}", ran.logged);
}

/// The control: a converter that is 640 codes off.
#[test]
fn a_converter_that_is_off_fails_them() {
    let ran = run(640);
    assert_eq!(ran.status, Some(1), "{}", ran.console);
    assert!(ran.console.contains("largest difference ... FAILED"), "{}", ran.console);
}
