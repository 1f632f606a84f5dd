//! Columns of text: comma, semicolon, tab or blanks, decimal point; `#`, `%` and `!` begin a comment.
//!
//! A line above the numbers may name the columns, with a unit in brackets: `time [s], acceleration [m/s2]`. The interval
//! comes from a time column or from `--dt`, the unit from the brackets or from `--unit`; both are needed and neither is
//! guessed. With more than one column of values the person says which, or that the rows are one series, wrapped.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::csmip::select;
use super::error::{Problem, ReadError};
use super::peer::interval_in_range;
use super::text::{Block, excerpt, number};
use super::{Channel, Options};

/// How far a step of a time column may be from the usual one, as a share of it: times rounded to thousandths of a second
/// at 204.8 Hz stray by 0.2, a dropped sample by 1.
const JITTER: f64 = 0.25;

/// The rows of a file.
struct Table {
    /// Values row by row.
    rows: Vec<Vec<f64>>,
    /// Each row's line index.
    lines: Vec<usize>,
    /// Column names, empty where there are none.
    names: Vec<Name>,
}

/// A column's name and the unit in its brackets.
#[derive(Debug, Clone, PartialEq)]
struct Name {
    name: String,
    unit: Option<String>,
}

/// True for a line of numbers only, NaN and infinity included.
pub(super) fn is_row(line: &str) -> bool {
    let mut any = false;
    let all = split(line).all(|(_, f)| {
        any = true;
        number(f).map_or_else(|p| matches!(p, Problem::NotFinite { .. }), |_| true)
    });
    any && all
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
    let table = table(block)?;
    let width = table.rows.first().map_or(0, Vec::len);
    if options.channel != Channel::Wrapped
        && let Some(i) = table.rows.iter().position(|r| r.len() != width)
    {
        let pair = (format!("the first row has {width} columns"), format!("this one has {}", table.rows[i].len()));
        let remedy = "complete the row, or say --channel all where the rows are one wrapped series";
        return Err(block.contradiction(table.lines[i], "number of columns", pair, remedy));
    }
    let time = time_column(&table, options);
    let dt = interval(block, &table, time, options)?;
    let (values, component, unit) = values(block, &table, time, options)?;
    let header = table.lines.first().map_or(1, |&i| block.number(i).saturating_sub(1).max(1));
    let facts = vec![Fact { key: "unit", value: unit.symbol().to_owned(), line: header }];
    let acceleration = values.iter().map(|a| a * unit.in_si()).collect();
    Ok(Record { name: block.name(), dt, acceleration, component, format: Format::Columns, facts })
}

fn table(block: &Block) -> Result<Table, ReadError> {
    let first = block.lines.iter().position(|l| is_row(l)).unwrap_or(0);
    let mut table = Table { rows: Vec::new(), lines: Vec::new(), names: Vec::new() };
    for (index, line) in block.lines.iter().enumerate().skip(first).filter(|(_, l)| !is_comment(l)) {
        let row: Result<Vec<f64>, ReadError> =
            split(line).map(|(column, f)| number(f).map_err(|p| block.at_column(index, column, p))).collect();
        table.rows.push(row?);
        table.lines.push(index);
    }
    let width = table.rows.first().map_or(0, Vec::len);
    if let Some(line) = first.checked_sub(1).map(|i| block.lines[i].trim_start_matches(['#', '%', '!', ' '])) {
        table.names = names(line);
        // A line of another width is a title, not a header.
        if table.names.len() != width {
            table.names.clear();
        }
    }
    Ok(table)
}

/// The names on a header line, `time [s], acc (g)`.
fn names(line: &str) -> Vec<Name> {
    let fields: Vec<String> = if line.contains([',', ';', '\t']) {
        line.split([',', ';', '\t']).map(|f| f.trim().to_owned()).collect()
    } else {
        let mut fields: Vec<String> = Vec::new();
        for field in line.split_whitespace() {
            match fields.last_mut() {
                Some(last) if field.starts_with(['[', '(']) => *last += field,
                _ => fields.push(field.to_owned()),
            }
        }
        fields
    };
    let parse = |field: String| {
        let field = field.trim_matches('"');
        let (name, unit) = field.split_once(['[', '(']).unwrap_or((field, ""));
        let unit = unit.trim_end_matches([']', ')']).trim();
        Name { name: name.trim().to_owned(), unit: (!unit.is_empty()).then(|| unit.to_owned()) }
    };
    fields.into_iter().map(parse).collect()
}

/// The index of the time column: named so, or the first of several unnamed ones where it rises in even steps from the
/// first row to the last.
fn time_column(table: &Table, options: &Options) -> Option<usize> {
    if options.channel == Channel::Wrapped {
        return None;
    }
    if !table.names.is_empty() {
        return table.names.iter().position(|n| matches!(n.name.to_lowercase().as_str(), "time" | "t"));
    }
    let first: Vec<f64> = table.rows.iter().map(|r| r[0]).collect();
    let wide = table.rows.first().is_some_and(|r| r.len() > 1) && table.rows.len() > 2;
    (wide && uneven_step(&first).is_none() && first[1] > first[0]).then_some(0)
}

/// The first step of a time column that is not like most steps.
fn uneven_step(time: &[f64]) -> Option<usize> {
    let usual = usual_step(time);
    time.windows(2).position(|w| (w[1] - w[0] - usual).abs() > JITTER * usual.abs())
}

/// The median step.
fn usual_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}

fn mean_step(time: &[f64]) -> f64 {
    let last = time.len().saturating_sub(1);
    if last == 0 { 0.0 } else { (time[last] - time[0]) / last as f64 }
}

/// The sampling interval, s.
fn interval(block: &Block, table: &Table, time: Option<usize>, options: &Options) -> Result<f64, ReadError> {
    let Some(column) = time else {
        let remedy = "give it with --dt, in seconds, or add a column named time";
        let dt = options.dt.ok_or_else(|| block.missing("the sampling interval", remedy))?;
        interval_in_range(block, 0, dt)?;
        return Ok(dt);
    };
    let times: Vec<f64> = table.rows.iter().map(|r| r[column]).collect();
    let unit = table.names.get(column).and_then(|n| n.unit.clone()).unwrap_or_else(|| "s".into());
    let size = match unit.as_str() {
        "s" | "sec" => 1.0,
        "ms" => 1e-3,
        _ => {
            let pair = (format!("`{unit}`"), "time is read in s or ms".to_owned());
            return Err(block.contradiction(table.lines[0].saturating_sub(1), "unit of time", pair, "convert it"));
        }
    };
    if let Some(i) = uneven_step(&times) {
        let pair = (
            format!("the usual step is {} {unit}", usual_step(&times)),
            format!("this row comes {} {unit} after the last", times[i + 1] - times[i]),
        );
        let remedy = "resample the record to even steps";
        return Err(block.contradiction(table.lines[i + 1], "time", pair, remedy));
    }
    // Times come in decimals, so an interval does too, but for what dividing leaves in its last bits.
    let dt = (mean_step(&times) * size * 1e11).round() / 1e11;
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
    let label = |i: usize| table.names.get(i).map_or_else(|| format!("column {}", i + 1), |n| n.name.clone());
    let labels: Vec<String> = (0..width).map(label).collect();
    let others: Vec<usize> = (0..width).filter(|&i| Some(i) != time).collect();
    let column = match (&options.channel, others.as_slice()) {
        (Channel::First, [only]) => *only,
        (Channel::First, _) => {
            let available = labels.iter().enumerate().map(|(i, l)| format!("{} ({l})", i + 1)).collect::<Vec<_>>();
            let asked = "unnamed, with several columns".to_owned();
            return Err(block.at(0, Problem::NoChannel { asked, available: available.join(", ") + ", all (wrapped)" }));
        }
        (channel, _) => select(block, &labels, channel)?,
    };
    let name = table.names.get(column);
    let unit = match name.and_then(|n| n.unit.as_deref()) {
        Some(text) => text
            .parse()
            .map_err(|_| block.at(table.lines[0].saturating_sub(1), Problem::Unit { found: excerpt(text) }))?,
        None => options.unit.ok_or_else(|| missing_unit(block))?,
    };
    let component = name.map_or_else(String::new, |n| n.name.clone());
    Ok((table.rows.iter().map(|r| r[column]).collect(), component, unit))
}

fn missing_unit(block: &Block) -> ReadError {
    block.missing(
        "the unit of acceleration",
        "give it with --unit (m/s2, cm/s2, mm/s2 or g), or in the column's brackets",
    )
}
