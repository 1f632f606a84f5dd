//! A motion made for a standard, in the file that it goes to; and a drive, as what is held against one.

use super::super::Failure;
use super::super::output::write_whole;
use super::{Answer, Args};
use crate::motion::drive::{Drive, Form};
use crate::motion::write::render;
use crate::motion::{Fact, Format, Record, STANDARD_GRAVITY};
use std::fmt::Write as _;
use std::path::Path;

/// Refuses, before the work, a file that holds no motion without limits.
pub(super) fn form(args: &Args) -> Result<(), Failure> {
    let Some(path) = &args.synthesise else { return Ok(()) };
    let place = format!("--synthesise {}", path.display());
    match Form::of(path) {
        Ok(Form::Csv | Form::Peer) => args.within.shape.only_with("--synthesise with --velocity, --stroke or --table"),
        Ok(Form::Rpc(_)) => Err(Failure::Input(format!(
            "{place}: a motion for a controller keeps a table's limits: add --velocity and --stroke, or --table, or name a .csv or .AT2"
        ))),
        Err(_) if std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) => Ok(()),
        Err(why) => Err(Failure::Input(format!("{place}: {why}"))),
    }
}

/// What a drive asks of the table, as a record of it.
pub(super) fn of_drive(path: &Path, drive: &Drive) -> Record {
    let name = path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let (acceleration, format) = (drive.motion().acceleration, Format::Generated);
    Record { name, dt: drive.dt, acceleration, component: "drive".into(), format, facts: Vec::new() }
}

/// Writes a motion without limits: PEER or columns.
pub(super) fn write(path: &Path, answer: &Answer) -> Result<(), Failure> {
    if Form::of(path) != Ok(Form::Peer) {
        return write_whole(path, columns(answer).as_bytes());
    }
    let (acceleration, dt, name) = (answer.acceleration.clone(), answer.dt, answer.name.clone());
    let fact = |key, value: &str| Fact { key, value: value.to_owned(), line: 1 };
    let facts = vec![
        fact("database", "NOT A RECORDED GROUND MOTION: MADE BY SHAKEDOWN FOR A REQUIRED SPECTRUM"),
        fact("title", answer.standard.title),
    ];
    let record = Record { name, dt, acceleration, component: "synthetic".into(), format: Format::Peer, facts };
    let text = render(&record).map_err(|e| Failure::Work(format!("{}: {e}", path.display())))?;
    write_whole(path, text.as_bytes())
}

/// The motion as columns.
fn columns(answer: &Answer) -> String {
    let mut text = String::from("time [s],acceleration [g]\n");
    for (k, a) in answer.acceleration.iter().enumerate() {
        let _ = writeln!(text, "{:.6},{:.9}", k as f64 * answer.dt, a / STANDARD_GRAVITY);
    }
    text
}
