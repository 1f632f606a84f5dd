//! What the walks through commissioning share: a question to the person at the table, and one to the device.

use super::failed;
use crate::cli::Failure;
use crate::cli::output::print;
use crate::device::{Port, Session, SessionError};
use shakedown_core::State;
use shakedown_core::link::HostRequest;
use std::io::BufRead as _;
use std::time::{Duration, Instant};

/// Names of the inputs, in their order.
pub(super) const INPUTS: [&str; 4] = ["reference", "displacement", "acceleration", "external"];

/// Asks for a step; what was typed, or none at the end or at `stop`.
pub(super) fn prompted(number: &str, instruction: &str) -> Result<Option<String>, Failure> {
    print(&format!("{number}. {instruction} "));
    let mut typed = String::new();
    let read = std::io::stdin().lock().read_line(&mut typed).map_err(|e| Failure::Work(e.to_string()))?;
    let typed = typed.trim().to_owned();
    Ok((read > 0 && typed != "stop").then_some(typed))
}

/// Longest that a safe ramp may take, and a little more; no trip is cleared before its ramp has ended.
const LONGEST_RAMP: Duration = Duration::from_secs(11);
/// How soon a trip that is still ramping down is asked for again.
const AGAIN: Duration = Duration::from_millis(10);

/// Leaves a trip behind, and what was on the output.
pub(super) fn clear(session: &mut Session<Port>) -> Result<(), Failure> {
    let asked = Instant::now();
    loop {
        match session.order(&HostRequest::ClearTrip) {
            // Handed to the loop, which clears nothing before the ramp has ended.
            Ok(()) => {}
            // There was none, or its cause stands.
            Err(SessionError::Refused(_)) => return Ok(()),
            Err(error) => return Err(failed(error)),
        }
        if session.vitals().map_err(failed)?.state != State::Tripped || asked.elapsed() > LONGEST_RAMP {
            return Ok(());
        }
        std::thread::sleep(AGAIN);
    }
}

/// Mean codes of all inputs over half a second.
pub(super) fn means(session: &mut Session<Port>) -> Result<[f64; INPUTS.len()], Failure> {
    session.listen(Duration::from_millis(200)).map_err(failed)?;
    let heard = session.listen(Duration::from_millis(500)).map_err(failed)?;
    let rows = heard.rows();
    if rows.is_empty() {
        return Err(Failure::Work("no telemetry came: is `telemetry_every` 0 in the setup?".into()));
    }
    Ok(std::array::from_fn(|place| {
        let sum: f64 = rows.iter().filter_map(|row| row.record.inputs.get(place)).map(|&code| f64::from(code)).sum();
        sum / rows.len() as f64
    }))
}
