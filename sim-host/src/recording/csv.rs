//! Recordings as text: one header line, then one row a sample; comma, semicolon, tab or blanks between the fields.
//!
//! Only the wanted columns are kept, so memory is bounded by [`MAX_VALUES`] and the longest line.

use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, MAX_BYTES, MAX_VALUES, Table, locate};
use csv::ByteRecord;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// Longest line that is read, bytes.
const MAX_LINE: usize = 1 << 20;

/// Reads the headings alone.
pub fn headings(input: impl Read, path: &Path) -> Result<Vec<Heading>, RecordingError> {
    let mut input = BufReader::new(input);
    let (_, line) = header_line(&mut input, path)?;
    Ok(split_header(&line, delimiter(&line)))
}

/// Reads the wanted columns of `input`; `path` is for messages.
pub fn read(input: impl Read, path: &Path, wanted: &[&str]) -> Result<Table, RecordingError> {
    let mut input = BufReader::new(input);
    let (line_number, header) = header_line(&mut input, path)?;
    let delimiter = delimiter(&header);
    let headings = split_header(&header, delimiter);
    refuse_numbers(&headings, path, line_number)?;
    let places = locate(&headings, wanted, path)?;
    let columns = rows(input, path, delimiter, &headings, &places, line_number)?;
    Ok(Table { headings: places.iter().map(|&i| headings[i].clone()).collect(), columns })
}

/// The first line that is not blank, with its number.
fn header_line(input: &mut impl BufRead, path: &Path) -> Result<(usize, String), RecordingError> {
    let mut number = 0;
    loop {
        let mut line = Vec::new();
        let read = next_line(input, &mut line, path)?;
        if read > MAX_LINE {
            return Err(Place::file(path).refuse(Problem::TooLarge { what: "bytes in one line", limit: MAX_LINE }));
        }
        if read == 0 {
            let problem = "is empty; a header line that names the columns is expected".to_owned();
            return Err(Place::file(path).refuse(Problem::Malformed(problem)));
        }
        if line.contains(&0) {
            let problem = "is UTF-16 or no text at all; save it as text in UTF-8".to_owned();
            return Err(Place::file(path).refuse(Problem::Malformed(problem)));
        }
        number += 1;
        let text = String::from_utf8(line).unwrap_or_else(|e| latin1(&e.into_bytes()));
        let text = text.trim_start_matches('\u{feff}');
        if !text.trim().is_empty() {
            return Ok((number, text.trim_end_matches(['\r', '\n']).to_owned()));
        }
    }
}

/// Older data loggers write superscripts and the micro sign in Latin-1.
fn latin1(bytes: &[u8]) -> String {
    bytes.iter().map(|&b| char::from(b)).collect()
}

/// The separator: the first of tab, semicolon and comma that the header has, else blanks.
fn delimiter(header: &str) -> u8 {
    [b'\t', b';', b','].into_iter().find(|&d| header.as_bytes().contains(&d)).unwrap_or(b' ')
}

fn split_header(line: &str, delimiter: u8) -> Vec<Heading> {
    let mut reader =
        csv::ReaderBuilder::new().delimiter(delimiter).has_headers(false).flexible(true).from_reader(line.as_bytes());
    let mut record = ByteRecord::new();
    // A text in memory cannot fail to be read.
    let _ = reader.read_byte_record(&mut record);
    let fields = record.iter().map(|f| String::from_utf8_lossy(f).trim().to_owned());
    if delimiter != b' ' {
        return fields.map(|f| Heading::parse(&f)).collect();
    }
    let mut names: Vec<String> = Vec::new();
    for field in fields.filter(|f| !f.is_empty()) {
        match names.last_mut() {
            // `time [s]` with a blank between is one heading.
            Some(name) if field.starts_with('[') => name.extend([" ", &field]),
            _ => names.push(field),
        }
    }
    names.iter().map(|n| Heading::parse(n)).collect()
}

fn refuse_numbers(headings: &[Heading], path: &Path, line: usize) -> Result<(), RecordingError> {
    if headings.iter().all(|h| h.text.is_empty() || h.text.parse::<f64>().is_ok()) {
        let problem = "holds numbers; the first line must be a header that names the columns".to_owned();
        return Err(Place::line(path, line).refuse(Problem::Malformed(problem)));
    }
    Ok(())
}

fn rows(
    mut input: impl BufRead,
    path: &Path,
    delimiter: u8,
    headings: &[Heading],
    places: &[usize],
    header_lines: usize,
) -> Result<Vec<Vec<f64>>, RecordingError> {
    let mut columns = vec![Vec::new(); places.len()];
    let (mut text, mut line, mut bytes, mut kept) = (Vec::new(), header_lines, 0, 0);
    let too_large = |line, what, limit| Err(Place::line(path, line).refuse(Problem::TooLarge { what, limit }));
    loop {
        let read = next_line(&mut input, &mut text, path)?;
        if read == 0 {
            return Ok(columns);
        }
        (line, bytes) = (line + 1, bytes + read);
        if read > MAX_LINE {
            return too_large(line, "bytes in one line", MAX_LINE);
        }
        if bytes > MAX_BYTES {
            return too_large(line, "bytes", MAX_BYTES);
        }
        let fields = fields(&text, delimiter);
        if fields.iter().all(|f| f.is_empty()) {
            continue;
        }
        check_width(&fields, headings, path, line)?;
        for (column, &place) in columns.iter_mut().zip(places) {
            let refuse = |p| Place::line(path, line).column(&headings[place].name).refuse(p);
            // A heading without a name, at the very end, may have no field.
            column.push(number(fields.get(place).copied().unwrap_or_default()).map_err(refuse)?);
        }
        kept += places.len();
        if kept > MAX_VALUES {
            return too_large(line, "values", MAX_VALUES);
        }
    }
}

/// Reads one line of at most one byte more than [`MAX_LINE`]; gives the bytes read, none at the end.
fn next_line(input: &mut impl BufRead, text: &mut Vec<u8>, path: &Path) -> Result<usize, RecordingError> {
    text.clear();
    input
        .take(MAX_LINE as u64 + 1)
        .read_until(b'\n', text)
        .map_err(|e| Place::file(path).refuse(Problem::Unreadable(e)))
}

/// The row's fields, trimmed; where blanks separate, any number of them does.
fn fields(text: &[u8], delimiter: u8) -> Vec<&[u8]> {
    if delimiter == b' ' {
        text.split(u8::is_ascii_whitespace).filter(|f| !f.is_empty()).collect()
    } else {
        text.split(|&b| b == delimiter).map(<[u8]>::trim_ascii).collect()
    }
}

/// A row must have as many fields as the header; a separator at the very end of either is forgiven.
fn check_width(fields: &[&[u8]], headings: &[Heading], path: &Path, line: usize) -> Result<(), RecordingError> {
    let named = headings.len() - usize::from(headings.last().is_some_and(|h| h.text.is_empty()));
    let filled = fields.len() - usize::from(fields.last().is_some_and(|f| f.is_empty()) && fields.len() > named);
    if filled == named || fields.len() == headings.len() {
        return Ok(());
    }
    Err(Place::line(path, line).refuse(Problem::Ragged { expected: named, found: filled }))
}

/// A number, or NaN for a dropped sample.
fn number(field: &[u8]) -> Result<f64, Problem> {
    let text = std::str::from_utf8(field).map(|t| t.trim_matches('"').trim());
    let parsed = text.ok().and_then(|t| t.parse::<f64>().ok());
    match parsed {
        Some(value) if !value.is_infinite() => Ok(value),
        _ => {
            let shown: String = String::from_utf8_lossy(field).chars().take(40).collect();
            let hint = if shown.is_empty() {
                "; write NaN for a sample that was dropped"
            } else if shown.replacen(',', ".", 1).parse::<f64>().is_ok() {
                "; the decimal sign must be a point"
            } else if parsed.is_some() {
                "; an infinite value cannot be used, write NaN for a sample that was dropped"
            } else {
                ""
            };
            Err(Problem::NotANumber { found: shown, hint })
        }
    }
}

#[cfg(test)]
mod tests;
