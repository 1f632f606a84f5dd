//! Which column is which channel: by its name, and by whether its samples can be it.

use super::Recording;
use crate::recording::channel::Channel;
use crate::recording::clock;
use crate::recording::signal::{deviation, filled, quantile};
use crate::recording::table::Heading;
use crate::recording::unit::Unit;

/// What is known of a column.
#[derive(Debug, Clone)]
pub struct Facts {
    /// Its heading.
    pub heading: Heading,
    /// Its samples in the file's unit, gaps filled.
    pub samples: Vec<f64>,
    /// Smallest and largest sample.
    pub range: (f64, f64),
    /// Step, where the samples rise evenly as time does.
    pub step: Option<f64>,
}

/// A channel proposed for a column.
#[derive(Debug, Clone)]
pub struct Choice {
    /// The channel.
    pub channel: Channel,
    /// Place of its column among the facts.
    pub column: usize,
    /// The unit, where something speaks for one.
    pub unit: Option<Unit>,
    /// What speaks for the column and the unit.
    pub evidence: Vec<String>,
    /// True where only a name or a size speaks for it, so that the user must confirm it.
    pub doubtful: bool,
}

/// Words of a heading that speak for a channel, the telling ones first, those of other languages last; a heading takes the first that fits.
const WORDS: [(Channel, &[&str]); 9] = [
    (Channel::SupplyPressure, &["supply"]),
    (Channel::PressureDifference, &["delta p", "deltap", "dp", "pressure", "pl", "differenzdruck", "druckdifferenz"]),
    (Channel::SpecimenAcceleration, &["specimen", "roof", "rf", "floor", "2f", "storey"]),
    (
        Channel::Reference,
        &[
            "reference",
            "ref",
            "setpoint",
            "target",
            "desired",
            "dis command",
            "disp command",
            "position command",
            "qg",
            "soll",
            "consigne",
            "consigna",
        ],
    ),
    (Channel::Acceleration, &["acceleration", "accel", "acc", "1f", "acc table", "beschleunigung", "acel"]),
    (Channel::Velocity, &["velocity", "vel", "speed", "geschwindigkeit", "vitesse"]),
    (
        Channel::Command,
        &[
            "command",
            "cmd",
            "voltage",
            "valve",
            "servo",
            "drive",
            "vir",
            "u",
            "force",
            "stellsignal",
            "stellgröße",
            "stellgroesse",
            "stellwert",
            "ventil",
            "commande",
        ],
    ),
    (
        Channel::Displacement,
        &[
            "displacement",
            "disp",
            "dis",
            "position",
            "pos",
            "lvdt",
            "stroke",
            "qm",
            "x",
            "ist",
            "weg",
            "kolbenweg",
            "déplacement",
            "deplacement",
            "desplazamiento",
        ],
    ),
    (Channel::Time, &["time", "t", "seconds"]),
];

/// Facts of every column.
pub(super) fn facts(recording: &Recording) -> Vec<Facts> {
    let all = recording.headings.iter().zip(&recording.table.columns);
    all.map(|(heading, column)| {
        let samples = filled(column);
        let range = (quantile(&samples, 0.0), quantile(&samples, 1.0));
        Facts { heading: heading.clone(), step: even_step(column), samples, range }
    })
    .collect()
}

/// The step of a column that rises evenly; none for any other.
fn even_step(column: &[f64]) -> Option<f64> {
    let rising = column.windows(2).filter(|w| w[1] > w[0]).count();
    if rising * 100 < (column.len() - 1) * 95 {
        return None;
    }
    let grid = clock::lay(column).ok()?;
    (grid.clock.jitter < 0.3 * grid.dt).then_some(grid.dt)
}

/// Assigns each column to at most one channel, each channel to at most one column: telling names first.
pub(super) fn choose(facts: &[Facts]) -> Vec<Choice> {
    let mut scored: Vec<(u32, Channel, usize)> = Vec::new();
    for (column, fact) in facts.iter().enumerate() {
        for channel in Channel::ALL {
            let score = score(channel, fact);
            if score > 0 {
                scored.push((score, channel, column));
            }
        }
    }
    // Ties go to the column that comes first.
    scored.sort_by(|a, b| b.0.cmp(&a.0).then(a.2.cmp(&b.2)));
    let mut choices: Vec<Choice> = Vec::new();
    for (_, channel, column) in scored {
        if choices.iter().all(|c| c.channel != channel && c.column != column) {
            choices.push(choice(channel, column, &facts[column]));
        }
    }
    choices.sort_by_key(|c| c.channel);
    choices
}

/// Columns that are no channel.
pub(super) fn unused<'a>(facts: &'a [Facts], choices: &'a [Choice]) -> impl Iterator<Item = &'a Facts> {
    let free = |(column, _): &(usize, &Facts)| choices.iter().all(|c| c.column != *column);
    facts.iter().enumerate().filter(free).map(|(_, fact)| fact)
}

/// Columns that are named as a channel that no column is, and cannot be it: what keeps each from it, in words.
pub(super) fn misfits(facts: &[Facts], choices: &[Choice]) -> Vec<String> {
    let missing = |channel: &Channel| choices.iter().all(|c| c.channel != *channel);
    let all = unused(facts, choices).filter_map(|fact| {
        let channel =
            Channel::ALL.into_iter().filter(missing).find(|&channel| named(channel, &fact.heading.name) > 0)?;
        let unit = fact.heading.unit.as_deref().and_then(Unit::in_header);
        let why = match unit.filter(|unit| !channel.dimensions().contains(&unit.dimension)) {
            Some(unit) => {
                format!("is in {}, which is no unit of it: convert it by the sensor's calibration", unit.symbol)
            }
            None if deviation(&fact.samples) > 0.0 => return None,
            None => "never changes, and is not used".to_owned(),
        };
        Some(format!("column `{}` is named as {channel} and {why}", fact.heading.text))
    });
    all.collect()
}

/// How well a column can be a channel; nothing where its samples or its unit cannot.
fn score(channel: Channel, fact: &Facts) -> u32 {
    let rises = fact.step.is_some();
    if (channel == Channel::Time) != rises {
        return 0;
    }
    let stated = fact.heading.unit.as_deref().and_then(Unit::in_header);
    if stated.is_some_and(|u| !channel.dimensions().contains(&u.dimension)) {
        return 0;
    }
    let name = named(channel, &fact.heading.name);
    match (channel, name) {
        // Time is known by its samples whatever it is called.
        (Channel::Time, name) => 2 + name,
        (_, 0) => 0,
        (_, name) if deviation(&fact.samples) > 0.0 => name + u32::from(stated.is_some()),
        _ => 0,
    }
}

/// How well a name fits a channel, if no other channel's word takes it first: whole words count more than parts.
fn named(channel: Channel, name: &str) -> u32 {
    let name = name.to_lowercase().replace(['_', '-', '.'], " ");
    let words: Vec<&str> = name.split_whitespace().collect();
    let fits = |candidates: &[&str]| -> u32 {
        let whole = candidates.iter().any(|c| *c == name);
        let word = candidates.iter().any(|c| words.contains(c) || (c.contains(' ') && name.contains(c)));
        let start = candidates.iter().any(|c| c.len() > 2 && words.iter().any(|w| w.starts_with(c)));
        if whole {
            9
        } else if word {
            6
        } else if start {
            4
        } else {
            0
        }
    };
    let Some((first, candidates)) = WORDS.iter().find(|(_, c)| fits(c) > 0) else { return 0 };
    if *first != channel {
        return 0;
    }
    // The table itself rather than an actuator or a storey beside it.
    fits(candidates) + u32::from(words.contains(&"table"))
}

fn choice(channel: Channel, column: usize, fact: &Facts) -> Choice {
    let (low, high) = fact.range;
    let evidence = match fact.step {
        Some(step) => format!("rises evenly from {low} to {high} in steps of {step:.6}"),
        None => format!("by its name; runs from {low:.5} to {high:.5}"),
    };
    Choice { channel, column, unit: None, evidence: vec![evidence], doubtful: fact.step.is_none() }
}
