//! A recording's file, whatever its form, which its first bytes say: text, MATLAB, HDF5, TDMS, RPC III or miniSEED.

use super::binary;
use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, Table};
use super::{csv, mat};
use crate::files::layout::Stated;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Reads the wanted columns.
pub fn read(path: &Path, wanted: &[&str]) -> Result<Table, RecordingError> {
    read_as(path, wanted, &Stated::default())
}

/// The same of a text whose layout is stated in part.
pub fn read_as(path: &Path, wanted: &[&str], stated: &Stated) -> Result<Table, RecordingError> {
    let (file, form) = open(path)?;
    match form {
        Form::Text => csv::read(file, path, wanted, stated),
        Form::Matlab => mat::read(file, path, wanted),
        Form::Binary(form) => binary::read(file, form, path, wanted),
    }
}

/// Reads the names of all columns.
pub fn headings(path: &Path) -> Result<Vec<Heading>, RecordingError> {
    headings_as(path, &Stated::default())
}

/// The same of a text whose layout is stated in part.
pub fn headings_as(path: &Path, stated: &Stated) -> Result<Vec<Heading>, RecordingError> {
    let (file, form) = open(path)?;
    match form {
        Form::Text => csv::headings(file, path, stated),
        Form::Matlab => mat::headings(file, path),
        Form::Binary(form) => binary::headings(file, form, path),
    }
}

/// True for a form of other software's, whose first bytes say that it is one: everything but plain columns of text.
pub fn is_of_other_software(path: &Path) -> bool {
    let begins = |start: &mut Vec<u8>| File::open(path).and_then(|file| file.take(32).read_to_end(start));
    let mut start = Vec::new();
    // A pipe is read once.
    let plain = std::fs::metadata(path).is_ok_and(|there| there.is_file());
    plain && begins(&mut start).is_ok() && (form(path, &start) != Form::Text || csv::is_special(&start))
}

/// What a file's first bytes say it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Text,
    Matlab,
    Binary(binary::Form),
}

/// The file and its form.
fn open(path: &Path) -> Result<(File, Form), RecordingError> {
    let refuse = |e| Place::file(path).refuse(Problem::Unreadable(e));
    let mut file = File::open(path).map_err(refuse)?;
    let mut start = Vec::new();
    (&mut file).take(32).read_to_end(&mut start).map_err(refuse)?;
    file.seek(SeekFrom::Start(0)).map_err(refuse)?;
    let form = form(path, &start);
    Ok((file, form))
}

fn form(path: &Path, start: &[u8]) -> Form {
    let named = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat"));
    let form = binary::Form::of(start).map_or(Form::Text, Form::Binary);
    let matlab = form == Form::Text && (named || start.starts_with(b"MATLAB"));
    if matlab { Form::Matlab } else { form }
}
