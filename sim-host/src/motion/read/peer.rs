//! PEER `.AT2`, the headers of the strong-motion database before NGA and of NGA.
//!
//! Four lines of header (database, event and station, quantity and unit, count and interval), then five values a line.
//! The fourth line is written `NPTS=  4000, DT= .01000 SEC`, `NPTS = 7500 , DT = .020 SEC`, or `4000 .0100 NPTS, DT`.
//! The format states no peak.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::error::{Problem, ReadError};
use super::text::{Block, after, excerpt, first_number, number};

const FIELD_WIDTH: usize = 15;

pub(super) fn read(block: &Block) -> Result<Record, ReadError> {
    let head = block.part(0, 6);
    let (count_line, text) = head.find("npts").ok_or_else(|| {
        block
            .missing("the line with NPTS and DT", "a PEER file states its sample count and interval on its fourth line")
    })?;
    let (count, dt) = counts(block, count_line, text)?;
    let unit = unit(&head, count_line)?;
    let data = block.part(count_line + 1, block.lines.len());
    let values = data.numbers(Some(FIELD_WIDTH))?;
    if values.len() != count {
        return Err(block.contradiction(
            count_line,
            "number of samples",
            (format!("the header says NPTS = {count}"), format!("the file holds {} values", values.len())),
            "download the file again, or correct NPTS",
        ));
    }
    let title = if count_line >= 2 { block.lines[count_line - 2].trim() } else { "" };
    let component = title.rsplit(',').next().unwrap_or("").trim().to_owned();
    let mut facts = Vec::new();
    for (key, index) in
        [("database", 0), ("title", count_line.wrapping_sub(2)), ("quantity", count_line.wrapping_sub(1))]
    {
        if let Some(line) = block.lines.get(index).filter(|_| index < count_line) {
            facts.push(Fact { key, value: line.trim().to_owned(), line: block.number(index) });
        }
    }
    facts.push(Fact { key: "unit", value: unit.symbol().to_owned(), line: block.number(count_line.saturating_sub(1)) });
    facts.push(Fact { key: "sampling", value: text.trim().to_owned(), line: block.number(count_line) });
    Ok(Record {
        name: block.name(),
        dt,
        acceleration: values.iter().map(|a| a * unit.in_si()).collect(),
        component,
        format: Format::Peer,
        facts,
    })
}

/// The sample count and the interval (s).
fn counts(block: &Block, index: usize, line: &str) -> Result<(usize, f64), ReadError> {
    let mut plain = line.split([' ', ',']).filter(|f| !f.is_empty());
    let labelled = |label: &str| after(line, label).map(|rest| rest.trim_start_matches([' ', '=', ':']));
    let (count, dt) = if line.trim_start().to_lowercase().starts_with("npts") {
        (labelled("npts").and_then(first_number), labelled("dt").and_then(first_number))
    } else {
        (plain.next(), plain.next())
    };
    let bad = |found: Option<&str>, expected| {
        block.at(index, Problem::NotANumber { found: excerpt(found.unwrap_or(line)), expected })
    };
    let samples = count.and_then(|c| c.parse::<usize>().ok()).ok_or_else(|| bad(count, "the sample count NPTS"))?;
    let interval = dt.and_then(|d| number(d).ok()).ok_or_else(|| bad(dt, "the sampling interval DT in seconds"))?;
    interval_in_range(block, index, interval)?;
    Ok((samples, interval))
}

/// Refuses a sampling interval (s) that no recorder has.
pub(super) fn interval_in_range(block: &Block, index: usize, dt: f64) -> Result<(), ReadError> {
    if (1e-5..=1.0).contains(&dt) {
        return Ok(());
    }
    let expected = "0.00001 to 1 s";
    Err(block.at(index, Problem::OutOfRange { what: "the sampling interval", found: dt, unit: " s", expected }))
}

/// The unit, from the line `ACCELERATION TIME SERIES IN UNITS OF G`.
fn unit(head: &Block, count_line: usize) -> Result<AccelerationUnit, ReadError> {
    let above = head.part(0, count_line);
    let (index, line) = above.find("units of").ok_or_else(|| {
        head.missing("the line with the unit (`... IN UNITS OF G`)", "a PEER file states its unit on its third line")
    })?;
    let lower = line.to_lowercase();
    if lower.contains("velocity") || lower.contains("displacement") {
        let expected = "an acceleration (an .AT2 file, not .VT2 or .DT2)";
        return Err(head.at(index, Problem::WrongKind { found: excerpt(line), expected }));
    }
    let word = after(line, "units of").and_then(|r| r.split_whitespace().next()).unwrap_or("");
    let word = word.trim_end_matches(['.', ',', ';']);
    word.parse().map_err(|_| head.at(index, Problem::Unit { found: word.to_owned() }))
}
