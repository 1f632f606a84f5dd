//! `shakedown compare`: two files, by what they are.

mod drive;
mod experiments;
mod recordings;
mod reports;

use super::Failure;
use super::output::Outputs;
use super::source::Text;
use crate::closed_loop::learning::stale::Staleness;
use crate::motion::drive::Drive;
use crate::motion::metrics::Played;
use crate::motion::read::{self, Options};
use crate::motion::{Format, Motion, Record};
use std::path::{Path, PathBuf};

/// Compares two files by what they are: two experiments (what changed on the table), a drive and the recording of it (indices, delay,
/// gain, coherence), two recordings of one motion (whether a learnt drive is stale), or two results of `--json` (side by side).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown compare march.toml october.toml                      what changed, number by number, with intervals
  shakedown compare drive.csv recording.csv --report run.html    how near the table came to the drive
  shakedown compare drive.rpc test.tdms --displacement LVDT --reference Setpoint
  shakedown compare check_may.csv check_june.csv                 a check run then and now: has the specimen changed?
  shakedown compare before.json after.json                       two results of one command

Two experiments state the same model; `fit` says what may differ, and without it all that the model states may.
A drive is found in the recording wherever it begins; rates may differ. Where the recording holds the reference that the controller
was given, the table's delay is known; without it the start is taken from the motion.")]
pub(crate) struct Args {
    /// An experiment (.toml), a drive or ground-motion record, or a result of `--json`.
    #[arg(value_name = "A")]
    first: PathBuf,
    /// An experiment, a recording, or another result of the same command.
    #[arg(value_name = "B")]
    second: PathBuf,
    /// Recording: column of the table's displacement [default: by its name].
    #[arg(long, value_name = "COLUMN")]
    displacement: Option<String>,
    /// Recording: column of the table's acceleration [default: by its name; else from the displacement].
    #[arg(long, value_name = "COLUMN")]
    acceleration: Option<String>,
    /// Recording: column of the reference that the controller was given [default: by its name, if any].
    #[arg(long, value_name = "COLUMN")]
    reference: Option<String>,
    #[command(flatten)]
    text: Text,
    #[command(flatten)]
    outputs: Outputs,
}

/// A drive found in the recording of it; `displacement` names the column where its own name does not.
pub(super) fn of_drive(
    drive: &Path,
    motion: &Motion,
    recording: &Path,
    displacement: Option<&str>,
) -> Result<Played, Failure> {
    let args = Args { displacement: displacement.map(str::to_owned), ..Args::of(drive, recording) };
    drive::found(&args, recording, motion)
}

/// How the second recording of a motion differs from the first.
pub(super) fn answered(first: &Path, second: &Path) -> Result<Staleness, Failure> {
    recordings::answered(&Args::of(first, second))
}

impl Args {
    /// Two files, and nothing stated of them.
    fn of(first: &Path, second: &Path) -> Self {
        Self {
            first: first.to_owned(),
            second: second.to_owned(),
            displacement: None,
            acceleration: None,
            reference: None,
            text: Text::default(),
            outputs: Outputs::default(),
        }
    }
}

/// What a file is to this command.
enum Kind {
    Experiment,
    Result,
    Motion(Box<Asked>),
    Other,
}

/// What the table was asked for, and what its file says of it.
struct Asked {
    motion: Motion,
    /// What the drive's file says of its making; of a record, its title.
    facts: Vec<(String, String)>,
    /// `drive`, or `record`.
    what: &'static str,
}

/// Compares the two.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    for path in [&args.first, &args.second] {
        if let Err(e) = std::fs::metadata(path) {
            return Err(Failure::Input(format!(
                "{}: cannot be read: {e}; check its name and its folder",
                path.display()
            )));
        }
    }
    match (kind(&args.first)?, kind(&args.second)?) {
        (Kind::Experiment, Kind::Experiment) => experiments::run(args),
        (Kind::Result, Kind::Result) => reports::run(args),
        (Kind::Motion(asked), Kind::Other) => drive::run(args, &args.second, *asked),
        (Kind::Other, Kind::Motion(asked)) => drive::run(args, &args.first, *asked),
        (Kind::Other, Kind::Other) => recordings::run(args),
        (a, b) => Err(Failure::Input(format!(
            "{} is {} and {} is {}: expected two experiments, a drive and its recording, two recordings of one motion, or two results of --json",
            args.first.display(),
            a.words(),
            args.second.display(),
            b.words()
        ))),
    }
}

impl Kind {
    fn words(&self) -> &'static str {
        match self {
            Self::Experiment => "an experiment",
            Self::Result => "a result",
            Self::Motion(asked) if asked.what == "drive" => "a drive",
            Self::Motion(_) => "a ground-motion record",
            Self::Other => "a recording",
        }
    }
}

fn kind(path: &Path) -> Result<Kind, Failure> {
    let named = |end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
    if named("json") {
        return Ok(Kind::Result);
    }
    if named("toml") {
        return Ok(Kind::Experiment);
    }
    if let Some(drive) = Drive::read(path).map_err(|e| Failure::Input(e.to_string()))? {
        return Ok(Kind::Motion(Box::new(Asked { motion: drive.motion(), facts: drive.facts, what: "drive" })));
    }
    // A record that states its unit and step by itself; columns of text are recordings.
    Ok(match read::record(path, &Options::default()) {
        Ok(record) if record.format != Format::Columns => Kind::Motion(Box::new(of_record(&record))),
        _ => Kind::Other,
    })
}

fn of_record(record: &Record) -> Asked {
    let facts = vec![("source".to_owned(), record.name.clone()), ("format".into(), record.format.name().into())];
    Asked { motion: record.motion(), facts, what: "record" }
}
