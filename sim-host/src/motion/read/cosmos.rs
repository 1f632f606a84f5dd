//! COSMOS strong-motion data format, version 1.20 (`.V1`, `.V2c`): text, integer and real headers that say their own size,
//! comments, and one block of data a channel and quantity.
//!
//! The interval is entry 34 of the real header, s; the peak entry 64. Velocity and displacement blocks are passed over.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::Channel;
use super::csmip::{first_of, select};
use super::error::{Problem, ReadError};
use super::peer::interval_in_range;
use super::text::{Block, after, excerpt, first_number, signed_peak};

/// Places in the real header, from 0.
const INTERVAL: usize = 33;
const PEAK: usize = 63;
/// What denotes a value that is not known.
const UNKNOWN: f64 = -999.0;

pub(super) fn read(block: &Block, channel: &Channel) -> Result<Record, ReadError> {
    let channels = channels(block);
    if channels.is_empty() {
        let remedy = "give the file of accelerations, not of velocities, displacements or spectra";
        return Err(block.missing("a line `... acceleration pts, ... units=...`", remedy));
    }
    let labels: Vec<String> = channels.iter().map(|(part, _)| label(part)).collect();
    let chosen = select(block, &labels, channel)?;
    let (part, data_line) = channels[chosen];
    let line = part.lines[data_line];
    let unit = unit(&part, data_line, line)?;
    let header = real_header(&part)?;
    let values = values(&part, data_line, line)?;
    let dt = header.get(INTERVAL).copied().filter(|dt| *dt != UNKNOWN).ok_or_else(|| {
        part.missing("the sampling interval (real header, entry 34)", "correct the header or download the file again")
    })?;
    interval_in_range(&part, data_line, dt)?;
    check(&part, data_line, &header, (&values, dt))?;
    let mut facts = facts(&part);
    facts.push(Fact { key: "unit", value: unit.symbol().into(), line: part.number(data_line) });
    facts.extend(first_of(&labels, channel));
    Ok(Record {
        name: block.name(),
        dt,
        acceleration: values.iter().map(|a| a * unit.in_si()).collect(),
        component: labels[chosen].clone(),
        format: Format::Cosmos,
        facts,
    })
}

/// The runs of lines that hold an acceleration, each with the index of its data line.
fn channels<'a>(block: &Block<'a>) -> Vec<(Block<'a>, usize)> {
    let mut parts = Vec::new();
    let mut from = 0;
    let ends = block.lines.iter().enumerate().filter(|(_, l)| l.trim_start().to_lowercase().starts_with("end-of-data"));
    for end in ends.map(|(i, _)| i).chain([block.lines.len()]) {
        let part = block.part(from, end);
        let data = part.lines.iter().position(|l| {
            let lower = l.to_lowercase();
            lower.contains("acceleration p") && lower.contains("units=")
        });
        parts.extend(data.map(|index| (part, index)));
        from = end + 1;
    }
    parts
}

/// The component, as in `Sta Chan  1: 360 deg (Rcrdr Chan  1)`.
fn label(part: &Block) -> String {
    let text = part.lines.iter().take(20).find_map(|l| after(l, "sta chan")).and_then(|r| r.split_once(':'));
    text.map_or("", |(_, name)| name.split("  ").next().unwrap_or(name))
        .split(['(', '\t'])
        .next()
        .unwrap_or("")
        .trim()
        .to_owned()
}

fn unit(part: &Block, index: usize, line: &str) -> Result<AccelerationUnit, ReadError> {
    let word = after(line, "units=").unwrap_or("").trim_start();
    let word = word.split(|c: char| c.is_whitespace() || matches!(c, '(' | ',')).next().unwrap_or("");
    word.parse().map_err(|_| part.at(index, Problem::Unit { found: word.to_owned() }))
}

/// The real header's values.
fn real_header(part: &Block) -> Result<Vec<f64>, ReadError> {
    let remedy = "a COSMOS file states its interval there; download it again";
    let (index, line) =
        part.find("real-header values").ok_or_else(|| part.missing("the line `Real-header values`", remedy))?;
    let bad = |expected| part.at(index, Problem::NotANumber { found: excerpt(line), expected });
    let stated = |text: Option<&str>| text.and_then(first_number).and_then(|n| n.parse::<usize>().ok());
    let count = stated(Some(line)).ok_or_else(|| bad("the number of real-header values"))?;
    let lines = stated(after(line, " on ")).ok_or_else(|| bad("the number of real-header lines"))?;
    let from = index + 1;
    let values = part.part(from, from.saturating_add(lines)).numbers(width(line))?;
    if values.len() != count {
        let pair = (format!("the header announces {count}"), format!("{} are there", values.len()));
        return Err(part.contradiction(index, "real-header values", pair, "download the file again"));
    }
    Ok(values)
}

/// The width of a column, from `Format=(8f10.5)` or `Format= (5E15.6)`.
fn width(line: &str) -> Option<usize> {
    let format = after(line, "format")?.split_once('(')?.1;
    let digits = format.trim_start_matches(|c: char| c.is_ascii_digit()).get(1..)?;
    digits.split(['.', ')']).next()?.trim().parse().ok()
}

fn values(part: &Block, index: usize, line: &str) -> Result<Vec<f64>, ReadError> {
    let expected = "the sample count before `acceleration pts`";
    let count: usize = first_number(line)
        .and_then(|n| n.parse().ok())
        .ok_or_else(|| part.at(index, Problem::NotANumber { found: excerpt(line), expected }))?;
    let values = part.part(index + 1, part.lines.len()).numbers(width(line))?;
    if values.len() != count {
        let pair = (format!("the header says {count} points"), format!("the block holds {} values", values.len()));
        return Err(part.contradiction(index, "number of samples", pair, "download the file again"));
    }
    Ok(values)
}

/// Compares the stated duration and peak with the data.
fn check(part: &Block, index: usize, header: &[f64], (values, dt): (&[f64], f64)) -> Result<(), ReadError> {
    let stated = after(part.lines[index], "approx").and_then(first_number).and_then(|n| n.parse::<f64>().ok());
    let duration = values.len() as f64 * dt;
    // The line states whole seconds.
    if let Some(stated) = stated.filter(|s| (s - duration).abs() > 1.0 + dt) {
        let pair = (format!("the header says {stated} s"), format!("{} samples every {dt} s are there", values.len()));
        return Err(part.contradiction(index, "duration", pair, "download the file again, or correct the header"));
    }
    let peak = header.get(PEAK).copied().filter(|p| *p != UNKNOWN);
    let found = signed_peak(values, peak.unwrap_or(0.0));
    // Some processors write the peak without its sign; six digits are kept at most.
    match peak.filter(|p| (p.abs() - found.abs()).abs() > 1e-3 * found.abs() + 2e-6) {
        None => Ok(()),
        Some(peak) => {
            let pair = (format!("the header says {peak}"), format!("the data reach {found}"));
            Err(part.contradiction(index, "peak acceleration", pair, "download the file again, or correct the header"))
        }
    }
}

fn facts(part: &Block) -> Vec<Fact> {
    let keys = [
        ("hypocenter", "hypocenter"),
        ("statn no", "station"),
        ("rcrd start", "record time"),
        ("processed", "processing"),
    ];
    let head = part.part(0, 14);
    keys.into_iter()
        .filter_map(|(needle, key)| {
            let (index, line) = head.find(needle)?;
            Some(Fact { key, value: line.trim().to_owned(), line: head.number(index) })
        })
        .collect()
}
