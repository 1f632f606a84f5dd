//! K-NET and KiK-net ASCII.
//!
//! Seventeen lines of header, then integer counts, eight a line; `Scale Factor 3920(gal)/6182761` turns them into gal.
//! The counts carry the digitiser's offset, and the stated peak is that of the record less its mean; so is the record
//! given here.

use super::super::{AccelerationUnit, Fact, Format, Record, peak};
use super::error::{Problem, ReadError};
use super::peer::interval_in_range;
use super::text::{Block, Stated, after, excerpt, first_number};

/// Header keys as the file writes them, lower case, and as facts are named here.
const KEYS: [(&str, &str); 12] = [
    ("origin time", "origin time"),
    ("lat.", "latitude"),
    ("long.", "longitude"),
    ("depth", "depth"),
    ("mag.", "magnitude"),
    ("station code", "station"),
    ("record time", "record time"),
    ("sampling freq", "sampling"),
    ("duration time", "duration"),
    ("dir.", "component"),
    ("scale factor", "scale factor"),
    ("max. acc.", "peak acceleration"),
];

pub(super) fn read(block: &Block) -> Result<Record, ReadError> {
    let head = block.part(0, 24);
    let memo =
        head.find("memo").ok_or_else(|| block.missing("the line `Memo.`", "it ends the header of a K-NET file"))?;
    let (rate_line, rate) = quantity(&head, "sampling freq", "the line `Sampling Freq(Hz)`")?;
    let dt = 1.0 / rate;
    interval_in_range(block, rate_line, dt)?;
    let scale = scale_factor(&head)?;
    let counts = block.part(memo.0 + 1, block.lines.len()).numbers(Some(9))?;
    let (duration_line, duration) = quantity(&head, "duration time", "the line `Duration Time(s)`")?;
    // The header states whole seconds.
    if (counts.len() as f64 * dt - duration).abs() > 1.0 {
        return Err(block.contradiction(
            duration_line,
            "duration",
            (format!("the header says {duration} s"), format!("{} samples at {rate} Hz are there", counts.len())),
            "download the file again",
        ));
    }
    // Files written here say that they have no offset to take out.
    let offset = !memo.1.contains(crate::motion::write::NO_OFFSET);
    let mean = if offset { counts.iter().sum::<f64>() / counts.len().max(1) as f64 } else { 0.0 };
    let acceleration: Vec<f64> = counts.iter().map(|c| (c - mean) * scale).collect();
    check_peak(&head, &acceleration)?;
    let mut facts: Vec<Fact> = KEYS.iter().filter_map(|&(needle, key)| fact(&head, needle, key)).collect();
    let unit = AccelerationUnit::CentimetrePerSecondSquared;
    facts.push(Fact { key: "unit", value: unit.symbol().into(), line: rate_line });
    let component = facts.iter().find(|f| f.key == "component").map_or_else(String::new, |f| f.value.clone());
    Ok(Record { name: block.name(), dt, acceleration, component, format: Format::KNet, facts })
}

/// What the header says under a key: everything after the label's word and unit.
fn fact(head: &Block, needle: &str, key: &'static str) -> Option<Fact> {
    let (index, line) = head.lines.iter().enumerate().find(|(_, l)| l.to_lowercase().starts_with(needle))?;
    let value = line.get(18..).unwrap_or("").trim().to_owned();
    Some(Fact { key, value, line: head.number(index) })
}

/// The number on a header line, and the line's index.
fn quantity(head: &Block, needle: &str, expected: &'static str) -> Result<(usize, f64), ReadError> {
    let remedy = "a K-NET file has it in its header; download it again";
    let (index, line) = head.find(needle).ok_or_else(|| head.missing(expected, remedy))?;
    let rest = after(line, ")").unwrap_or(line);
    let value = first_number(rest).and_then(|n| n.parse().ok()).filter(|v| *v > 0.0);
    let problem = || head.at(index, Problem::NotANumber { found: excerpt(rest), expected: "a positive number" });
    Ok((index, value.ok_or_else(problem)?))
}

/// The size of a count, m/s².
fn scale_factor(head: &Block) -> Result<f64, ReadError> {
    let remedy = "without it counts cannot be turned into acceleration; download the file again";
    let (index, line) = head.find("scale factor").ok_or_else(|| head.missing("the line `Scale Factor`", remedy))?;
    let rest = line.get("scale factor".len()..).unwrap_or("");
    let bad = || {
        let expected = "a scale such as 3920(gal)/6182761";
        head.at(index, Problem::NotANumber { found: excerpt(rest), expected })
    };
    let (numerator, denominator) = rest.split_once('/').ok_or_else(bad)?;
    if !numerator.to_lowercase().contains("(gal)") {
        return Err(head.at(index, Problem::Unit { found: excerpt(numerator) }));
    }
    let top: f64 = first_number(numerator).and_then(|n| n.parse().ok()).ok_or_else(bad)?;
    let bottom: f64 = first_number(denominator).and_then(|n| n.parse().ok()).filter(|d| *d > 0.0).ok_or_else(bad)?;
    Ok(top / bottom * AccelerationUnit::CentimetrePerSecondSquared.in_si())
}

/// Compares the stated peak with the data less their mean.
fn check_peak(head: &Block, acceleration: &[f64]) -> Result<(), ReadError> {
    let Some((index, line)) = head.find("max. acc.") else { return Ok(()) };
    let Some(stated) = after(line, ")").and_then(Stated::first_in) else { return Ok(()) };
    let found = peak(acceleration) / AccelerationUnit::CentimetrePerSecondSquared.in_si();
    if stated.agrees(found) {
        return Ok(());
    }
    Err(head.contradiction(
        index,
        "peak acceleration",
        (format!("the header says {} gal", stated.text), format!("the data reach {found:.3} gal")),
        "download the file again, or correct the scale factor",
    ))
}
