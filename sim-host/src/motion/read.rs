//! Reading ground-motion records: one file a format, the format told by the content.
//!
//! Nothing is guessed silently. Sample counts, units and peaks that a header states are checked against the data, and a
//! contradiction is an error that quotes both. A file of more than [`SIZE_LIMIT`] bytes is refused before it is read.

mod archive;
mod columns;
mod cosmos;
mod csmip;
mod error;
mod geonet;
mod knet;
mod peer;
mod recorded;
mod text;

pub(crate) use columns::STEPS;
pub use error::{LEAST_SAMPLES, Problem, ReadError};
pub use text::SIZE_LIMIT;

use super::{AccelerationUnit, Fact, Format, Record, STANDARD_GRAVITY};
use crate::files::layout::Stated;
use std::path::Path;
use text::{Block, Source};

/// Which component of a file is wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Channel {
    /// The first; columns of text must then have but one.
    #[default]
    First,
    /// By its place, from 1.
    Number(usize),
    /// By a part of its name, whatever the case: `up`, `N28W`, `90 deg`.
    Name(String),
    /// Columns of text only: the rows are one series, wrapped.
    Wrapped,
}

impl std::str::FromStr for Channel {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(match text.trim() {
            "" => Self::First,
            "all" | "wrapped" => Self::Wrapped,
            t => t.parse().map_or_else(|_| Self::Name(t.to_owned()), Self::Number),
        })
    }
}

impl std::fmt::Display for Channel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::First => f.write_str("the first"),
            Self::Number(n) => write!(f, "{n}"),
            Self::Name(name) => f.write_str(name),
            Self::Wrapped => f.write_str("all"),
        }
    }
}

/// What the person adds to what the file says.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Sampling interval, s: needed where the file has none, checked where it has one.
    pub dt: Option<f64>,
    /// Unit of the values: needed where the file states none, checked where it does.
    pub unit: Option<AccelerationUnit>,
    /// Which component.
    pub channel: Channel,
    /// How columns of text are laid out, as far as it is not to be found.
    pub text: Stated,
}

/// Reads one component of a ground-motion record; of a zipped folder the file that `options.channel` names, of a recording (TDMS, HDF5,
/// MATLAB, RPC III, miniSEED, LabVIEW, MTS 793) the channel.
pub fn record(path: &Path, options: &Options) -> Result<Record, ReadError> {
    let zipped = archive::entry(path, &options.channel)?;
    let record = match zipped {
        Some(archive::Entry { name, bytes, channel }) => {
            let options = Options { channel, ..options.clone() };
            let mut record = parse(&Source::from_bytes(&name, bytes)?, &options, false)?;
            let value = format!("{} of the zipped folder", name.display());
            record.facts.push(Fact { key: "layout", value, line: 1 });
            record
        }
        None => match recorded::read(path, options)? {
            Some(record) => record,
            None => parse(&Source::open(path)?, options, false)?,
        },
    };
    let samples = record.acceleration.len();
    if samples < LEAST_SAMPLES {
        let problem = Box::new(Problem::TooShort { samples });
        return Err(ReadError { file: path.to_owned(), line: None, column: None, problem });
    }
    Ok(record)
}

/// Reads a record from bytes already at hand; `name` stands for the file in messages.
pub fn record_from_bytes(name: &Path, bytes: Vec<u8>, options: &Options) -> Result<Record, ReadError> {
    parse(&Source::from_bytes(name, bytes)?, options, false)
}

/// Reads a drive in the form of a record.
pub(super) fn drive_from_bytes(name: &Path, bytes: Vec<u8>) -> Result<Record, ReadError> {
    parse(&Source::from_bytes(name, bytes)?, &Options::default(), true)
}

fn parse(source: &Source, options: &Options, drive: bool) -> Result<Record, ReadError> {
    let lines = source.lines()?;
    let block = Block::whole(source, &lines);
    if !drive && block.lines.first().is_some_and(|line| super::drive::form::is_first_line(line)) {
        return Err(block.at(0, Problem::Drive));
    }
    let format = detect(&block, options)?;
    if format != Format::Columns && !options.text.is_empty() {
        let found = format!("{format} has a layout of its own");
        let stated = "--skip-lines, --delimiter, --decimal and --units describe columns of text".to_owned();
        return Err(block.contradiction(0, "layout", (stated, found), "leave them out"));
    }
    let mut record = match format {
        Format::Peer => peer::read(&block),
        Format::Csmip => csmip::read(&block, &options.channel),
        Format::Cosmos => cosmos::read(&block, &options.channel),
        Format::GeoNet => geonet::read(&block, &options.channel),
        Format::KNet => knet::read(&block),
        Format::Columns | Format::Generated => columns::read(&block, options),
    }?;
    if matches!(record.format, Format::Peer | Format::KNet) {
        csmip::select(&block, std::slice::from_ref(&record.component), &options.channel)?;
    }
    agree(&block, &record, options)?;
    if let Some(note) = source.encoding.note() {
        record.facts.push(Fact { key: "layout", value: note.to_owned(), line: 1 });
    }
    Ok(record)
}

/// Tells the format by the content.
fn detect(block: &Block, options: &Options) -> Result<Format, ReadError> {
    let head: Vec<String> = block.lines.iter().take(40).map(|l| l.to_lowercase()).collect();
    let first = head.first().map_or("", String::as_str);
    let any = |needle: &str| head.iter().any(|l| l.contains(needle));
    if first.contains("(format v") {
        return Ok(Format::Cosmos);
    }
    if first.contains("accelerogram") {
        let format = if any("number of points") { Format::GeoNet } else { Format::Csmip };
        return if first.trim_start().starts_with("corrected") {
            Ok(format)
        } else {
            Err(block
                .at(0, Problem::WrongKind { found: first.trim().to_owned(), expected: "a corrected accelerogram" }))
        };
    }
    if first.trim_start().starts_with("origin time") {
        return Ok(Format::KNet);
    }
    if head.iter().take(5).any(|l| l.contains("npts") || l.contains("time series in units of")) {
        return Ok(Format::Peer);
    }
    if !options.text.is_empty() || block.lines.iter().take(200).any(|l| columns::is_row(l)) {
        return Ok(Format::Columns);
    }
    Err(block.at(0, Problem::UnknownFormat { first: text::excerpt(block.lines.first().copied().unwrap_or("")) }))
}

/// The largest acceleration that is believed, m/s²: beyond it a unit is wrong.
const CREDIBLE: f64 = 1000.0 * STANDARD_GRAVITY;

/// True for an acceleration (m/s2) that a table or an earthquake may have.
fn credible(acceleration: f64) -> bool {
    acceleration.abs() <= CREDIBLE
}

/// One that none has.
fn incredible(found: f64) -> Problem {
    let (what, expected) = ("an acceleration in m/s2", "at most 1000 g, 9807 m/s2, in magnitude");
    Problem::OutOfRange { what, found, unit: "", expected }
}

/// Refuses an interval or a unit that the person states and the file contradicts, and a record of one sample or of
/// accelerations beyond belief, or of one value from end to end.
fn agree(block: &Block, record: &Record, options: &Options) -> Result<(), ReadError> {
    if let Some(dt) = options.dt.filter(|dt| ((dt - record.dt) / record.dt).abs() > 1e-3) {
        return Err(block.contradiction(
            0,
            "sampling interval",
            (format!("{dt} s (--dt)"), format!("{} s in the file", record.dt)),
            "leave --dt out, or correct it",
        ));
    }
    let stated = record.fact("unit").and_then(|u| u.parse::<AccelerationUnit>().ok());
    if let (Some(asked), Some(stated)) = (options.unit, stated)
        && asked != stated
    {
        return Err(block.contradiction(
            0,
            "unit",
            (format!("{asked} (--unit)"), format!("{stated} in the file")),
            "leave --unit out, or correct it",
        ));
    }
    if let Some(&found) = record.acceleration.iter().find(|a| !credible(**a)) {
        return Err(block.at(0, incredible(found)));
    }
    let samples = record.acceleration.len();
    if samples < 2 {
        return Err(block.at(0, Problem::TooShort { samples }));
    }
    let value = record.acceleration[0];
    if record.acceleration.iter().all(|a| *a == value) {
        return Err(block.at(0, Problem::Constant { samples, value }));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
