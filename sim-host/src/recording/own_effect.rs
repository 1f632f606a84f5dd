//! Effects of a user's own: `[[effect]]` in an experiment, in a `table.toml`, or in a file of them.

use super::document::read_text;
use super::document::{Entry, Section, Source, parse};
use super::error::{Problem, RecordingError, nearest};
use crate::plant::effects::own::{Key, Own, Stated, StatedParameter, found, register};
use crate::plant::effects::{self, Stage};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

const PLACES: [Stage; 7] =
    [Stage::Command, Stage::Valve, Stage::Flow, Stage::Actuator, Stage::Table, Stage::Payload, Stage::Sensor];

/// Reads a file of effects and makes them known: all its entries, and beside them what is wrong with each that is refused.
pub fn load(path: &Path) -> Result<(Vec<&'static effects::Entry>, Vec<RecordingError>), RecordingError> {
    let text = read_text(path)?;
    let source = Source::new(path, &text);
    let document = parse(&source, &text)?;
    let root = Section::root(&source, &document);
    root.string("name")?;
    let list = root.required("effect", "write an [[effect]] for each effect of your own")?.list()?;
    // An experiment may be checked as well as a file that holds effects alone.
    if root.get("model").is_none() {
        root.finish()?;
    }
    let (mut entries, mut errors) = (Vec::new(), Vec::new());
    for item in &list {
        match one(item) {
            Ok(entry) if is_stated(&entries, entry) => errors.push(item.place().refuse(twice(entry))),
            Ok(entry) => entries.push(entry),
            Err(error) => errors.push(error),
        }
    }
    Ok((entries, errors))
}

/// The identifiers of the effects that a document states or names files of; the files join `inputs`.
pub(super) fn read(
    root: &Section<'_>,
    folder: &Path,
    inputs: &mut Vec<PathBuf>,
) -> Result<Vec<&'static str>, RecordingError> {
    let mut entries: Vec<&'static effects::Entry> = Vec::new();
    if let Some(files) = root.get("effect_files") {
        for file in files.list()? {
            let path = folder.join(file.string()?);
            let (more, errors) = load(&path)?;
            if let Some(error) = errors.into_iter().next() {
                return Err(error);
            }
            entries.extend(more);
            inputs.push(path);
        }
    }
    let stated = root.get("effect").map(|e| e.list()).transpose()?.unwrap_or_default();
    for item in &stated {
        entries.push(one(item)?);
    }
    for (i, entry) in entries.iter().enumerate() {
        if is_stated(&entries[..i], entry) {
            return Err(root.place().refuse(twice(entry)));
        }
    }
    Ok(entries.into_iter().map(|entry| entry.id).collect())
}

/// Whether an effect of this name was stated before.
fn is_stated(before: &[&'static effects::Entry], entry: &effects::Entry) -> bool {
    before.iter().any(|other| other.id == entry.id)
}

fn twice(entry: &effects::Entry) -> Problem {
    Problem::Contradiction(format!("the effect `{}` is stated twice; state it once", entry.id))
}

fn one(item: &Entry<'_>) -> Result<&'static effects::Entry, RecordingError> {
    let section = item.section()?;
    let id = section.required("id", "give the effect a name")?;
    let place =
        section.required("place", "say where it acts: command, valve, flow, actuator, table, payload or sensor")?;
    let states = section.get("states");
    let expression = section.required("expression", "write what the effect adds at its place")?;
    let parameters = section.required("parameters", "name each with { unit, low, high, start }")?;
    let mistaken = section.get("mistaken_for");
    let stated = Stated {
        id: id.string()?.to_owned(),
        stage: stage(&place)?,
        states: states.as_ref().map(strings).transpose()?.unwrap_or_default(),
        expression: expression.string()?.to_owned(),
        parameters: parameters
            .section()?
            .entries()
            .map(|(name, entry)| parameter(name, &entry))
            .collect::<Result<_, _>>()?,
        mistaken_for: mistaken.as_ref().map(strings).transpose()?.unwrap_or_default(),
    };
    section.finish()?;
    let own = Own::new(stated).map_err(|wrong| {
        let at = match &wrong.key {
            Key::Id => id.place(),
            Key::States => states.as_ref().map_or_else(|| section.place(), Entry::place),
            Key::Expression => expression.place(),
            Key::MistakenFor => mistaken.as_ref().map_or_else(|| section.place(), Entry::place),
            Key::Parameter(name) => named(&parameters, name).map_or_else(|| parameters.place(), |e| e.place()),
        };
        at.refuse(Problem::Contradiction(wrong.why))
    })?;
    register(own).map_err(|taken| id.refuse(Problem::Contradiction(taken.to_string())))
}

fn named<'a>(parameters: &Entry<'a>, name: &str) -> Option<Entry<'a>> {
    let section = parameters.section().ok()?;
    section.entries().find(|(key, _)| *key == name).map(|(_, entry)| entry)
}

fn stage(entry: &Entry<'_>) -> Result<Stage, RecordingError> {
    let found = entry.string()?;
    let names = PLACES.map(Stage::name);
    PLACES.into_iter().find(|stage| stage.name() == found).ok_or_else(|| {
        entry.refuse(Problem::NotAChoice {
            found: found.to_owned(),
            choices: names.join(", "),
            suggestion: nearest(found, names),
        })
    })
}

fn strings(entry: &Entry<'_>) -> Result<Vec<String>, RecordingError> {
    entry.list()?.iter().map(|item| item.string().map(str::to_owned)).collect()
}

fn parameter(name: &str, entry: &Entry<'_>) -> Result<StatedParameter, RecordingError> {
    let section = entry.section()?;
    let number = |key, remedy| section.required(key, remedy)?.number();
    let stated = StatedParameter {
        name: name.to_owned(),
        unit: section.required("unit", "state its SI unit, \"1\" for a number")?.string()?.to_owned(),
        low: number("low", "state the smallest value that makes sense")?,
        high: number("high", "state the largest value that makes sense")?,
        start: number("start", "state where a fit starts")?,
        meaning: section.string("meaning")?.unwrap_or_else(|| "a parameter of the user's own".to_owned()),
    };
    section.finish()?;
    Ok(stated)
}

/// Effects of a user's own among these, as `[[effect]]` text that [`load`] reads back.
pub(crate) fn to_toml<'a>(ids: impl Iterator<Item = &'a str>) -> String {
    let mut text = String::new();
    for (stated, _) in ids.filter_map(found) {
        text += "\n";
        text += &one_to_toml(stated);
    }
    text
}

/// One effect as `[[effect]]` text.
pub(crate) fn one_to_toml(stated: &Stated) -> String {
    let mut text = format!("[[effect]]\nid = {:?}\nplace = {:?}\n", stated.id, stated.stage.name());
    let _ = writeln!(text, "states = {:?}\nexpression = {:?}", stated.states, stated.expression);
    for p in &stated.parameters {
        let StatedParameter { name, unit, low, high, start, meaning } = p;
        let _ = writeln!(
            text,
            "parameters.{name} = {{ unit = {unit:?}, low = {low:?}, high = {high:?}, start = {start:?}, meaning = {meaning:?} }}"
        );
    }
    if !stated.mistaken_for.is_empty() {
        let _ = writeln!(text, "mistaken_for = {:?}", stated.mistaken_for);
    }
    text
}

#[cfg(test)]
mod tests;
