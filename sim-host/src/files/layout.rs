//! How a text of columns is laid out: preamble, header, row of units, separator and decimal sign.
//!
//! Found from the first lines and checked against all of them; where two readings fit (`1,5` is one number or two), or
//! none does, the text is refused with the reason. Whoever asks may state any part ([`Stated`]). What is not plain is
//! told in words ([`Layout::notes`]), so that nothing is assumed silently.

mod encoding;
mod units;

pub(crate) use encoding::{Encoding, decode};
pub(crate) use units::is_unit;

use std::fmt;

/// What separates the fields of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delimiter {
    /// A tab.
    Tab,
    /// A semicolon.
    Semicolon,
    /// A comma.
    Comma,
    /// Any number of blanks or tabs.
    Blank,
}

impl Delimiter {
    /// In the order in which equal readings are preferred.
    const ALL: [Self; 4] = [Self::Tab, Self::Semicolon, Self::Comma, Self::Blank];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tab => "tab",
            Self::Semicolon => "semicolon",
            Self::Comma => "comma",
            Self::Blank => "blank",
        }
    }

    /// The fields of a line, trimmed.
    pub fn split(self, line: &str) -> Vec<&str> {
        match self {
            Self::Tab => line.split('\t').map(str::trim).collect(),
            Self::Semicolon => line.split(';').map(str::trim).collect(),
            Self::Comma => line.split(',').map(str::trim).collect(),
            Self::Blank => line.split_whitespace().collect(),
        }
    }
}

impl std::str::FromStr for Delimiter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "," => Ok(Self::Comma),
            ";" => Ok(Self::Semicolon),
            "\t" | "\\t" => Ok(Self::Tab),
            " " => Ok(Self::Blank),
            name => Self::ALL
                .into_iter()
                .find(|d| d.name() == name)
                .ok_or_else(|| format!("`{name}`: expected tab, semicolon, comma or blank")),
        }
    }
}

/// The sign between a number's whole part and its decimals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decimal {
    /// `1.5`
    Point,
    /// `1,5`
    Comma,
}

impl Decimal {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Comma => "comma",
        }
    }

    /// A number written with this sign; NaN and infinity are numbers here.
    pub fn number(self, field: &str) -> Option<f64> {
        match self {
            Self::Point => parse(field),
            // `0,` is a field and a separator, no number.
            Self::Comma if field.contains('.') || field.ends_with(',') => None,
            Self::Comma => parse(&field.replacen(',', ".", 1)),
        }
    }
}

/// A number as C or Fortran writes it.
fn parse(field: &str) -> Option<f64> {
    field.parse().ok().or_else(|| {
        let fortran = field.contains(['D', 'd']) && field.starts_with(|c: char| !c.is_alphabetic());
        fortran.then(|| field.replace(['D', 'd'], "E").parse().ok()).flatten()
    })
}

impl std::str::FromStr for Decimal {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "." | "point" => Ok(Self::Point),
            "," | "comma" => Ok(Self::Comma),
            other => Err(format!("`{other}`: expected point or comma")),
        }
    }
}

/// What the person states of a text's layout; the rest is found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Stated {
    /// Lines above the header, or above the first row where there is no header.
    pub skip_lines: Option<usize>,
    /// The separator.
    pub delimiter: Option<Delimiter>,
    /// The decimal sign.
    pub decimal: Option<Decimal>,
    /// The columns' units, in their order; empty for a column without.
    pub units: Option<Vec<String>>,
}

impl Stated {
    /// True where nothing is stated.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// What the file itself states, under what the person states.
    #[must_use]
    pub fn under(&self, person: &Self) -> Self {
        Self {
            skip_lines: person.skip_lines.or(self.skip_lines),
            delimiter: person.delimiter.or(self.delimiter),
            decimal: person.decimal.or(self.decimal),
            units: person.units.clone().or_else(|| self.units.clone()),
        }
    }
}

/// A text's layout.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// The separator.
    pub delimiter: Delimiter,
    /// The decimal sign.
    pub decimal: Decimal,
    /// The line with the names, from 0.
    pub header: Option<usize>,
    /// The line with the units alone, from 0.
    pub units: Option<usize>,
    /// The first row, from 0.
    pub first_row: usize,
    /// Columns.
    pub width: usize,
    /// Names of the columns; empty where there is no header.
    pub names: Vec<String>,
    /// Units from their own line, or as stated; empty where there are none.
    pub column_units: Vec<String>,
    /// Lines of text above header and rows.
    pub preamble: usize,
}

impl Layout {
    /// What is not plain about it, for the person to see.
    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.preamble > 0 {
            let names = if self.header.is_some() { "names" } else { "first row" };
            let line = self.header.unwrap_or(self.first_row) + 1;
            notes.push(format!("{} lines of preamble passed over; {names} in line {line}", self.preamble));
        }
        if let Some(line) = self.units {
            notes.push(format!("units in line {}", line + 1));
        }
        if self.decimal == Decimal::Comma {
            notes.push(format!("decimal comma, fields separated by {}", self.delimiter.name()));
        }
        notes
    }
}

/// Why no layout was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Unclear {
    /// The line it is about, from 0.
    pub line: Option<usize>,
    /// What is wrong and the remedy.
    pub reason: String,
}

impl fmt::Display for Unclear {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.reason)
    }
}

/// Lines that are looked at to find a layout.
const LOOKED_AT: usize = 400;

/// True for an empty line and for a comment.
fn passed_over(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with(['#', '%', '!'])
}

/// One reading of the text.
struct Reading {
    delimiter: Delimiter,
    decimal: Decimal,
    first_row: usize,
    width: usize,
    values: Vec<Vec<f64>>,
    /// A separator ends every row.
    trailing: bool,
}

/// Finds the layout of a text from its first lines.
pub(crate) fn find(lines: &[&str], stated: &Stated) -> Result<Layout, Unclear> {
    let lines = &lines[..lines.len().min(LOOKED_AT + stated.skip_lines.unwrap_or(0))];
    // Numbers throughout first; then rows with columns of text; then a single row.
    let passes = [(2, true), (2, false), (1, true), (1, false)];
    let found =
        passes.iter().map(|&(run, strict)| readings(lines, stated, run, strict)).find(|found| !found.is_empty());
    let mut readings = found.unwrap_or_default();
    // Rows that begin later under one reading are text under it.
    let first = readings.iter().map(|r| r.first_row).min().unwrap_or(0);
    readings.retain(|r| r.first_row == first);
    let complete: Vec<Layout> = readings.iter().map(|r| with_header(lines, r, stated)).collect();
    choose(lines, complete, &readings, stated)
}

/// Every way to read the text that differs from the others; `run` rows must follow each other, of numbers alone where `strict`.
fn readings(lines: &[&str], stated: &Stated, run: usize, strict: bool) -> Vec<Reading> {
    let mut readings: Vec<Reading> = Vec::new();
    let bits =
        |r: &Reading| r.values.iter().map(|row| row.iter().map(|v| v.to_bits()).collect()).collect::<Vec<Vec<u64>>>();
    for delimiter in Delimiter::ALL.into_iter().filter(|d| stated.delimiter.is_none_or(|s| s == *d)) {
        for decimal in [Decimal::Point, Decimal::Comma].into_iter().filter(|d| stated.decimal.is_none_or(|s| s == *d)) {
            // A comma is one of the two.
            let possible = (delimiter, decimal) != (Delimiter::Comma, Decimal::Comma);
            let skip = stated.skip_lines.unwrap_or(0);
            if possible && let Some(reading) = reading(lines, delimiter, decimal, skip, (run, strict)) {
                let same = |other: &Reading| other.first_row == reading.first_row && bits(other) == bits(&reading);
                if !readings.iter().any(same) {
                    readings.push(reading);
                }
            }
        }
    }
    readings
}

fn choose(lines: &[&str], found: Vec<Layout>, readings: &[Reading], stated: &Stated) -> Result<Layout, Unclear> {
    let Some(first) = found.first() else { return Err(none(lines, stated)) };
    if found.len() == 1 {
        return checked(lines, first.clone(), stated);
    }
    // A header settles it: as many names as columns under one reading only.
    let mut named = found.iter().filter(|layout| layout.header.is_some());
    if let (Some(only), None) = (named.next(), named.next()) {
        return checked(lines, only.clone(), stated);
    }
    let shown = readings.iter().map(|r| {
        let values: Vec<String> =
            r.values.first().map_or_else(Vec::new, |v| v.iter().take(4).map(f64::to_string).collect());
        format!("{} column(s) with decimal {} ({})", r.width, r.decimal.name(), values.join(" and "))
    });
    let reason = format!(
        "`{}` reads in {} ways: {}; say which with --decimal point or comma and --delimiter tab, semicolon, comma or blank",
        excerpt(lines.get(first.first_row).copied().unwrap_or_default()),
        readings.len(),
        shown.collect::<Vec<_>>().join(", or ")
    );
    Err(Unclear { line: Some(first.first_row), reason })
}

/// What is wrong with stated units of which the header says otherwise.
fn misstated(stated: &[String], names: &[String]) -> Option<String> {
    let both = stated.iter().zip(names).filter(|(unit, _)| !unit.is_empty());
    let mut said = both.filter_map(|(unit, name)| Some((unit, name, units::of_name(name)?)));
    let (unit, name, _) = said.find(|(unit, _, own)| !units::is_same(unit, own))?;
    Some(format!("--units says {unit} of the column `{name}`; leave its place empty, or correct the header"))
}

/// Refuses a header that names fewer or more columns than the rows have, and stated units of another number.
fn checked(lines: &[&str], layout: Layout, stated: &Stated) -> Result<Layout, Unclear> {
    if let Some(units) = stated.units.as_ref().filter(|units| units.len() != layout.width) {
        let reason = format!("--units names {} units, the rows have {} columns", units.len(), layout.width);
        return Err(Unclear { line: Some(layout.first_row), reason });
    }
    if let Some(reason) = stated.units.as_ref().and_then(|stated| misstated(stated, &layout.names)) {
        return Err(Unclear { line: layout.header, reason });
    }
    let above = (0..layout.first_row).rev().find(|&i| !passed_over(lines[i]));
    let Some(above) = above.filter(|_| layout.header.is_none()) else { return Ok(layout) };
    let names = header_fields(lines[above], header_delimiter(lines[above], layout.delimiter)).len();
    // Words with separators are a header; a sentence above rows of numbers is a title.
    if names > 1 && names != layout.width && layout.delimiter != Delimiter::Blank {
        let other = if layout.delimiter == Delimiter::Comma && 2 * names == layout.width {
            "; a decimal comma needs another separator than a comma: export with decimal points"
        } else {
            "; correct the header, or "
        };
        let how = if other.ends_with("or ") { HOW } else { "" };
        let reason = format!("the header names {names} columns, the rows below have {}{other}{how}", layout.width);
        return Err(Unclear { line: Some(above), reason });
    }
    Ok(layout)
}

/// Where a layout is stated that is not found.
const HOW: &str = "say how with --skip-lines, --delimiter and --decimal, in an experiment under [text]";

/// Why no reading fits.
fn none(lines: &[&str], stated: &Stated) -> Unclear {
    let by = if stated.is_empty() { "" } else { " as it is stated" };
    let line = lines.iter().position(|line| line.chars().any(|c| c.is_ascii_digit()));
    let reason = format!(
        "no rows of numbers are found{by}: expected columns of numbers, separated by tab, semicolon, comma or blanks; \
         {HOW}"
    );
    Unclear { line, reason }
}

/// The first run of rows of one width.
fn reading(
    lines: &[&str],
    delimiter: Delimiter,
    decimal: Decimal,
    skip: usize,
    (run, strict): (usize, bool),
) -> Option<Reading> {
    let rows: Vec<Option<Vec<f64>>> = lines.iter().map(|line| row(line, delimiter, decimal, strict)).collect();
    let content = |i: &usize| !passed_over(lines[*i]);
    let after = |i: usize| (i..lines.len()).filter(content).take(run);
    let first_row = (skip..lines.len()).filter(content).find(|&i| {
        let Some(width) = rows[i].as_ref().map(Vec::len) else { return false };
        after(i).count() == run && after(i).all(|k| rows[k].as_ref().is_some_and(|r| r.len() == width))
    })?;
    let width = rows[first_row].as_ref()?.len();
    let shown =
        (first_row..lines.len()).filter(content).filter(|&i| rows[i].as_ref().is_some_and(|r| r.len() == width));
    let ends =
        |i: usize| delimiter != Delimiter::Blank && delimiter.split(lines[i]).last().is_some_and(|f| f.is_empty());
    let trailing = width > 1 && shown.clone().all(ends);
    let width = width - usize::from(trailing);
    let values = shown.filter_map(|i| rows[i].as_ref().map(|row| row[..width].to_vec())).collect();
    Some(Reading { delimiter, decimal, first_row, width, values, trailing })
}

/// The values of a row, NaN for an empty field and, where numbers alone are not asked for, for text in less than half of
/// them; none for a line that is no row.
fn row(line: &str, delimiter: Delimiter, decimal: Decimal, strict: bool) -> Option<Vec<f64>> {
    let fields = delimiter.split(line);
    let numbers: Vec<Option<f64>> = fields.iter().map(|f| decimal.number(f.trim_matches('"').trim())).collect();
    let count = numbers.iter().flatten().count();
    let text = fields.iter().zip(&numbers).filter(|(f, n)| n.is_none() && !f.is_empty()).count();
    let holds = count > 0 && if strict { text == 0 } else { 2 * count >= fields.len() };
    holds.then(|| numbers.into_iter().map(|n| n.filter(|v| !v.is_nan()).unwrap_or(f64::NAN)).collect())
}

/// The reading with the header and the units above its rows.
fn with_header(lines: &[&str], reading: &Reading, stated: &Stated) -> Layout {
    let Reading { delimiter, decimal, first_row, width, trailing, .. } = *reading;
    let skip = stated.skip_lines.unwrap_or(0).min(first_row);
    let mut above = (skip..first_row).rev().filter(|&i| !lines[i].trim().is_empty());
    let fields = |i: usize| -> Option<Vec<String>> {
        let line = lines[i].trim_start_matches(['#', '%', '!', ' ']);
        let mut fields = header_fields(line, header_delimiter(line, delimiter));
        if fields.len() == width + 1 && fields.last().is_some_and(String::is_empty) {
            fields.pop();
        }
        // A separator at the end of every row, or a last column that is empty throughout.
        let as_wide = fields.len() == width || trailing && fields.len() == width + 1;
        // One name has no separator in it.
        let one = fields.len() > 1 || !line.contains(['\t', ';', ',']) || line.contains('"');
        (as_wide && one && fields.iter().any(|f| !f.is_empty())).then_some(fields)
    };
    let mut layout = Layout {
        delimiter,
        decimal,
        header: None,
        units: None,
        first_row,
        width,
        names: Vec::new(),
        column_units: Vec::new(),
        preamble: 0,
    };
    if let Some((line, names)) = above.next().and_then(|i| Some((i, fields(i)?))) {
        (layout.header, layout.width, layout.names) = (Some(line), names.len(), names);
        let unit_row = layout.names.iter().all(|f| f.is_empty() || is_unit(f));
        if unit_row && let Some((line, names)) = above.next().and_then(|i| Some((i, fields(i)?))) {
            layout.column_units = std::mem::replace(&mut layout.names, names);
            layout.units = layout.header.replace(line);
        }
    }
    let top = layout.header.unwrap_or(first_row);
    layout.preamble = lines[..top].iter().filter(|line| !passed_over(line)).count();
    if let Some(units) = &stated.units {
        layout.column_units.clone_from(units);
    }
    layout
}

/// A header may be separated otherwise than its rows, by commas over blanks.
fn header_delimiter(line: &str, rows: Delimiter) -> Delimiter {
    if rows != Delimiter::Blank {
        return rows;
    }
    [Delimiter::Tab, Delimiter::Semicolon, Delimiter::Comma]
        .into_iter()
        .find(|d| d.split(line).len() > 1)
        .unwrap_or(Delimiter::Blank)
}

/// The names on a header line; `time [s]` with a blank between is one.
fn header_fields(line: &str, delimiter: Delimiter) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for field in quoted(line, delimiter) {
        match names.last_mut() {
            Some(name) if delimiter == Delimiter::Blank && field.starts_with(['[', '(']) => {
                name.extend([" ", field.as_str()]);
            }
            _ => names.push(field),
        }
    }
    names
}

/// The fields of a header line, quotation marks taken off: a separator between them is part of the name.
fn quoted(line: &str, delimiter: Delimiter) -> Vec<String> {
    let mut inside = false;
    let separates = |c: char| match delimiter {
        Delimiter::Tab => c == '\t',
        Delimiter::Semicolon => c == ';',
        Delimiter::Comma => c == ',',
        Delimiter::Blank => c.is_whitespace(),
    };
    let fields = line.split(|c: char| {
        inside ^= c == '"';
        !inside && separates(c)
    });
    let plain = fields.map(|f| f.trim().trim_matches('"').trim().to_owned());
    plain.filter(|f| delimiter != Delimiter::Blank || !f.is_empty()).collect()
}

/// The beginning of a line, short enough for a message.
pub(crate) fn excerpt(text: &str) -> String {
    let text = text.trim();
    let mut short: String = text.chars().take(40).collect();
    if text.chars().count() > 40 {
        short.push_str("...");
    }
    short
}

#[cfg(test)]
mod tests;
