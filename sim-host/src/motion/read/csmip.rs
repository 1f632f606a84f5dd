//! CSMIP (CDMG, CESMD) Volume 2, `.V2`: acceleration, velocity and displacement of one or more channels.
//!
//! A channel ends with a line `/& --- END OF DATA FOR CHANNEL 1 ---`. Before each of its three blocks stands a line such
//! as `3251 POINTS OF ACCEL DATA EQUALLY SPACED AT  .020 SEC.  (UNITS: CM/SEC/SEC)`, or in newer files
//! `15200 points of accel data equally spaced at  .005 sec, in cm/sec2. (8f10.6)`. The header states the three peaks.

use super::super::{AccelerationUnit, Fact, Format, Record};
use super::Channel;
use super::error::{Problem, ReadError, listed};
use super::peer::interval_in_range;
use super::text::{Block, Stated, after, excerpt, first_number, signed_peak};

const FIELD_WIDTH: usize = 10;

/// The name of a block in its opening line, and of its peak in the header.
const BLOCKS: [(&str, &str); 3] = [
    ("points of accel data", "peak acceleration"),
    ("points of veloc data", "peak velocity"),
    ("points of displ data", "peak displacement"),
];

pub(super) fn read(block: &Block, channel: &Channel) -> Result<Record, ReadError> {
    let channels = channels(block);
    let labels: Vec<String> = channels.iter().map(label).collect();
    let chosen = select(block, &labels, channel)?;
    let part = channels[chosen];
    let data = accelerations(&part)?;
    let mut facts = facts(&part);
    facts.push(Fact { key: "unit", value: data.unit.symbol().into(), line: part.number(data.line) });
    facts.extend(first_of(&labels, channel));
    Ok(Record {
        name: block.name(),
        dt: data.dt,
        acceleration: data.values.iter().map(|a| a * data.unit.in_si()).collect(),
        component: labels[chosen].clone(),
        format: Format::Csmip,
        facts,
    })
}

/// The runs of lines that each hold a channel.
fn channels<'a>(block: &Block<'a>) -> Vec<Block<'a>> {
    let mut from = 0;
    let mut parts = Vec::new();
    for (index, line) in block.lines.iter().enumerate() {
        if line.trim_start().starts_with("/&") {
            parts.push(block.part(from, index));
            from = index + 1;
        }
    }
    if from < block.lines.len() {
        parts.push(block.part(from, block.lines.len()));
    }
    parts
}

/// The component, as in `CHAN  1:  90 DEG`.
fn label(part: &Block) -> String {
    let text = part.lines.iter().take(12).find_map(|l| after(l, "chan ").filter(|r| r.contains(':')));
    let name = text.and_then(|t| t.split_once(':')).map_or("", |(_, name)| name.trim());
    name.split("  ").next().unwrap_or("").trim().to_owned()
}

/// The index of the channel asked for.
pub(super) fn select(block: &Block, labels: &[String], channel: &Channel) -> Result<usize, ReadError> {
    let found = match channel {
        Channel::First => Some(0),
        Channel::Number(n) => n.checked_sub(1),
        Channel::Name(name) => labels.iter().position(|l| l.to_lowercase().contains(&name.to_lowercase())),
        Channel::Wrapped => None,
    };
    found
        .filter(|&i| i < labels.len())
        .ok_or_else(|| block.at(0, Problem::NoChannel { asked: channel.to_string(), available: listed(labels) }))
}

/// What is said where the first of several components was taken because nobody named one.
pub(super) fn first_of(labels: &[String], channel: &Channel) -> Option<Fact> {
    let several = *channel == Channel::First && labels.len() > 1;
    let value =
        || format!("the first of {} components is taken: {}; --channel names another", labels.len(), listed(labels));
    several.then(|| Fact { key: "layout", value: value(), line: 1 })
}

/// One channel's acceleration, in the file's unit.
struct Data {
    values: Vec<f64>,
    dt: f64,
    unit: AccelerationUnit,
    /// The index of the block's opening line.
    line: usize,
}

fn accelerations(part: &Block) -> Result<Data, ReadError> {
    let remedy = "a corrected accelerogram has one for each channel; download the file again";
    let mut data = None;
    for (i, (needle, peak_name)) in BLOCKS.into_iter().enumerate() {
        let Some((index, line)) = part.find(needle) else {
            if i == 0 {
                return Err(part.missing("the line `... POINTS OF ACCEL DATA EQUALLY SPACED AT ...`", remedy));
            }
            continue;
        };
        let values = values(part, index, line)?;
        check_peak(part, peak_name, &values)?;
        if i == 0 {
            let unit = unit(part, index, line)?;
            let text = after(line, "spaced at").and_then(first_number).and_then(|n| n.parse().ok());
            let expected = "the sampling interval in seconds after `SPACED AT`";
            let dt: f64 = text.ok_or_else(|| part.at(index, Problem::NotANumber { found: excerpt(line), expected }))?;
            interval_in_range(part, index, dt)?;
            data = Some(Data { values, dt, unit, line: index });
        }
    }
    data.ok_or_else(|| part.missing("an acceleration", remedy))
}

/// The values of the block that the line at `index` opens.
fn values(part: &Block, index: usize, line: &str) -> Result<Vec<f64>, ReadError> {
    let expected = "the sample count before `POINTS OF`";
    let count: usize = first_number(line)
        .and_then(|n| n.parse().ok())
        .ok_or_else(|| part.at(index, Problem::NotANumber { found: excerpt(line), expected }))?;
    let rest = part.part(index + 1, part.lines.len());
    let end = rest.find("points of").map_or(rest.lines.len(), |(i, _)| i);
    let values = rest.part(0, end).numbers(Some(width(line)))?;
    if values.len() == count {
        return Ok(values);
    }
    Err(part.contradiction(
        index,
        "number of samples",
        (format!("the header says {count} points"), format!("the block holds {} values", values.len())),
        "download the file again, or correct the count",
    ))
}

/// The width of a column, from a Fortran format such as `(8f10.6)`.
fn width(line: &str) -> usize {
    let format = line.rsplit_once('(').map_or("", |(_, f)| f).to_lowercase();
    let digits = format.split_once('f').map_or("", |(_, w)| w.split('.').next().unwrap_or(""));
    digits.parse().unwrap_or(FIELD_WIDTH)
}

/// The unit the opening line states.
fn unit(part: &Block, index: usize, line: &str) -> Result<AccelerationUnit, ReadError> {
    let word = after(line, "units:").or_else(|| after(line, " in ")).and_then(|r| r.split_whitespace().next());
    let word = word.unwrap_or("").trim_matches(['(', ')', '.', ',']);
    word.parse().map_err(|_| part.at(index, Problem::Unit { found: word.to_owned() }))
}

/// Compares a stated peak, sign included, with the data of its block; both stand in the same unit.
fn check_peak(part: &Block, name: &'static str, values: &[f64]) -> Result<(), ReadError> {
    let collapsed = |l: &str| l.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let Some((index, line)) = part.lines.iter().enumerate().take(45).find(|(_, l)| collapsed(l).starts_with(name))
    else {
        return Ok(());
    };
    let Some(stated) = line.split_once('=').and_then(|(_, r)| Stated::first_in(r)) else { return Ok(()) };
    let found = signed_peak(values, stated.value);
    if stated.agrees(found) {
        return Ok(());
    }
    Err(part.contradiction(
        index,
        name,
        (format!("the header says {}", stated.text), format!("the data reach {found}")),
        "download the file again, or correct the header",
    ))
}

/// What the text header states.
fn facts(part: &Block) -> Vec<Fact> {
    let keys =
        [("station no", "station"), ("earthquake", "event"), ("bandpass", "filter"), ("hypocenter", "hypocenter")];
    let mut facts = Vec::new();
    for (needle, key) in keys {
        if let Some((index, line)) = part.part(0, 25).find(needle) {
            facts.push(Fact { key, value: line.trim().to_owned(), line: part.number(index) });
        }
    }
    facts
}
