//! `[channels]`: which column each channel is, and in which unit.

use crate::recording::channel::{Channel, PerChannel};
use crate::recording::document::{Entry, Section};
use crate::recording::error::{Problem, RecordingError, nearest};
use crate::recording::unit::{self, NUMBER, UNITS, Unit};

/// Where a channel comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelSource {
    /// Its column, or for time a stated step.
    pub origin: Origin,
    /// The unit of the column.
    pub unit: Unit,
    /// Stated standard deviation of its noise, SI.
    pub noise: Option<f64>,
}

/// A column, or a stated step.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// The column, or the variable of a MATLAB file.
    Column(String),
    /// Time only: the file has no time column; its rows are this far apart, s.
    Step(f64),
}

/// Reads `[channels]`.
pub(super) fn read(root: &Section<'_>) -> Result<PerChannel<ChannelSource>, RecordingError> {
    let table = root.required("channels", "write a [channels] table that gives each channel its column and unit")?;
    let section = table.section()?;
    let mut sources = PerChannel::default();
    for channel in Channel::ALL {
        if let Some(entry) = section.get(channel.name()) {
            sources.set(channel, source(channel, &entry)?);
        }
    }
    section.finish()?;
    if sources.get(Channel::Time).is_none() {
        let remedy = "write `time = { column = \"...\", unit = \"s\" }`, or `{ step = 0.001, unit = \"s\" }` where the file has none";
        return Err(table.refuse(Problem::Missing { key: "time", remedy }));
    }
    Ok(sources)
}

fn source(channel: Channel, entry: &Entry<'_>) -> Result<ChannelSource, RecordingError> {
    let section = entry.section()?;
    let unit = unit_of(channel, &section.required("unit", "write the unit its column is in")?)?;
    let step = if channel == Channel::Time { section.get("step") } else { None };
    let origin = match step {
        Some(step) => Origin::Step(step.positive()? * unit.factor),
        None => {
            Origin::Column(section.required("column", "write the heading of its column")?.string()?.trim().to_owned())
        }
    };
    let noise = section.get("noise").map(|e| e.positive()).transpose()?.map(|n| n * unit.factor);
    section.finish()?;
    Ok(ChannelSource { origin, unit, noise })
}

fn unit_of(channel: Channel, entry: &Entry<'_>) -> Result<Unit, RecordingError> {
    let symbol = entry.string()?;
    let Some(unit) = Unit::named(symbol) else {
        return Err(entry.refuse(Problem::NotAChoice {
            found: symbol.to_owned(),
            choices: unit::symbols(),
            suggestion: nearest(symbol, UNITS.iter().map(|u| u.symbol)),
        }));
    };
    let dimensions = channel.dimensions();
    if dimensions.contains(&unit.dimension) {
        return Ok(unit);
    }
    let choices: Vec<&str> =
        UNITS.iter().chain([&NUMBER]).filter(|u| dimensions.contains(&u.dimension)).map(|u| u.symbol).collect();
    Err(entry.refuse(Problem::UnitOfOtherKind { channel, unit: symbol.to_owned(), choices: choices.join(" ") }))
}
