//! The front end between a board and its rig: sheets of parts and nets, from which come the drawings, the list of parts and the
//! decks that ngspice runs. `firmware/front-end` holds the sheets; drawings and list are beside them.

mod deck;
mod draw;
mod list;
mod sheet;

use std::path::PathBuf;

use crate::output::say;
use crate::setup::{self, NGSPICE};
use crate::shell::{Problem, top};
use deck::Corner;
use sheet::Sheet;

/// The sheets, in the order of the drawings.
const SHEETS: [&str; 5] = ["input", "sensor", "output", "relay", "reference"];
/// Runs of every trial: nominal, and with every part at one end or the other of its tolerance.
const RUNS: u64 = 10;

fn folder() -> PathBuf {
    top().join("firmware/front-end")
}

/// The chore: checks the sheets, compares drawings and list with those beside them, or writes them (`draw`), and has ngspice
/// run every trial.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    let write = match words.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => false,
        ["draw"] => true,
        _ => return Err(Problem::Usage("front-end takes `draw` or nothing".into())),
    };
    let sheets = SHEETS.iter().map(|name| Sheet::read(&folder(), name)).collect::<Result<Vec<_>, _>>()?;
    let items = list::items(&folder())?;
    let wrong: Vec<String> = sheets.iter().flat_map(|sheet| sheet.mistakes(&items)).collect();
    if !wrong.is_empty() {
        return Err(Problem::Failed(wrong.join("\n")));
    }
    for sheet in &sheets {
        kept(&format!("{}.svg", sheet.name), &draw::svg(sheet), write)?;
    }
    kept("parts.csv", &list::csv(&sheets, &items), write)?;
    simulated(&sheets)
}

/// A file beside the sheets: as it should be, or written.
fn kept(name: &str, text: &str, write: bool) -> Result<(), Problem> {
    let path = folder().join(name);
    if write {
        return std::fs::write(&path, text).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())));
    }
    if std::fs::read_to_string(&path).is_ok_and(|there| there == text) {
        return Ok(());
    }
    Err(Problem::Failed(format!("{}: not what the sheets say; `cargo xtask front-end draw` writes it", path.display())))
}

fn simulated(sheets: &[Sheet]) -> Result<(), Problem> {
    setup::need(&[NGSPICE])?;
    let mut broken = Vec::new();
    for sheet in sheets {
        say(&format!("\n{} ({RUNS} runs)", sheet.title));
        for trial in &sheet.trials {
            let mut answers = Vec::new();
            for run in 0..RUNS {
                let answer = deck::solved(sheet, trial, Corner::of(run))?;
                if let Some(why) = trial.breach(&sheet.output, answer) {
                    broken.push(format!("{}, {}, run {run}: {why}", sheet.name, trial.name));
                }
                answers.push(answer);
            }
            say(&format!("  {:52} {}", trial.name, trial.spread(&sheet.output, &answers)));
        }
        if let Some(corner) = &sheet.corner {
            let found = (0..RUNS).map(|run| deck::corner(sheet, Corner::of(run)));
            let found = found.collect::<Result<Vec<f64>, _>>()?;
            let (low, high) = sheet::ends(&found);
            say(&format!("  {:52} {low:.0} to {high:.0} Hz", "corner, -3 dB"));
            if [low, high].iter().any(|f| (f / corner.hertz - 1.0).abs() > corner.within) {
                broken.push(format!("{}: a corner of {low:.0} to {high:.0} Hz", sheet.name));
            }
        }
    }
    broken.extend(planted(sheets)?);
    if broken.is_empty() { Ok(()) } else { Err(Problem::Failed(broken.join("\n"))) }
}

/// The wire that a part draws to a rail when it breaks.
const DRAWN: [(&str, &str); 3] = [("R1", "signal"), ("R2", "return"), ("D3", "return")];

/// The control of the trials: without a part that draws a broken wire to a rail, one of them finds that it does not go there.
fn planted(sheets: &[Sheet]) -> Result<Option<String>, Problem> {
    for sheet in sheets.iter().filter(|sheet| sheet.stimuli.contains_key("return")) {
        for (missing, wire) in DRAWN {
            let mut without = sheet.clone();
            without.parts.retain(|part| part.name != missing);
            let mut found = false;
            for trial in sheet.trials.iter().filter(|trial| trial.broken == [wire]) {
                found |= trial.breach(&sheet.output, deck::solved(&without, trial, Corner::of(0))?).is_some();
            }
            if !found {
                return Ok(Some(format!("{}: that {missing} is missing was not found", sheet.name)));
            }
        }
    }
    say("\nwithout the parts that draw it to a rail a broken wire ends elsewhere, and is found");
    Ok(None)
}

#[cfg(test)]
mod tests;
