//! The proof test: stop, limit switches and relay, tried before the first test of a day, with the hydraulics off.

use super::asking::{clear, prompted};
use super::calibration::say_overdue;
use super::failed;
use crate::cli::Failure;
use crate::cli::asked::utc;
use crate::cli::output::{print, write_whole};
use crate::device::{Port, ProofTest, Session, proof_test_kept};
use shakedown_core::State;
use shakedown_core::link::{HostRequest, Report, StopCause, answer};
use std::fmt::Write as _;
use std::path::Path;

/// What a step must find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expects {
    /// Tripped, by the emergency stop's circuit.
    Stopped,
    /// Off once the trip is cleared, so that its cause is gone.
    Cleared,
    /// That who looks at the relay says `yes`, after this.
    Seen(Does),
}

/// What is done to the relay before it is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Does {
    Arm,
    Trip,
}

const STEPS: [(&str, Expects); 8] = [
    ("Press the emergency stop, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
    ("Hold the limit switch at the positive end open, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
    ("Hold the one at the negative end open, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
    ("The device is armed: is the relay closed [yes/no]?", Expects::Seen(Does::Arm)),
    ("The device is tripped: is the relay open again [yes/no]?", Expects::Seen(Does::Trip)),
];

/// Walks it, and writes to `file` when it was and how each step went. One that fails, or is not ended, is a failure, and no test is
/// begun on it.
pub(super) fn walk(session: &mut Session<Port>, file: &Path) -> Result<(), Failure> {
    print("Proof test: hydraulics off. Enter goes on; `stop` ends, and then it counts as not passed.\n");
    let (mut text, mut failures) = (String::new(), Vec::new());
    say_overdue(session)?;
    clear(session)?;
    for (number, (instruction, expects)) in (1..).zip(STEPS) {
        if let Expects::Seen(does) = expects {
            prepare(session, does)?;
        }
        let typed = prompted(&number.to_string(), instruction)?;
        let passed = match &typed {
            None => false,
            Some(typed) => holds(session, expects, typed)?,
        };
        let _ = writeln!(text, "\n[[step]]\ninstruction = {instruction:?}\npassed = {passed}");
        if !passed {
            failures.push(number.to_string());
        }
        if typed.is_none() {
            break;
        }
    }
    clear(session)?;
    let passed = failures.is_empty();
    write_whole(file, (proof_test_kept(&utc(), passed) + &text).as_bytes())?;
    if passed {
        print(&format!("\nPassed; {} holds it for a day.\n", file.display()));
        return Ok(());
    }
    let steps = failures.join(", ");
    Err(Failure::Work(format!("the proof test is not passed: step {steps}; find out why before any test")))
}

fn prepare(session: &mut Session<Port>, does: Does) -> Result<(), Failure> {
    if does == Does::Trip {
        return session.order(&HostRequest::Trip).map_err(failed);
    }
    let challenge = session
        .ask(&HostRequest::RequestArming, |report| if let Report::Challenge(c) = report { Some(*c) } else { None })
        .map_err(failed)?;
    session.order(&HostRequest::Arm(answer(challenge))).map_err(failed)
}

fn holds(session: &mut Session<Port>, expects: Expects, typed: &str) -> Result<bool, Failure> {
    if expects == Expects::Cleared {
        clear(session)?;
    }
    let vitals = session.vitals().map_err(failed)?;
    Ok(match expects {
        Expects::Stopped => (vitals.state, vitals.cause) == (State::Tripped, Some(StopCause::EmergencyStop)),
        Expects::Cleared => vitals.state == State::Off,
        Expects::Seen(does) => {
            let state = if does == Does::Arm { State::Ready } else { State::Tripped };
            typed == "yes" && vitals.state == state
        }
    })
}

/// Asks for the proof test where it is overdue; a typed `yes` goes on without.
pub(super) fn agreed(file: &Path) -> Result<bool, Failure> {
    let Some(overdue) = ProofTest::new(file).overdue() else { return Ok(true) };
    Ok(prompted("note", &format!("{overdue}.\nGo on without [yes/no]?"))?.is_some_and(|typed| typed == "yes"))
}

/// The same before a test, which is not begun without.
pub(super) fn asked(file: &Path) -> Result<(), Failure> {
    if agreed(file)? {
        return Ok(());
    }
    let overdue = ProofTest::new(file).overdue().unwrap_or_default();
    Err(Failure::Input(format!("{overdue}: `device commission --daily` walks through it")))
}
