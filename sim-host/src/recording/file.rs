//! A recording's file, whatever its form: text, or MATLAB v5.

use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, Table};
use super::{csv, mat};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Reads the wanted columns.
pub fn read(path: &Path, wanted: &[&str]) -> Result<Table, RecordingError> {
    let (file, matlab) = open(path)?;
    if matlab { mat::read(file, path, wanted) } else { csv::read(file, path, wanted) }
}

/// Reads the names of all columns.
pub fn headings(path: &Path) -> Result<Vec<Heading>, RecordingError> {
    let (file, matlab) = open(path)?;
    if matlab { mat::headings(file, path) } else { csv::headings(file, path) }
}

/// The file, and whether it is MATLAB's, which its first bytes say.
fn open(path: &Path) -> Result<(File, bool), RecordingError> {
    let refuse = |e| Place::file(path).refuse(Problem::Unreadable(e));
    let mut file = File::open(path).map_err(refuse)?;
    let mut start = Vec::new();
    (&mut file).take(6).read_to_end(&mut start).map_err(refuse)?;
    file.seek(SeekFrom::Start(0)).map_err(refuse)?;
    let named = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat"));
    Ok((file, named || start == b"MATLAB"))
}
