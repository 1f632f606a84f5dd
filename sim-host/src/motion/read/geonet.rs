//! GeoNet `.V2A`: three components, each with 16 lines of text, 10 of numbers, then acceleration, velocity and
//! displacement, ten values a line in columns eight wide, mm/s², mm/s and mm. The text states the three peaks.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::Channel;
use super::csmip::{first_of, select};
use super::error::{Problem, ReadError};
use super::peer::interval_in_range;
use super::text::{Block, Stated, after, excerpt, first_number, signed_peak};

const FIELD_WIDTH: usize = 8;
const FIELDS_PER_LINE: usize = 10;
const NUMERIC_LINES: usize = 10;

pub(super) fn read(block: &Block, channel: &Channel) -> Result<Record, ReadError> {
    let channels = channels(block);
    let labels: Vec<String> = channels.iter().map(label).collect();
    let chosen = select(block, &labels, channel)?;
    let part = channels[chosen];
    let (count_line, count) = quantity(&part, "number of points", "number of points", "the line `Number of points`")?;
    let (dt_line, dt) = quantity(&part, "sec intervals", " at ", "the line `... data at ... sec intervals`")?;
    interval_in_range(&part, dt_line, dt)?;
    check_duration(&part, count_line, (count, dt))?;
    let (unit, unit_line) = unit(&part)?;
    let values = blocks(&part, count_line, count as usize)?;
    let mut facts = facts(&part);
    facts.push(Fact { key: "unit", value: unit.symbol().into(), line: part.number(unit_line) });
    facts.extend(first_of(&labels, channel));
    Ok(Record {
        name: block.name(),
        dt,
        acceleration: values.iter().map(|a| a * unit.in_si()).collect(),
        component: labels[chosen].clone(),
        format: Format::GeoNet,
        facts,
    })
}

/// The runs of lines that each hold a component.
fn channels<'a>(block: &Block<'a>) -> Vec<Block<'a>> {
    let starts: Vec<usize> = block
        .lines
        .iter()
        .enumerate()
        .filter(|(_, l)| l.to_lowercase().starts_with("corrected accelerogram"))
        .map(|(i, _)| i)
        .collect();
    let ends = starts.iter().skip(1).copied().chain([block.lines.len()]);
    starts.iter().zip(ends).map(|(&from, to)| block.part(from, to)).collect()
}

/// The component, as in `Component N28W  Longitudinal Accelerometer Axis`.
fn label(part: &Block) -> String {
    let line = part.part(0, 20).find("component").map_or("", |(_, l)| l);
    after(line, "component").unwrap_or("").split_whitespace().next().unwrap_or("").to_owned()
}

/// A positive number after a word of a header line.
fn quantity(part: &Block, line: &str, word: &str, expected: &'static str) -> Result<(usize, f64), ReadError> {
    let remedy = "a GeoNet V2A file has it in each component's header; download it again";
    let (index, text) = part.part(0, 20).find(line).ok_or_else(|| part.missing(expected, remedy))?;
    let value = after(text, word).and_then(first_number).and_then(|n| n.parse().ok()).filter(|v| *v > 0.0);
    let problem = || part.at(index, Problem::NotANumber { found: excerpt(text), expected: "a positive number" });
    Ok((index, value.ok_or_else(problem)?))
}

fn check_duration(part: &Block, index: usize, (count, dt): (f64, f64)) -> Result<(), ReadError> {
    let stated = after(part.lines[index], "duration").and_then(first_number).and_then(|n| n.parse::<f64>().ok());
    match stated.filter(|s| (s - count * dt).abs() > 2.0 * dt + 0.01) {
        None => Ok(()),
        Some(stated) => {
            let pair = (format!("the header says {stated} s"), format!("{count} points at {dt} s intervals"));
            Err(part.contradiction(index, "duration", pair, "download the file again, or correct the header"))
        }
    }
}

/// The unit of acceleration, from the line of its peak.
fn unit(part: &Block) -> Result<(AccelerationUnit, usize), ReadError> {
    let remedy = "a GeoNet V2A file states its unit there; download it again";
    let (index, line) = part
        .part(0, 20)
        .find("acceleration:")
        .ok_or_else(|| part.missing("the line `Acceleration: peak ...`", remedy))?;
    let word = after(line, "peak").and_then(|r| r.split_whitespace().nth(1)).unwrap_or("");
    Ok((word.parse().map_err(|_| part.at(index, Problem::Unit { found: word.to_owned() }))?, index))
}

/// The accelerations, once all blocks there are have been checked against the header's peaks.
fn blocks(part: &Block, count_line: usize, count: usize) -> Result<Vec<f64>, ReadError> {
    let remedy = "a GeoNet V2A file states its peaks there; download it again";
    let (last, _) = part
        .part(0, 20)
        .find("displacement:")
        .ok_or_else(|| part.missing("the line `Displacement: peak ...`", remedy))?;
    let rows = count.div_ceil(FIELDS_PER_LINE);
    let data = part.part(last + 1 + NUMERIC_LINES, part.lines.len());
    let mut acceleration = None;
    for (i, name) in ["acceleration:", "velocity:", "displacement:"].into_iter().enumerate() {
        let from = rows.saturating_mul(i);
        let block = data.part(from, from.saturating_add(rows));
        if i > 0 && block.lines.is_empty() {
            break;
        }
        let values = block.numbers(Some(FIELD_WIDTH))?;
        if values.len() != count {
            let pair = (format!("the header says {count}"), format!("the {name} block holds {}", values.len()));
            return Err(part.contradiction(count_line, "number of points", pair, "download the file again"));
        }
        check_peak(part, name, &values)?;
        acceleration.get_or_insert(values);
    }
    let surplus = rows.saturating_mul(3);
    if data.lines.len() > surplus {
        let pair = (format!("the header says {count}"), format!("{} more lines follow", data.lines.len() - surplus));
        return Err(part.contradiction(count_line, "number of points", pair, "download the file again"));
    }
    Ok(acceleration.unwrap_or_default())
}

/// Compares a stated peak, sign included, with its block's data.
fn check_peak(part: &Block, name: &str, values: &[f64]) -> Result<(), ReadError> {
    let Some((index, line)) = part.part(0, 20).find(name) else { return Ok(()) };
    let Some(stated) = after(line, "peak").and_then(Stated::first_in) else { return Ok(()) };
    let found = signed_peak(values, stated.value);
    if stated.agrees(found) {
        return Ok(());
    }
    let pair = (format!("the header says {}", stated.text), format!("the data reach {found}"));
    Err(part.contradiction(index, "peak", pair, "download the file again, or correct the header"))
}

fn facts(part: &Block) -> Vec<Fact> {
    let keys = [
        ("site", "station"),
        ("epicentre", "epicentre"),
        ("band-pass", "filter"),
        ("acceleration:", "peak acceleration"),
        ("velocity:", "peak velocity"),
        ("displacement:", "peak displacement"),
    ];
    let head = part.part(0, 20);
    keys.into_iter()
        .filter_map(|(needle, key)| {
            let (index, line) = head.find(needle)?;
            Some(Fact { key, value: line.trim().to_owned(), line: head.number(index) })
        })
        .collect()
}
