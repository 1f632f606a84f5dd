//! A component of a recording in a form of other software's: TDMS, HDF5, MATLAB, RPC III, miniSEED, LabVIEW and MTS 793 texts.
//!
//! The column is named, the interval comes from the column of times or from `--dt`, the unit from the file or from `--unit`; nothing is
//! guessed where several would do.

use super::super::drive::form::OPERATION;
use super::columns::{mean_step, uneven_step, usual_step};
use super::csmip::select;
use super::error::{Problem, ReadError, excerpt, listed};
use super::text::{Block, Source};
use super::{AccelerationUnit, Channel, Fact, Format, Options, Record};
use crate::recording::RecordingError;
use crate::recording::file;
use crate::recording::table::{Heading, Table};
use crate::recording::unit::{Dimension, Unit};
use std::path::Path;

/// What columns of times are called.
const TIMES: [&str; 7] = ["time", "t", "x_value", "zeit", "laufzeit", "timestamp", "elapsed time"];

/// The component of such a file that is asked for; none where the file is of another form.
pub(super) fn read(path: &Path, options: &Options) -> Result<Option<Record>, ReadError> {
    if !file::is_of_other_software(path) {
        return Ok(None);
    }
    let source = Source::named(path);
    let lines = source.lines()?;
    let block = Block::whole(&source, &lines);
    let record = component(path, &block, options).and_then(|record| {
        super::agree(&block, &record, options)?;
        Ok(record)
    });
    // There are no lines to point at.
    record.map(Some).map_err(|e| ReadError { line: None, column: None, ..e })
}

fn component(path: &Path, block: &Block, options: &Options) -> Result<Record, ReadError> {
    let headings = file::headings_as(path, &options.text).map_err(|e| refused(path, &e))?;
    let others: Vec<&Heading> = headings.iter().filter(|h| !h.text.is_empty() && !is_time(h)).collect();
    let labels: Vec<String> = others.iter().map(|h| h.text.clone()).collect();
    let chosen = match (&options.channel, others.as_slice()) {
        (Channel::First, [only]) => only,
        (Channel::First, _) => return Err(block.at(0, Problem::SeveralColumns { available: listed(&labels) })),
        (channel, _) => others[select(block, &labels, channel)?],
    };
    let own = |h: &&Heading| h.name.ends_with(&format!(" of {}", chosen.name));
    let time = headings.iter().filter(|h| is_time(h)).find(own).or_else(|| headings.iter().find(|h| is_time(h)));
    let wanted: Vec<&str> = std::iter::once(chosen).chain(time).map(|h| h.text.as_str()).collect();
    let table = file::read_as(path, &wanted, &options.text).map_err(|e| refused(path, &e))?;
    if table.notes.iter().any(|note| note.contains(OPERATION)) {
        return Err(block.at(0, Problem::Drive));
    }
    let unit = unit(block, chosen, options)?;
    let dt = interval(block, &table, options)?;
    let values = &table.columns[0];
    if let Some(row) = values.iter().position(|v| !v.is_finite()) {
        let found = format!("{} of `{}`, sample {}", values[row], excerpt(&chosen.text), row + 1);
        return Err(block.at(0, Problem::NotFinite { found, expected: "a number" }));
    }
    let mut facts = vec![Fact { key: "unit", value: unit.symbol().to_owned(), line: 1 }];
    facts.extend(table.notes.iter().map(|value| Fact { key: "layout", value: value.clone(), line: 1 }));
    let acceleration = values.iter().map(|a| a * unit.in_si()).collect();
    Ok(Record { name: block.name(), dt, acceleration, component: chosen.name.clone(), format: Format::Columns, facts })
}

/// True for a column of times, by its unit or its name.
fn is_time(heading: &Heading) -> bool {
    let name = heading.name.to_lowercase();
    let stated = heading.unit.as_deref().and_then(Unit::in_header);
    let called = TIMES.iter().any(|time| name == *time || name.starts_with(&format!("{time} of ")));
    stated.map_or(called, |unit| unit.dimension == Dimension::Time)
}

/// The unit that the file states, else the person.
fn unit(block: &Block, chosen: &Heading, options: &Options) -> Result<AccelerationUnit, ReadError> {
    let Some(text) = &chosen.unit else {
        let remedy = "the file states none for this channel; give it with --unit (m/s2, cm/s2, mm/s2 or g)";
        return options.unit.ok_or_else(|| block.missing("the unit of acceleration", remedy));
    };
    text.parse().map_err(|_| block.at(0, Problem::Unit { found: excerpt(text) }))
}

/// The interval of the column of times, s, which must rise evenly; else what the person states.
fn interval(block: &Block, table: &Table, options: &Options) -> Result<f64, ReadError> {
    let Some(times) = table.columns.get(1) else {
        let remedy = "the file has no column of times; give it with --dt, in seconds";
        return options.dt.ok_or_else(|| block.missing("the sampling interval", remedy));
    };
    let stated = table.headings.get(1).and_then(|h| h.unit.as_deref()).and_then(Unit::in_header);
    let size = stated.map_or(1.0, |unit| unit.factor);
    if let Some(i) = uneven_step(times) {
        let pair = (
            format!("the usual step is {} s", size * usual_step(times)),
            format!("sample {} comes {} s after the last", i + 2, size * (times[i + 1] - times[i])),
        );
        return Err(block.contradiction(0, "time", pair, "resample the record to even steps"));
    }
    let dt = (mean_step(times) * size * 1e11).round() / 1e11;
    super::peer::interval_in_range(block, 0, dt)?;
    Ok(dt)
}

/// What the reader of recordings refuses, as a record that is refused.
fn refused(path: &Path, error: &RecordingError) -> ReadError {
    let column = error.place.column.as_ref().map_or_else(String::new, |name| format!("`{}`: ", excerpt(name)));
    let line = error.place.line.map_or_else(String::new, |line| format!("line {line}: "));
    let problem = Box::new(Problem::Layout { reason: format!("{line}{column}{}", error.problem) });
    ReadError { file: path.to_owned(), line: None, column: None, problem }
}
