//! Recordings as MATLAB v5 files.
use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, Table};
use std::io::Read;
use std::path::Path;

/// Reads the names of all variables.
pub fn headings(_input: impl Read, path: &Path) -> Result<Vec<Heading>, RecordingError> {
    Err(Place::file(path).refuse(Problem::Malformed("MATLAB files are not read yet".to_owned())))
}

/// Reads the wanted variables.
pub fn read(_input: impl Read, path: &Path, _wanted: &[&str]) -> Result<Table, RecordingError> {
    Err(Place::file(path).refuse(Problem::Malformed("MATLAB files are not read yet".to_owned())))
}
