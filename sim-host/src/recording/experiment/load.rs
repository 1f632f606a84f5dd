//! From the files of `[[runs]]` to runs in SI on an even grid.

use super::{ChannelSource, LEAST_SAMPLES, Origin, RunEntry};
use crate::digits;
use crate::files::layout::Stated;
use crate::motion::read::STEPS;
use crate::recording::channel::{Channel, PerChannel};
use crate::recording::clock::{self, Clock, Grid, NoGrid};
use crate::recording::error::{Place, Problem, RecordingError};
use crate::recording::run::{Run, Use, lately};
use crate::recording::signal::{filled, slope};
use crate::recording::table::{Heading, Table};
use crate::recording::{file, unit};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads every run; a file that several runs share is read once.
pub(super) fn runs(
    entries: &[RunEntry],
    sources: &PerChannel<ChannelSource>,
    folder: &Path,
    layout: &Stated,
) -> Result<(Vec<(Run, Option<Use>)>, Vec<String>), RecordingError> {
    let mut tables: BTreeMap<PathBuf, Loaded<'_>> = BTreeMap::new();
    let mut runs = Vec::with_capacity(entries.len());
    for entry in entries {
        let path = folder.join(&entry.file);
        if !tables.contains_key(&path) {
            tables.insert(path.clone(), table(&path, sources, &entry.place, layout)?);
        }
        let Some(loaded) = tables.get(&path) else { continue };
        let shared = entries.iter().filter(|e| e.file == entry.file).count() > 1;
        runs.push((run(entry, &path, loaded, sources, shared)?, entry.stated));
    }
    let said = |(path, loaded): (&PathBuf, &Loaded<'_>)| {
        loaded.table.notes.iter().map(|note| format!("{}: {note}", path.display())).collect::<Vec<_>>()
    };
    let notes = tables.iter().flat_map(said).collect();
    Ok((runs, notes))
}

/// A file's columns with the channels they are.
struct Loaded<'a> {
    channels: Vec<Wanted<'a>>,
    table: Table,
}

/// A column that a channel is made from.
struct Wanted<'a> {
    channel: Channel,
    column: &'a str,
    unit: unit::Unit,
    differentiate: bool,
    optional: bool,
}

/// The channels that have a column, in the order of the table's columns.
fn columns(sources: &PerChannel<ChannelSource>) -> Vec<Wanted<'_>> {
    sources
        .iter()
        .filter_map(|(channel, source)| {
            let (column, differentiate) = match &source.origin {
                Origin::Column(name) => (name.as_str(), false),
                Origin::Slope(name) => (name.as_str(), true),
                Origin::Step(_) => return None,
            };
            Some(Wanted { channel, column, unit: source.unit, differentiate, optional: source.optional })
        })
        .collect()
}

fn table<'a>(
    path: &Path,
    sources: &'a PerChannel<ChannelSource>,
    stated: &Place,
    layout: &Stated,
) -> Result<Loaded<'a>, RecordingError> {
    if !path.exists() {
        let problem =
            format!("there is no file {}; correct `file`, which is relative to the experiment", path.display());
        return Err(stated.clone().refuse(Problem::Contradiction(problem)));
    }
    let mut channels = columns(sources);
    if channels.iter().any(|w| w.optional) {
        let headings = file::headings_as(path, layout)?;
        channels.retain(|w| !w.optional || headings.iter().any(|h| h.text == w.column || h.name == w.column));
    }
    let names: Vec<&str> = channels.iter().map(|w| w.column).collect();
    let table = file::read_as(path, &names, layout)?;
    for (wanted, heading) in channels.iter().zip(&table.headings) {
        Heading::agrees(heading, wanted.unit, Place::line(path, 1).column(wanted.column))?;
    }
    Ok(Loaded { channels, table })
}

fn run(
    entry: &RunEntry,
    path: &Path,
    Loaded { channels: wanted, table }: &Loaded<'_>,
    sources: &PerChannel<ChannelSource>,
    shared: bool,
) -> Result<Run, RecordingError> {
    let rows = table.columns.first().map_or(0, Vec::len);
    let stamps = stamps(table, sources, rows);
    let (from, to) = window(entry, &stamps);
    if to - from < LEAST_SAMPLES {
        let place = if entry.from_s.is_some() || entry.to_s.is_some() {
            let (first, last) = (stamps.first().unwrap_or(&0.0), stamps.last().unwrap_or(&0.0));
            format!("between `from_s` and `to_s` (the file runs from {first} to {last} s)")
        } else {
            format!("in {}", path.display())
        };
        return Err(entry.place.clone().refuse(Problem::TooShort { found: to - from, least: LEAST_SAMPLES, place }));
    }
    let grid = clock::lay(&stamps[from..to]).map_err(|e| no_grid(e, path))?;
    if !STEPS.contains(&grid.dt) {
        let (step, rate) = (digits::stated(grid.dt), digits::stated(1.0 / grid.dt));
        let problem = format!(
            "steps of {step} s are {rate} Hz, where a recording has 5 Hz to 20 kHz; correct the unit of the time column"
        );
        return Err(Place::file(path).refuse(Problem::Contradiction(problem)));
    }
    let mut channels = PerChannel::default();
    let mut noise = PerChannel::default();
    for (&Wanted { channel, unit, differentiate, .. }, column) in wanted.iter().zip(&table.columns) {
        if channel != Channel::Time {
            let samples = on_grid(&grid, &column[from..to], unit.factor);
            channels.set(channel, if differentiate { slope(&samples, grid.dt) } else { samples });
        }
        if let Some(stated) = sources.get(channel).and_then(|s| s.noise) {
            noise.set(channel, stated);
        }
    }
    let Grid { start, dt, rows, clock } = grid;
    let time: Vec<f64> = (0..rows.len()).map(|k| start + k as f64 * dt).collect();
    Ok(Run {
        name: if shared { part_name(entry, &time, dt) } else { entry.file.clone() },
        path: path.to_path_buf(),
        dt,
        time,
        channels,
        noise,
        loop_noise: sources.get(Channel::Displacement).and_then(|s| s.loop_noise),
        law: entry.law.clone(),
        shaping: entry.shaping,
        controller_rate_hz: entry.controller_rate_hz,
        purpose: entry.stated.unwrap_or(Use::Fit),
        cut: from > 0,
        error_before: error_before(wanted, table, from) * dt,
        sent_before: lately(recorded_before(wanted, table, from, Channel::Command).unwrap_or_default(), dt),
        elapsed: from as f64 * dt,
        clock: Clock { ..clock },
    })
}

/// Sum of reference less displacement, m, over the rows before the first that is used.
fn error_before(wanted: &[Wanted<'_>], table: &Table, from: usize) -> f64 {
    let of = |channel| recorded_before(wanted, table, from, channel);
    let both = of(Channel::Reference).zip(of(Channel::Displacement));
    both.map_or(0.0, |(reference, displacement)| reference.iter().zip(displacement).map(|(r, x)| r - x).sum())
}

/// A channel over these rows, SI.
fn recorded_before(wanted: &[Wanted<'_>], table: &Table, from: usize, channel: Channel) -> Option<Vec<f64>> {
    let is = |(wanted, column): &(&Wanted<'_>, &Vec<f64>)| wanted.channel == channel && !column.is_empty();
    let (wanted, column) = wanted.iter().zip(&table.columns).find(is)?;
    Some(filled(&column[..from]).into_iter().map(|value| value * wanted.unit.factor).collect())
}

fn part_name(entry: &RunEntry, time: &[f64], dt: f64) -> String {
    let first = entry.from_s.or_else(|| time.first().copied()).unwrap_or(0.0);
    let last = entry.to_s.or_else(|| time.last().map(|t| t + dt)).unwrap_or(0.0);
    format!("{} ({first} to {last} s)", entry.file)
}

fn stamps(table: &Table, sources: &PerChannel<ChannelSource>, rows: usize) -> Vec<f64> {
    match sources.get(Channel::Time).map(|s| (&s.origin, s.unit)) {
        Some((Origin::Step(step), _)) => (0..rows).map(|k| k as f64 * step).collect(),
        // Time is the first channel, so the table's first column is its.
        Some((Origin::Column(_) | Origin::Slope(_), unit)) => {
            table.columns.first().map_or_else(Vec::new, |c| c.iter().map(|t| t * unit.factor).collect())
        }
        None => Vec::new(),
    }
}

/// The rows from the first stamp at or after `from_s` up to, not including, the first at or after `to_s`.
fn window(entry: &RunEntry, stamps: &[f64]) -> (usize, usize) {
    let at = |limit: f64| stamps.iter().position(|&t| t >= limit).unwrap_or(stamps.len());
    let from = entry.from_s.map_or(0, at);
    let to = entry.to_s.map_or(stamps.len(), at);
    (from.min(to), to)
}

fn on_grid(grid: &Grid, column: &[f64], factor: f64) -> Vec<f64> {
    grid.rows.iter().map(|row| row.map_or(f64::NAN, |r| column[r] * factor)).collect()
}

fn no_grid(reason: NoGrid, path: &Path) -> RecordingError {
    let text = match reason {
        NoGrid::TooFew => "holds fewer than two times; is the right column given for `time`?".to_owned(),
        NoGrid::Still { first, last } => {
            format!("runs from {first} s to {last} s and does not advance; is the right column given for `time`?")
        }
        NoGrid::TooSparse { step, span } => format!(
            "covers {span} s in steps of {step} s with most of them missing; cut the file with `from_s` and `to_s`"
        ),
    };
    Place::file(path).column("time").refuse(Problem::NoTimeStep(text))
}
