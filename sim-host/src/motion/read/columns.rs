//! Columns of text, laid out as [`crate::files::layout`] finds it; `#`, `%` and `!` begin a comment.
//!
//! A line above the numbers may name the columns, with a unit in brackets or on a line below: `time [s], acceleration
//! [m/s2]`. The interval comes from a time column or from `--dt`, the unit from the header or from `--unit`; both are needed
//! and neither is guessed. With more than one column of values the person says which, or that the rows are one series, wrapped.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::csmip::select;
use super::error::{Problem, ReadError, listed};
use super::peer::interval_in_range;
use super::text::{Block, excerpt, number};
use super::{Channel, Options};
use crate::digits;
use crate::files::layout::{self, Decimal, Delimiter, Layout};

/// How far a step of a time column may be from the usual one, as a share of it: times rounded to thousandths of a second
/// at 204.8 Hz stray by 0.2, a dropped sample by 1.
const JITTER: f64 = 0.25;

/// The rows of a file.
struct Table {
    /// Values row by row, NaN where a field is no finite number.
    rows: Vec<Vec<f64>>,
    /// Each row's line index.
    lines: Vec<usize>,
    /// Column names, empty where there are none.
    names: Vec<Name>,
    /// How they are laid out; none where the rows are wrapped.
    layout: Option<Layout>,
}

/// A column's name and the unit in its brackets or below it.
#[derive(Debug, Clone, PartialEq)]
struct Name {
    name: String,
    unit: Option<String>,
}

/// True for a line of numbers only, NaN and infinity included, whatever separates them.
pub(super) fn is_row(line: &str) -> bool {
    let alike = |delimiter: Delimiter, decimal: Decimal| {
        let fields = delimiter.split(line);
        fields.iter().any(|f| !f.is_empty()) && fields.iter().all(|f| f.is_empty() || decimal.number(f).is_some())
    };
    !is_comment(line)
        && (alike(Delimiter::Blank, Decimal::Point)
            || alike(Delimiter::Blank, Decimal::Comma)
            || alike(Delimiter::Comma, Decimal::Point)
            || alike(Delimiter::Semicolon, Decimal::Point)
            || alike(Delimiter::Semicolon, Decimal::Comma))
}

fn split(line: &str) -> impl Iterator<Item = (usize, &str)> {
    line.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';'))
        .filter(|f| !f.is_empty())
        .map(move |f| (f.as_ptr() as usize - line.as_ptr() as usize, f))
}

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with(['#', '%', '!'])
}

pub(super) fn read(block: &Block, options: &Options) -> Result<Record, ReadError> {
    let table = if options.channel == Channel::Wrapped { wrapped(block)? } else { table(block, options)? };
    let time = time_column(&table, options);
    let dt = interval(block, &table, time, options)?;
    let (values, component, unit) = values(block, &table, time, options)?;
    let header = table.lines.first().map_or(1, |&i| block.number(i).saturating_sub(1).max(1));
    let mut facts = vec![Fact { key: "unit", value: unit.symbol().to_owned(), line: header }];
    let notes = table.layout.as_ref().map_or_else(Vec::new, Layout::notes);
    facts.extend(notes.into_iter().map(|value| Fact { key: "layout", value, line: header }));
    let acceleration = values.iter().map(|a| a * unit.in_si()).collect();
    Ok(Record { name: block.name(), dt, acceleration, component, format: Format::Columns, facts })
}

/// The rows as one series: whatever separates their numbers, decimal points.
fn wrapped(block: &Block) -> Result<Table, ReadError> {
    let first = block.lines.iter().position(|l| is_row(l)).unwrap_or(0);
    let mut table = Table { rows: Vec::new(), lines: Vec::new(), names: Vec::new(), layout: None };
    for (index, line) in block.lines.iter().enumerate().skip(first).filter(|(_, l)| !is_comment(l)) {
        let row: Result<Vec<f64>, ReadError> =
            split(line).map(|(column, f)| number(f).map_err(|p| block.at_column(index, column, p))).collect();
        table.rows.push(row?);
        table.lines.push(index);
    }
    Ok(table)
}

/// The rows in columns of one layout.
fn table(block: &Block, options: &Options) -> Result<Table, ReadError> {
    let layout = layout::find(block.lines, &options.text)
        .map_err(|e| block.at(e.line.unwrap_or(0), Problem::Layout { reason: e.reason }))?;
    let mut table = Table { rows: Vec::new(), lines: Vec::new(), names: names(&layout), layout: None };
    for (index, line) in block.lines.iter().enumerate().skip(layout.first_row).filter(|(_, l)| !is_comment(l)) {
        let mut fields = layout.delimiter.split(line);
        while fields.len() > layout.width && fields.last().is_some_and(|f| f.is_empty()) {
            fields.pop();
        }
        if fields.len() != layout.width {
            let pair = (format!("the rows have {} columns", layout.width), format!("this one has {}", fields.len()));
            let remedy = "complete the row, or say --channel all where the rows are one wrapped series";
            return Err(block.contradiction(index, "number of columns", pair, remedy));
        }
        let value = |f: &&str| layout.decimal.number(f.trim_matches('"')).filter(|v| v.is_finite());
        table.rows.push(fields.iter().map(|f| value(f).unwrap_or(f64::NAN)).collect());
        table.lines.push(index);
    }
    table.layout = Some(layout);
    Ok(table)
}

/// The names and units of a layout's columns.
fn names(layout: &Layout) -> Vec<Name> {
    let below = |i: usize| layout.column_units.get(i).filter(|u| !u.is_empty());
    let trimmed = |u: &str| u.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim().to_owned();
    let parse = |(i, field): (usize, &String)| {
        let (name, unit) = field.split_once(['[', '(']).unwrap_or((field, ""));
        let unit = if unit.is_empty() { below(i).map(|u| trimmed(u)) } else { Some(trimmed(unit)) };
        Name { name: name.trim().to_owned(), unit: unit.filter(|u| !u.is_empty()) }
    };
    if layout.names.is_empty() {
        let unnamed = |u: &String| Name { name: String::new(), unit: Some(trimmed(u)).filter(|u| !u.is_empty()) };
        return layout.column_units.iter().map(unnamed).collect();
    }
    layout.names.iter().enumerate().map(parse).collect()
}

/// A column's values, all of them finite.
fn column(block: &Block, table: &Table, column: usize) -> Result<Vec<f64>, ReadError> {
    if let Some(at) = table.rows.iter().position(|row| row.get(column).is_none_or(|v| !v.is_finite())) {
        let (index, layout) = (table.lines[at], table.layout.as_ref());
        let line = block.lines[index];
        let fields = layout.map_or_else(Vec::new, |l| l.delimiter.split(line));
        let field = fields.get(column).copied().unwrap_or_default();
        let place = if field.is_empty() { 0 } else { field.as_ptr() as usize - line.as_ptr() as usize };
        let expected = "a number";
        let plain = layout.and_then(|l| l.decimal.number(field)).is_some();
        let found = excerpt(field);
        let problem =
            if plain { Problem::NotFinite { found, expected } } else { Problem::NotANumber { found, expected } };
        return Err(block.at_column(index, place, problem));
    }
    Ok(table.rows.iter().map(|row| row[column]).collect())
}

/// The index of the time column: named so, or the first of several unnamed ones where it rises in even steps from the
/// first row to the last.
fn time_column(table: &Table, options: &Options) -> Option<usize> {
    if options.channel == Channel::Wrapped {
        return None;
    }
    if table.names.iter().any(|n| !n.name.is_empty()) {
        return table.names.iter().position(|n| matches!(n.name.to_lowercase().as_str(), "time" | "t"));
    }
    let first: Vec<f64> = table.rows.iter().map(|r| r[0]).collect();
    let wide = table.rows.first().is_some_and(|r| r.len() > 1) && table.rows.len() > 2;
    (wide && uneven_step(&first).is_none() && first[1] > first[0]).then_some(0)
}

/// The first step of a time column that is not like most steps.
pub(super) fn uneven_step(time: &[f64]) -> Option<usize> {
    let usual = usual_step(time);
    time.windows(2).position(|w| (w[1] - w[0] - usual).abs() > JITTER * usual.abs())
}

/// The median step.
pub(super) fn usual_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

pub(super) fn mean_step(time: &[f64]) -> f64 {
    let last = time.len().saturating_sub(1);
    if last == 0 { 0.0 } else { (time[last] - time[0]) / last as f64 }
}

/// Steps of a record, s: 20 kHz to 5 Hz. Beyond them a time column is in another unit than its header says.
pub(crate) const STEPS: std::ops::RangeInclusive<f64> = 4.9e-5..=0.21;

/// The sampling interval, s.
fn interval(block: &Block, table: &Table, time: Option<usize>, options: &Options) -> Result<f64, ReadError> {
    let Some(time) = time else {
        let remedy = "give it with --dt, in seconds, or add a column named time";
        let dt = options.dt.ok_or_else(|| block.missing("the sampling interval", remedy))?;
        interval_in_range(block, 0, dt)?;
        return Ok(dt);
    };
    let times = column(block, table, time)?;
    if times.len() < 2 {
        return Err(block.at(table.lines.first().copied().unwrap_or(0), Problem::TooShort { samples: times.len() }));
    }
    let unit = table.names.get(time).and_then(|n| n.unit.clone()).unwrap_or_else(|| "s".into());
    let size = match unit.as_str() {
        "s" | "sec" => 1.0,
        "ms" => 1e-3,
        _ => {
            let pair = (format!("`{}`", excerpt(&unit)), "time is read in s or ms".to_owned());
            return Err(block.contradiction(table.lines[0].saturating_sub(1), "unit of time", pair, "convert it"));
        }
    };
    if let Some(i) = uneven_step(&times) {
        let pair = (
            format!("the usual step is {} {unit}", digits::stated(usual_step(&times))),
            format!("this row comes {} {unit} after the last", digits::stated(times[i + 1] - times[i])),
        );
        let remedy = "resample the record to even steps";
        return Err(block.contradiction(table.lines[i + 1], "time", pair, remedy));
    }
    // Times come in decimals, so an interval does too, but for what dividing leaves in its last bits.
    let dt = (mean_step(&times) * size * 1e11).round() / 1e11;
    if dt > 0.0 && !STEPS.contains(&dt) {
        let pair = (
            format!("the header says {unit}"),
            format!("steps of {} {unit} are {} Hz", digits::stated(usual_step(&times)), digits::stated(1.0 / dt)),
        );
        let remedy = "a record has 5 Hz to 20 kHz: correct the unit of the time column";
        return Err(block.contradiction(table.lines[0].saturating_sub(1), "unit of time", pair, remedy));
    }
    interval_in_range(block, table.lines.first().copied().unwrap_or(0), dt)?;
    Ok(dt)
}

/// The values asked for, their column's name and unit.
fn values(
    block: &Block,
    table: &Table,
    time: Option<usize>,
    options: &Options,
) -> Result<(Vec<f64>, String, AccelerationUnit), ReadError> {
    if options.channel == Channel::Wrapped {
        let unit = options.unit.ok_or_else(|| missing_unit(block))?;
        return Ok((table.rows.concat(), String::new(), unit));
    }
    let width = table.rows.first().map_or(0, Vec::len);
    let named = |i: usize| table.names.get(i).map(|n| n.name.clone()).filter(|name| !name.is_empty());
    let labels: Vec<String> = (0..width).map(|i| named(i).unwrap_or_else(|| format!("column {}", i + 1))).collect();
    let others: Vec<usize> = (0..width).filter(|&i| Some(i) != time).collect();
    let chosen = match (&options.channel, others.as_slice()) {
        (Channel::First, [only]) => *only,
        (Channel::First, _) => return Err(block.at(0, Problem::SeveralColumns { available: listed(&labels) })),
        (channel, _) => select(block, &labels, channel)?,
    };
    let name = table.names.get(chosen);
    let unit = match name.and_then(|n| n.unit.as_deref()) {
        Some(text) => text
            .parse()
            .map_err(|_| block.at(table.lines[0].saturating_sub(1), Problem::Unit { found: excerpt(text) }))?,
        None => options.unit.ok_or_else(|| missing_unit(block))?,
    };
    let component = name.map_or_else(String::new, |n| n.name.clone());
    let values = column(block, table, chosen)?;
    let beyond = values.iter().map(|a| a * unit.in_si()).zip(&table.lines).find(|(a, _)| !super::credible(*a));
    match beyond {
        Some((found, &line)) => Err(block.at(line, super::incredible(found))),
        None => Ok((values, component, unit)),
    }
}

fn missing_unit(block: &Block) -> ReadError {
    block.missing(
        "the unit of acceleration",
        "give it with --unit (m/s2, cm/s2, mm/s2 or g), or in the column's brackets",
    )
}
