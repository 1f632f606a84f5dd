//! The proof test: stop, limit switches, relay and the wire of a command, tried before the first test of a day, with the hydraulics off.

use super::asking::{clear, means, prompted};
use super::calibration::say_overdue;
use super::failed;
use crate::cli::Failure;
use crate::cli::asked::utc;
use crate::cli::output::{print, write_whole};
use crate::device::{Port, ProofTest, Session, proof_test_kept};
use shakedown_core::link::{HostRequest, Report, Setup, Source, StopCause, answer};
use shakedown_core::{Mode, State};
use std::fmt::Write as _;
use std::path::Path;

/// What a step must find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Expects {
    /// Tripped, by the emergency stop's circuit.
    Stopped,
    /// Off once the trip is cleared, so that its cause is gone.
    Cleared,
    /// The code of this input away from that of zero: a wire that is shorted stays there.
    Away(Wire),
    /// That who looks at the relay says `yes`, after this.
    Seen(Does),
}

/// A command at the converter, which no monitor can distinguish from one of zero where it is shorted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wire {
    Reference,
    External,
}

impl Wire {
    /// Its place among the inputs, and the code of zero there.
    const fn input(self, setup: &Setup) -> (usize, f32) {
        match self {
            Self::Reference => (0, setup.wiring.reference.zero),
            Self::External => (3, setup.wiring.external.zero),
        }
    }
}

/// What is done to the relay before it is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Does {
    Arm,
    Trip,
}

/// Least distance from zero of a command that is tried, as a share of the converter's range: 1 V of 20, where 2 are asked for.
const AWAY: f64 = 0.05;

type Step = (&'static str, Expects);

const STOPS: [Step; 6] = [
    ("Press the emergency stop, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
    ("Hold the limit switch at the positive end open, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
    ("Hold the one at the negative end open, then Enter.", Expects::Stopped),
    ("Release it, then Enter.", Expects::Cleared),
];
const REFERENCE: [Step; 2] = [
    ("Set the reference to +2 V at its source, then Enter.", Expects::Away(Wire::Reference)),
    ("Set it back to 0 V, then Enter.", Expects::Cleared),
];
const EXTERNAL: [Step; 2] = [
    ("Make the existing controller command +2 V or more, then Enter.", Expects::Away(Wire::External)),
    ("Let it command nothing again, then Enter.", Expects::Cleared),
];
const RELAY: [Step; 2] = [
    ("The device is armed: is the relay closed [yes/no]?", Expects::Seen(Does::Arm)),
    ("The device is tripped: is the relay open again [yes/no]?", Expects::Seen(Does::Trip)),
];

/// The steps for what is wired under `setup`.
fn steps(setup: &Setup) -> Vec<Step> {
    let of = |wired: bool, steps: &'static [Step]| if wired { steps } else { &[] };
    let reference = of(setup.wiring.source == Source::Analog && setup.control.mode != Mode::Guard, &REFERENCE);
    [&STOPS, reference, of(setup.control.mode == Mode::Guard, &EXTERNAL), &RELAY].concat()
}

/// Walks it, and writes to `file` when it was and how each step went. One that fails, or is not ended, is a failure, and no test is
/// begun on it.
pub(super) fn walk(session: &mut Session<Port>, file: &Path) -> Result<(), Failure> {
    print("Proof test: hydraulics off. Enter goes on; `stop` ends, and then it counts as not passed.\n");
    let (mut text, mut failures) = (String::new(), Vec::new());
    say_overdue(session)?;
    clear(session)?;
    let setup = session.setup().map_err(failed)?;
    for (number, (instruction, expects)) in (1..).zip(steps(&setup)) {
        if let Expects::Seen(does) = expects {
            prepare(session, does)?;
        }
        let typed = prompted(&number.to_string(), instruction)?;
        let passed = match &typed {
            None => false,
            Some(typed) => holds(session, &setup, expects, typed)?,
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

fn holds(session: &mut Session<Port>, setup: &Setup, expects: Expects, typed: &str) -> Result<bool, Failure> {
    if expects == Expects::Cleared {
        clear(session)?;
    }
    let vitals = session.vitals().map_err(failed)?;
    Ok(match expects {
        Expects::Stopped => (vitals.state, vitals.cause) == (State::Tripped, Some(StopCause::EmergencyStop)),
        Expects::Cleared => vitals.state == State::Off,
        Expects::Away(wire) => {
            let (input, zero) = wire.input(setup);
            let code = means(session)?.get(input).copied().unwrap_or(f64::NAN);
            (code - f64::from(zero)).abs() >= AWAY * f64::from(setup.wiring.full_scale)
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use shakedown_firmware::defaults;

    /// A command at the converter is tried where there is one, and nowhere else.
    #[test]
    fn the_wire_of_a_command_is_tried_where_there_is_one() {
        let tried = |mode, source| {
            let mut setup = defaults::setup();
            (setup.control.mode, setup.wiring.source) = (mode, source);
            let wires = steps(&setup).into_iter().filter_map(|(_, expects)| match expects {
                Expects::Away(wire) => Some(wire),
                _ => None,
            });
            wires.collect::<Vec<_>>()
        };
        assert_eq!(tried(Mode::Controller, Source::Streamed), []);
        assert_eq!(tried(Mode::Modifier, Source::Rehearsal), []);
        assert_eq!(tried(Mode::Controller, Source::Analog), [Wire::Reference]);
        assert_eq!(tried(Mode::Modifier, Source::Analog), [Wire::Reference]);
        assert_eq!(tried(Mode::Guard, Source::Analog), [Wire::External]);
    }
}
