//! The proof test: stop, limit switches and relay, tried before the first test of a day, with the hydraulics off; and whether one is due.

use super::commission::{clear, prompted};
use super::failed;
use crate::cli::Failure;
use crate::cli::asked::utc;
use crate::cli::output::{print, write_whole};
use shakedown::device::{Port, Session};
use shakedown_core::State;
use shakedown_core::link::{HostRequest, Report, StopCause, answer};
use std::fmt::Write as _;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Where it is kept, in the folder that the tool is called from: one folder a table.
pub(super) const FILE: &str = "proof-test.toml";
/// How long it holds, s: a day.
const HOLDS: u64 = 86_400;

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
    let (passed, date, now) = (failures.is_empty(), utc(), now());
    write_whole(file, format!("date = {date:?}\nseconds = {now}\npassed = {passed}\n{text}").as_bytes())?;
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

fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// Asks for the proof test where it is overdue; what is asked for is run, or a typed `yes` goes on without.
pub(super) fn asked(file: &Path) -> Result<(), Failure> {
    let text = std::fs::read_to_string(file).ok();
    let Some(why) = due(text.as_deref(), now()) else { return Ok(()) };
    let overdue = format!("the proof test of stop, limit switches and relay {why} ({})", file.display());
    print(&format!("{overdue}.\nGo on without [yes/no]? "));
    let mut typed = String::new();
    let _ = std::io::stdin().read_line(&mut typed);
    if typed.trim() == "yes" {
        return Ok(());
    }
    Err(Failure::Input(format!("{overdue}: `device commission --daily` walks through it")))
}

/// Why a proof test is due, `now` in seconds since 1970; none where one holds.
fn due(text: Option<&str>, now: u64) -> Option<&'static str> {
    let Some(text) = text else { return Some("was never done here") };
    let Ok(table) = text.parse::<toml::Table>() else { return Some("left a file that cannot be read") };
    let seconds = table.get("seconds").and_then(toml::Value::as_integer).and_then(|at| u64::try_from(at).ok());
    match (table.get("passed").and_then(toml::Value::as_bool), seconds) {
        (Some(true), Some(at)) if at <= now && now - at <= HOLDS => None,
        (Some(true), Some(_)) => Some("is older than a day"),
        (Some(false), _) => Some("was not passed"),
        _ => Some("left a file that cannot be read"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proof_test_holds_for_a_day_and_only_if_it_passed() {
        let file = |passed, at| format!("date = \"\"\nseconds = {at}\npassed = {passed}\n");
        let now = 1_000_000;
        assert_eq!(due(Some(&file(true, now - HOLDS)), now), None);
        assert_eq!(due(Some(&file(true, now - HOLDS - 1)), now), Some("is older than a day"));
        assert_eq!(due(Some(&file(true, now + 1)), now), Some("is older than a day"));
        assert_eq!(due(Some(&file(false, now)), now), Some("was not passed"));
        assert_eq!(due(None, now), Some("was never done here"));
        for text in ["passed = true", "seconds = 1", "passed = 1\nseconds = 1", "= ="] {
            assert_eq!(due(Some(text), now), Some("left a file that cannot be read"), "{text}");
        }
    }
}
