//! Recordings in the binary forms of other software: each gives named columns, and says what was assumed.

use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, MAX_BYTES, Table, locate};
use std::io::Read;
use std::path::Path;

pub(crate) mod bytes;
pub(crate) mod hdf5;
pub(crate) mod mseed;
pub(crate) mod rpc;
pub(crate) mod tdms;

/// A binary form that a file's first bytes name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// MTS RPC III.
    Rpc,
    /// NI TDMS.
    Tdms,
    /// HDF5, MATLAB 7.3 included.
    Hdf5,
    /// miniSEED 2 and 3.
    MiniSeed,
}

impl Form {
    /// The form of a file that begins like this; none for text and for MATLAB before 7.3.
    pub(crate) fn of(start: &[u8]) -> Option<Self> {
        if start.starts_with(b"TDSm") {
            Some(Self::Tdms)
        } else if start.starts_with(b"\x89HDF\r\n\x1a\n") || start.starts_with(b"MATLAB 7.3") {
            Some(Self::Hdf5)
        } else if start.starts_with(b"FORMAT\0") {
            Some(Self::Rpc)
        } else if mseed::is_start(start) {
            Some(Self::MiniSeed)
        } else {
            None
        }
    }
}

/// A column with its heading.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name and unit.
    pub heading: Heading,
    /// Its values in that unit.
    pub values: Vec<f64>,
}

impl Column {
    /// A column of that name, with a unit where there is one.
    pub fn new(name: &str, unit: &str, values: Vec<f64>) -> Self {
        let unit = Some(unit.trim().to_owned()).filter(|u| !u.is_empty());
        Self { heading: Heading { text: name.to_owned(), name: name.to_owned(), unit }, values }
    }
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Content {
    /// Its columns.
    pub columns: Vec<Column>,
    /// What was assumed to read them.
    pub notes: Vec<String>,
}

/// Largest file of these forms that is read, bytes: it is held whole.
const LARGEST: usize = if MAX_BYTES < 1 << 29 { MAX_BYTES } else { 1 << 29 };

fn content(input: impl Read, form: Form, path: &Path) -> Result<Content, RecordingError> {
    let refuse = |p| Place::file(path).refuse(p);
    let mut bytes = Vec::new();
    let limit = LARGEST as u64 + 1;
    input.take(limit).read_to_end(&mut bytes).map_err(|e| refuse(Problem::Unreadable(e)))?;
    if bytes.len() > LARGEST {
        return Err(refuse(Problem::TooLarge { what: "bytes", limit: LARGEST }));
    }
    let parsed = match form {
        Form::Rpc => rpc::parse(&bytes),
        Form::Tdms => tdms::parse(&bytes),
        Form::Hdf5 => hdf5::parse(bytes),
        Form::MiniSeed => mseed::parse(&bytes),
    };
    parsed.map_err(|flaw| refuse(Problem::Malformed(flaw)))
}

/// Reads the names of all columns.
pub(crate) fn headings(input: impl Read, form: Form, path: &Path) -> Result<Vec<Heading>, RecordingError> {
    Ok(content(input, form, path)?.columns.into_iter().map(|c| c.heading).collect())
}

/// Reads the wanted columns.
pub(crate) fn read(input: impl Read, form: Form, path: &Path, wanted: &[&str]) -> Result<Table, RecordingError> {
    let Content { columns, notes } = content(input, form, path)?;
    pick(columns, notes, path, wanted)
}

/// The wanted columns of a file, which must be of one length; infinite values become gaps.
pub(super) fn pick(
    columns: Vec<Column>,
    notes: Vec<String>,
    path: &Path,
    wanted: &[&str],
) -> Result<Table, RecordingError> {
    let headings: Vec<Heading> = columns.iter().map(|c| c.heading.clone()).collect();
    let places =
        locate(&headings, wanted, path).map_err(|e| RecordingError { place: Place { line: None, ..e.place }, ..e })?;
    let chosen: Vec<&Column> = places.iter().map(|&i| &columns[i]).collect();
    let expected = chosen.first().map_or(0, |c| c.values.len());
    if let Some(odd) = chosen.iter().find(|c| c.values.len() != expected) {
        let problem = Problem::LengthsDiffer { expected, found: odd.values.len() };
        return Err(Place::file(path).column(&odd.heading.name).refuse(problem));
    }
    Ok(Table {
        headings: chosen.iter().map(|c| c.heading.clone()).collect(),
        columns: chosen
            .iter()
            .map(|c| c.values.iter().map(|v| if v.is_infinite() { f64::NAN } else { *v }).collect())
            .collect(),
        notes,
    })
}
