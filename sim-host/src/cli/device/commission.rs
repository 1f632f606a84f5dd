//! The first steps of `docs/commissioning.md`, one after the other, with what each measured in a file.

mod oil;
mod options;

use super::asking::{INPUTS, clear, means, prompted};
use super::calibration::say_overdue;
use super::{failed, proof};
use crate::cli::Failure;
use crate::cli::output::{print, write_whole};
use crate::cli::places::place;
use crate::cli::unseen::say_unseen;
use crate::device::{PROOF_TEST, Port, Session};
use shakedown_core::link::HostRequest;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// `device commission`.
#[derive(Debug, clap::Args)]
pub(super) struct Commission {
    /// Where what was measured is written.
    #[arg(long, value_name = "FILE", default_value = "commissioning.toml", value_parser = place())]
    out: PathBuf,
    /// Walks through the proof test alone, before the first test of a day; its result is kept in proof-test.toml.
    #[arg(long, conflicts_with_all = ["out", "record"])]
    pub(super) daily: bool,
    /// Calibrates LVDT and accelerometer against a reference of yours; kept with its date in calibration.toml.
    #[arg(long, conflicts_with_all = ["out", "record", "daily"])]
    pub(super) calibrate: bool,
    /// The record of steps 12 and 14, columns `time` (s) and `reference` (m); without it they are left out.
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

/// What a step measures.
#[derive(Debug, Clone, Copy)]
enum Measures {
    /// What a person reads off and types.
    Typed,
    /// Codes of the inputs, their mean over half a second.
    Inputs,
    /// State and cause.
    Standing,
    /// The same, once the trip is cleared.
    Cleared,
    /// What a meter behind the shifter reads with a code so many quarters up the output's range.
    Output(u32),
}

/// Steps by their number in the guide.
const STEPS: &[(&str, &str, Measures)] = &[
    ("1", "Board without shifters. Relay light off; voltage at PB0 [V]?", Measures::Typed),
    ("2", "Press reset, hold reset, pull the supply: PB0 at 0 V each time [yes/no]?", Measures::Typed),
    ("3", "Shifters on, all inputs at 0 V, then Enter.", Measures::Inputs),
    ("4", "+5.000 V on every input, then Enter.", Measures::Inputs),
    ("5", "Pull every input's wire, then Enter.", Measures::Inputs),
    ("6", "Press the emergency stop, then Enter.", Measures::Standing),
    ("6a", "Release it, then Enter.", Measures::Cleared),
    ("6b", "Hold the limit switch at the positive end open, then Enter.", Measures::Standing),
    ("6c", "Release it, then Enter.", Measures::Cleared),
    ("6d", "Hold the one at the negative end open, then Enter.", Measures::Standing),
    ("7a", "Release it. At the changeover's contact from the shifter [V]?", Measures::Output(2)),
    ("7b", "The same contact [V]?", Measures::Output(3)),
    ("8", "Write the setup, save it, reset; the vitals say `stored` [yes/no]?", Measures::Typed),
];

impl Commission {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        print("Hydraulics off. Enter goes on; `stop` ends, and keeps what was measured so far.\n");
        let mut text = String::from("# What the first steps of the commissioning guide measured.\n");
        say_overdue(session)?;
        say_unseen(&session.setup().map_err(failed)?.control);
        let ended = options::compare(session, &mut text)
            .and_then(|()| Self::dry(session, &mut text))
            .and_then(|all| if all { self.oil(session, &mut text) } else { Ok(()) });
        // What was measured before something failed is kept too.
        write_whole(&self.out, text.as_bytes())?;
        print(&format!("\nWrote {}.\n", self.out.display()));
        ended
    }

    /// The steps with the hydraulics off; whether all were walked.
    fn dry(session: &mut Session<Port>, text: &mut String) -> Result<bool, Failure> {
        let full_scale = session.setup().map_err(failed)?.wiring.full_scale;
        for &(number, instruction, measures) in STEPS {
            if let Measures::Output(quarters) = measures {
                clear(session)?;
                session.order(&HostRequest::Probe(up(full_scale, quarters))).map_err(failed)?;
            }
            let Some(typed) = prompted(number, instruction)? else { return Ok(false) };
            let _ = writeln!(text, "\n[step-{number}]\ninstruction = {instruction:?}\ntyped = {typed:?}");
            match measures {
                Measures::Typed => {}
                Measures::Output(quarters) => {
                    let _ = writeln!(text, "output_code = {}", up(full_scale, quarters));
                }
                Measures::Inputs => inputs(session, text)?,
                Measures::Standing | Measures::Cleared => {
                    if matches!(measures, Measures::Cleared) {
                        clear(session)?;
                    }
                    let vitals = session.vitals().map_err(failed)?;
                    let cause = vitals.cause.map_or("none".into(), |cause| format!("{cause:?}"));
                    let _ = writeln!(text, "state = \"{:?}\"\ncause = \"{cause}\"", vitals.state);
                }
            }
        }
        Ok(true)
    }

    /// The steps with the pressure low, each begun by a `yes`.
    fn oil(&self, session: &mut Session<Port>, text: &mut String) -> Result<(), Failure> {
        clear(session)?;
        if !proof::agreed(Path::new(PROOF_TEST))? {
            return Ok(());
        }
        let setup = session.setup().map_err(failed)?;
        let record = match &self.record {
            Some(file) => Some(crate::cli::reference::resampled(file, "reference", f64::from(setup.control.rate))?),
            None => None,
        };
        oil::Oil { session, setup, record }.walk(text)
    }
}

/// The code so many quarters up the range of converters whose codes are counted from the power of two above `full_scale`.
const fn up(full_scale: u16, quarters: u32) -> u16 {
    ((full_scale as u32 + 1).next_power_of_two() / 4 * quarters) as u16
}

/// Mean codes of all inputs, noted.
fn inputs(session: &mut Session<Port>, text: &mut String) -> Result<(), Failure> {
    for (name, mean) in INPUTS.iter().zip(means(session)?) {
        let _ = writeln!(text, "{name}_code = {mean:.2}");
    }
    Ok(())
}
