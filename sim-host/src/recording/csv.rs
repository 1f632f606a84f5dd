//! Recordings as text: names on one line, then one row a sample, laid out as [`crate::files::layout`] finds it.
//!
//! Preamble, a row of units, decimal comma, semicolon and UTF-16 are found and said ([`Table::notes`]); what can be read in two
//! ways is refused. Only the wanted columns are kept, so memory is bounded by [`MAX_VALUES`] and the longest line.

use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, MAX_BYTES, MAX_VALUES, Table, locate};
use crate::files::layout::{self, Encoding, Layout, Stated, decode};
use lines::{Lines, MAX_LINE};
use special::Clock;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

mod lines;
mod special;

/// Largest UTF-16 text that is read, bytes: it is held whole.
const MAX_UTF16: u64 = 1 << 28;

/// Largest magnitude that is treated as a measurement, in any unit.
const CREDIBLE: f64 = 1e15;

/// True for the first bytes of a text that says by its first lines how it is written.
pub(crate) fn is_special(start: &[u8]) -> bool {
    special::is_start(start)
}

/// Reads the headings alone.
pub fn headings(input: impl Read, path: &Path, stated: &Stated) -> Result<Vec<Heading>, RecordingError> {
    Ok(open(input, path, stated)?.headings)
}

/// Reads the wanted columns of `input`; `path` is for messages.
pub fn read(input: impl Read, path: &Path, wanted: &[&str], stated: &Stated) -> Result<Table, RecordingError> {
    let mut text = open(input, path, stated)?;
    let line = text.layout.header.map_or(1, |i| text.first_line + i);
    let at_header = |e: RecordingError| RecordingError { place: Place { line: Some(line), ..e.place }, ..e };
    let places = locate(&text.headings, wanted, path).map_err(at_header)?;
    let columns = text.rows(path, &places)?;
    Ok(Table { headings: places.iter().map(|&i| text.headings[i].clone()).collect(), columns, notes: text.notes })
}

/// A text whose layout is known.
struct Text<'a> {
    lines: Lines<'a>,
    /// The first lines, read to find the layout.
    head: Vec<String>,
    /// The number of the first of them, from 1.
    first_line: usize,
    layout: Layout,
    headings: Vec<Heading>,
    notes: Vec<String>,
    /// A last column of remarks that rows may have and the header names, which is passed over.
    remarks: bool,
    /// Where another block of the same file begins, for forms that have several.
    block_mark: Option<String>,
    /// The times that an empty first column stands for.
    clock: Option<Clock>,
}

/// Reads as much as the layout takes to be found.
fn open<'a>(input: impl Read + 'a, path: &Path, stated: &Stated) -> Result<Text<'a>, RecordingError> {
    let (mut lines, encoding) = decoded(input, path)?;
    let mut head = Vec::new();
    let mut bytes = 0;
    while head.len() < 500 + stated.skip_lines.unwrap_or(0) && bytes < 4 * MAX_LINE {
        let Some(line) = lines.next(path)? else { break };
        bytes += line.len();
        head.push(line);
    }
    if head.iter().all(|line| line.trim().is_empty()) {
        let problem = "is empty; a header line that names the columns is expected".to_owned();
        return Err(Place::file(path).refuse(Problem::Malformed(problem)));
    }
    let special = special::of(&head).unwrap_or_default();
    if let Some((line, names)) = &special.names {
        head[*line].clone_from(names);
    }
    let stated = special.stated.under(stated);
    let layout = layout::find(&special.without_remarks(&head), &stated).map_err(|e| {
        let place = e.line.map_or_else(|| Place::file(path), |i| Place::line(path, i + 1));
        place.refuse(Problem::Malformed(e.reason))
    })?;
    let headings = headings_of(&layout, path)?;
    let notes = special.notes.into_iter().chain(encoding.note().map(str::to_owned)).chain(layout.notes()).collect();
    let (remarks, block_mark, clock) = (special.remarks, special.block_mark, special.clock);
    Ok(Text { lines, head, first_line: 1, layout, headings, notes, remarks, block_mark, clock })
}

/// The lines of a text in its encoding.
fn decoded<'a>(input: impl Read + 'a, path: &Path) -> Result<(Lines<'a>, Encoding), RecordingError> {
    let mut input: BufReader<Box<dyn Read + 'a>> = BufReader::with_capacity(1 << 16, Box::new(input));
    let refuse = |e| Place::file(path).refuse(Problem::Unreadable(e));
    let start = input.fill_buf().map_err(refuse)?;
    let whole = &start[..start.len().min(256)];
    let encoding = match Encoding::of(whole) {
        // A character may be cut where the first bytes end: line by line it is known.
        Ok(Encoding::Windows1252) => Encoding::Utf8,
        Ok(encoding) => encoding,
        Err(reason) => return Err(Place::file(path).refuse(Problem::Malformed(reason))),
    };
    if encoding == Encoding::Utf8 {
        return Ok((Lines::new(Box::new(input)), encoding));
    }
    let mut bytes = Vec::new();
    let read = input.take(MAX_UTF16 + 1).read_to_end(&mut bytes).map_err(refuse)?;
    if read as u64 > MAX_UTF16 {
        let problem = Problem::TooLarge { what: "bytes of UTF-16; save it as UTF-8", limit: MAX_UTF16 as usize };
        return Err(Place::file(path).refuse(problem));
    }
    let text = decode(&bytes, encoding).into_owned();
    Ok((Lines::new(Box::new(Cursor::new(text.into_bytes()))), encoding))
}

/// The headings of a layout; a recording must name its columns.
fn headings_of(layout: &Layout, path: &Path) -> Result<Vec<Heading>, RecordingError> {
    if layout.header.is_none() {
        let problem = "holds numbers; the line above the first row must be a header that names the columns".to_owned();
        return Err(Place::line(path, layout.first_row + 1).refuse(Problem::Malformed(problem)));
    }
    let unit = |i: usize| layout.column_units.get(i).filter(|u| !u.is_empty());
    let parse = |(i, name): (usize, &String)| {
        let heading = Heading::parse(name);
        match unit(i) {
            Some(unit) if heading.unit.is_none() => {
                let unit = unit.trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim().to_owned();
                Heading { unit: Some(unit), ..heading }
            }
            _ => heading,
        }
    };
    Ok(layout.names.iter().enumerate().map(parse).collect())
}

impl Text<'_> {
    /// The values of the columns at `places`.
    fn rows(&mut self, path: &Path, places: &[usize]) -> Result<Vec<Vec<f64>>, RecordingError> {
        let mut columns = vec![Vec::new(); places.len()];
        let (mut bytes, mut kept) = (0, 0);
        let head = std::mem::take(&mut self.head);
        let mut early = head.into_iter().skip(self.layout.first_row);
        let mut number = self.first_line + self.layout.first_row - 1;
        loop {
            let line = match early.next() {
                Some(line) => line,
                None => match self.lines.next(path)? {
                    Some(line) => line,
                    None => return Ok(columns),
                },
            };
            (number, bytes) = (number + 1, bytes + line.len());
            let too_large = |what, limit| Err(Place::line(path, number).refuse(Problem::TooLarge { what, limit }));
            if bytes > MAX_BYTES {
                return too_large("bytes", MAX_BYTES);
            }
            if self.block_mark.as_ref().is_some_and(|mark| line.starts_with(mark.as_str())) {
                self.notes
                    .push(format!("the block that begins in line {number} has a header of its own and is left out"));
                return Ok(columns);
            }
            self.row(&line, (path, number), places, &mut columns)?;
            kept += places.len();
            if kept > MAX_VALUES {
                return too_large("values", MAX_VALUES);
            }
        }
    }

    /// One line's values, where it is a row.
    fn row(
        &self,
        line: &str,
        (path, number): (&Path, usize),
        places: &[usize],
        columns: &mut [Vec<f64>],
    ) -> Result<(), RecordingError> {
        let layout = &self.layout;
        let mut fields = layout.delimiter.split(line);
        if fields.iter().all(|f| f.is_empty()) || line.trim_start().starts_with(['#', '%', '!']) {
            return Ok(());
        }
        while fields.len() > layout.width
            && (self.remarks && fields.len() == layout.width + 1 || fields.last().is_some_and(|f| f.is_empty()))
        {
            fields.pop();
        }
        if fields.len() != layout.width {
            let problem = Problem::Ragged { expected: layout.width, found: fields.len() };
            return Err(Place::line(path, number).refuse(problem));
        }
        for (column, &place) in columns.iter_mut().zip(places) {
            let refuse = |p| Place::line(path, number).column(&self.headings[place].name).refuse(p);
            column.push(match self.clock {
                Some(clock) if place == 0 && fields[0].is_empty() => clock.at(column.len()),
                _ => value(fields[place], layout).map_err(refuse)?,
            });
        }
        Ok(())
    }
}

/// A number, or NaN for a dropped sample.
fn value(field: &str, layout: &Layout) -> Result<f64, Problem> {
    let field = field.trim_matches('"').trim();
    let parsed = layout.decimal.number(field);
    match parsed {
        Some(value) if value.is_nan() || value.abs() <= CREDIBLE => return Ok(value),
        _ => {}
    }
    let found: String = field.chars().take(40).collect();
    let hint = match parsed {
        Some(value) if value.is_infinite() => "infinite, which nothing measured",
        Some(_) => "beyond 1e15, which nothing measured",
        None if found.is_empty() => "; write NaN for a sample that was dropped",
        None if found.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            "; the decimal sign must be a point, as in the rows before"
        }
        None if found.parse::<f64>().is_ok() => "; the decimal sign must be a comma, as in the rows before",
        None => "",
    };
    match parsed {
        Some(_) => Err(Problem::NoMeasurement { found, hint }),
        None => Err(Problem::NotANumber { found, hint }),
    }
}

#[cfg(test)]
mod tests;
