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
    /// Displacement only: stated standard deviation of the noise that the controller saw, SI.
    pub loop_noise: Option<f64>,
    /// A file without its column is read without the channel.
    pub optional: bool,
}

/// A column, or a stated step.
#[derive(Debug, Clone, PartialEq)]
pub enum Origin {
    /// The column, or the variable of a MATLAB file.
    Column(String),
    /// Velocity only: the slope of this column, a displacement; the unit is the column's.
    Slope(String),
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
    for (channel, source) in sources.iter() {
        let same = |other: &ChannelSource| matches!((&source.origin, &other.origin), (Origin::Column(a), Origin::Column(b)) if a == b);
        if let Some((first, _)) = sources.iter().take_while(|(c, _)| *c != channel).find(|(_, other)| same(other)) {
            let problem = format!("takes the column of {first}; two channels cannot share one, give {channel} its own");
            let place = section.get(channel.name()).map_or_else(|| table.place(), |e| e.place());
            return Err(place.refuse(Problem::Contradiction(problem)));
        }
    }
    if sources.get(Channel::Time).is_none() {
        let remedy = "write `time = { column = \"...\", unit = \"s\" }`, or `{ step = 0.001, unit = \"s\" }` where the file has none";
        return Err(table.refuse(Problem::Missing { key: "time", remedy }));
    }
    Ok(sources)
}

fn source(channel: Channel, entry: &Entry<'_>) -> Result<ChannelSource, RecordingError> {
    let section = entry.section()?;
    let differentiate = match section.get("differentiate") {
        Some(entry) if channel == Channel::Velocity => entry.boolean()?,
        Some(entry) => return Err(entry.refuse(Problem::Contradiction(ONLY_VELOCITY.to_owned()))),
        None => false,
    };
    let measured = if differentiate { Channel::Displacement } else { channel };
    let unit = unit_of(measured, &section.required("unit", "write the unit its column is in")?)?;
    let step = if channel == Channel::Time { section.get("step") } else { None };
    let origin = if let Some(step) = step {
        Origin::Step(step.positive()? * unit.factor)
    } else {
        let column = section.required("column", "write the heading of its column")?.string()?.trim().to_owned();
        if differentiate { Origin::Slope(column) } else { Origin::Column(column) }
    };
    let noise = section.get("noise").map(|e| noise(&e)).transpose()?.map(|n| n * unit.factor);
    let loop_noise = match section.get("loop_noise") {
        Some(entry) if channel == Channel::Displacement => Some(entry.not_negative()? * unit.factor),
        Some(entry) => return Err(entry.refuse(Problem::Contradiction(ONLY_DISPLACEMENT.to_owned()))),
        None => None,
    };
    let optional = section.get("optional").map(|e| Ok((e.boolean()?, e))).transpose()?;
    if let Some((true, entry)) = &optional
        && !OPTIONAL.contains(&channel)
    {
        return Err(
            entry.refuse(Problem::Contradiction(format!("every file must hold {channel}; leave `optional` out")))
        );
    }
    section.finish()?;
    Ok(ChannelSource { origin, unit, noise, loop_noise, optional: optional.is_some_and(|(value, _)| value) })
}

/// A standard deviation that a sensor can have.
fn noise(entry: &Entry<'_>) -> Result<f64, RecordingError> {
    let value = entry.positive()?;
    if (1e-15..=1e12).contains(&value) {
        return Ok(value);
    }
    Err(entry.refuse(Problem::OutOfRange { value, expected: "1e-15 to 1e12 is expected, in the channel's unit" }))
}

/// Channels that one file of an experiment may hold and another not.
const OPTIONAL: [Channel; 6] = [
    Channel::Disturbance,
    Channel::Velocity,
    Channel::Acceleration,
    Channel::PressureDifference,
    Channel::SupplyPressure,
    Channel::SpecimenAcceleration,
];

const ONLY_DISPLACEMENT: &str = "the loop is closed around displacement; leave `loop_noise` out of every other channel";

const ONLY_VELOCITY: &str = "only velocity can be the slope of another column; leave `differentiate` out";

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
