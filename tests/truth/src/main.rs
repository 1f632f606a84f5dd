//! Writes concealed cases into folders: `shakedown-truth DIR [--examiner 1|2] [--seed N] [--lock L] [--cases K] [--from I] [--open]`.
//!
//! `--open` writes each answer beside its experiment, for work on the diagnosis; an examination does without.

use shakedown_truth::{case, lab};
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

const USAGE: &str = "usage: shakedown-truth DIR [--examiner 1|2] [--seed N] [--lock L] [--cases K] [--from I] [--open]";

struct Wanted {
    folder: PathBuf,
    examiner: u64,
    lock: u64,
    seed: u64,
    cases: u64,
    from: u64,
    open: bool,
}

fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Wanted, String> {
    let mut wanted = Wanted {
        folder: PathBuf::new(),
        examiner: 2,
        lock: lab::DEVELOPMENT,
        seed: 1,
        cases: 10,
        from: 0,
        open: false,
    };
    while let Some(argument) = arguments.next() {
        let mut number = |name: &str| -> Result<u64, String> {
            let text = arguments.next().ok_or(format!("{name} needs a number"))?;
            text.parse().map_err(|_| format!("{name}: '{text}' is no whole number"))
        };
        match argument.as_str() {
            "--examiner" => wanted.examiner = number("--examiner")?,
            "--lock" => wanted.lock = number("--lock")?,
            "--seed" => wanted.seed = number("--seed")?,
            "--cases" => wanted.cases = number("--cases")?,
            "--from" => wanted.from = number("--from")?,
            "--open" => wanted.open = true,
            other if other.starts_with('-') => return Err(format!("{other} is not known")),
            folder => wanted.folder = folder.into(),
        }
    }
    if wanted.folder.as_os_str().is_empty() {
        return Err("no folder given".into());
    }
    if !(1..=2).contains(&wanted.examiner) {
        return Err(format!("--examiner: there is no examiner {}, only 1 and 2", wanted.examiner));
    }
    Ok(wanted)
}

/// Writes the opened answer beside the experiment: answer, and the experiment without noise.
macro_rules! write_case {
    ($case:expr, $wanted:expr) => {{
        let case = $case;
        let folder = $wanted.folder.join(&case.name);
        case.write(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let mut line = format!("{}\t{}", case.name, case.sealed.seal);
        if $wanted.open {
            let opened = case.sealed.open_after(&folder.join("experiment.toml")).map_err(|e| e.to_string())?;
            let text = opened.answer.to_json().to_string();
            std::fs::write(folder.join("answer.json"), &text).map_err(|e| e.to_string())?;
            opened.clean.write(&folder.join("clean")).map_err(|e| e.to_string())?;
            line = format!("{line}\t{text}");
        }
        Ok(line)
    }};
}

fn write(number: u64, wanted: &Wanted) -> Result<String, String> {
    if wanted.examiner == 1 {
        write_case!(case(wanted.seed, number), wanted)
    } else {
        write_case!(lab::locked(wanted.seed, number, wanted.lock), wanted)
    }
}

fn main() -> ExitCode {
    let wanted = match parse(std::env::args().skip(1)) {
        Ok(wanted) => wanted,
        Err(problem) => {
            eprintln!("error: {problem}\n{USAGE}");
            return ExitCode::from(2);
        }
    };
    let mut out = std::io::stdout().lock();
    for number in wanted.from..wanted.from + wanted.cases {
        match write(number, &wanted) {
            // A closed pipe is no error.
            Ok(line) => drop(writeln!(out, "{line}")),
            Err(problem) => {
                eprintln!("error: {problem}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}
