//! The model a user believes in, as `[model]` and `[effects.ID]` state it, in an experiment or in a `table.toml`.

use super::document::{Entry, Section, Source, parse, read_text, unknown_key};
use super::error::{Place, Problem, RecordingError, nearest};
use super::own_effect;
use crate::plant::effects;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

mod baseline;
mod signs;
mod text;

pub use baseline::{Baseline, ForceBalance, RigidMass, Servo};
use text::{line, list};

/// A baseline, the effects it already has, and what of it may be fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// The equations and their parameters.
    pub baseline: Baseline,
    /// Effects the model already has, in the order given.
    pub effects: Vec<StatedEffect>,
    /// What to re-estimate: a parameter of the baseline, an effect's identifier (all its parameters), or `ID.key`.
    pub fit: Vec<String>,
    /// Both sides are low-passed to this frequency, zero phase, before they are compared, Hz.
    pub bandwidth_hz: Option<f64>,
    /// What an identification said of each parameter's accuracy, by the parameter's name (`b0`, `coulomb_friction.force`).
    pub accuracy: BTreeMap<String, Accuracy>,
    /// Identifiers of the effects of the user's own that came with it, beside the library's.
    pub own: Vec<&'static str>,
}

/// How well a parameter is known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Accuracy {
    /// Standard deviation, in the parameter's unit.
    pub std: Option<f64>,
    /// Lower end of the 90 % interval.
    pub low: Option<f64>,
    /// Upper end of the 90 % interval.
    pub high: Option<f64>,
}

/// An effect that the model has.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedEffect {
    /// Its identifier (docs/effects.md).
    pub id: String,
    /// Parameters by key, in the units of docs/effects.md; what is left out starts at the library's own value.
    pub parameters: BTreeMap<String, f64>,
    /// Where it is stated, for messages.
    pub place: Place,
}

impl Model {
    /// Reads a `table.toml`: a file with `[model]` and `[effects]` alone.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        Self::from_text(path, &read_text(path)?)
    }

    /// The same from text at hand; `path` is what messages call it.
    pub fn from_text(path: &Path, text: &str) -> Result<Self, RecordingError> {
        let source = Source::new(path, text);
        let document = parse(&source, text)?;
        let root = Section::root(&source, &document);
        let folder = path.parent().unwrap_or(Path::new(""));
        let own = own_effect::read(&root, folder, &mut Vec::new())?;
        let model = Self { own, ..Self::stated(&root, &model_section(&root)?)? };
        let _ = (root.string("name")?, super::Described::read(&root)?);
        root.finish()?;
        Ok(model)
    }

    /// Reads `[model]` and `[effects]` of a document; `[model] file` takes them from a `table.toml` in `folder`, which
    /// joins `inputs`.
    pub(crate) fn read(root: &Section<'_>, folder: &Path, inputs: &mut Vec<PathBuf>) -> Result<Self, RecordingError> {
        let section = model_section(root)?;
        let mut own = own_effect::read(root, folder, inputs)?;
        let mut model = match section.get("file") {
            Some(file) => Self::from_file(&section, &file, folder, inputs),
            None => Self::stated(root, &section),
        }?;
        own.retain(|id| !model.own.contains(id));
        model.own.append(&mut own);
        Ok(model)
    }

    fn stated(root: &Section<'_>, section: &Section<'_>) -> Result<Self, RecordingError> {
        let mut accuracy = BTreeMap::new();
        let baseline = Baseline::read(section, &mut accuracy)?;
        let mut effects = section.get("effects").map(|e| listed(&e)).transpose()?.unwrap_or_default();
        if let Some(tables) = root.get("effects") {
            read_parameters(&tables.section()?, &mut effects, &mut accuracy)?;
        }
        let bandwidth_hz = section.get("bandwidth_hz").map(|e| e.positive()).transpose()?;
        let fit = section.get("fit").map(|e| fitted(&e, &baseline, &effects)).transpose()?.unwrap_or_default();
        section.finish()?;
        let model = Self { baseline, effects, fit, bandwidth_hz, accuracy, own: Vec::new() };
        model.check_library()?;
        Ok(model)
    }

    fn from_file(
        section: &Section<'_>,
        file: &Entry<'_>,
        folder: &Path,
        inputs: &mut Vec<PathBuf>,
    ) -> Result<Self, RecordingError> {
        let path = folder.join(file.string()?);
        let mut model = Self::load(&path)?;
        inputs.push(path);
        if let Some(fit) = section.get("fit") {
            model.fit = fitted(&fit, &model.baseline, &model.effects)?;
        }
        if let Some(bandwidth) = section.get("bandwidth_hz") {
            model.bandwidth_hz = Some(bandwidth.positive()?);
        }
        section.finish()?;
        Ok(model)
    }

    /// Refuses an effect, or a key of one, that the library does not hold.
    fn check_library(&self) -> Result<(), RecordingError> {
        let own = self.effects.iter().filter_map(|e| effects::own::found(&e.id)).map(|(_, entry)| entry.id);
        self.check_effects(&effects::identifiers().into_iter().chain(own).collect::<Vec<_>>())?;
        for effect in &self.effects {
            let parameters = effects::regional::stated(&effect.id, effect.parameters.keys().map(String::as_str))
                .map_or(&[][..], |entry| entry.parameters);
            let keys: Vec<&str> = parameters.iter().map(|parameter| parameter.key).collect();
            self.check_effect_keys(&effect.id, &keys)?;
            effect.check_signs(parameters)?;
            let own = self.fit.iter().filter_map(|f| f.strip_prefix(effect.id.as_str())?.strip_prefix('.'));
            if let Some(key) = own.into_iter().find(|key| !keys.contains(key)) {
                return Err(effect.place.clone().refuse(unknown_key(key, &keys)));
            }
        }
        Ok(())
    }

    /// Refuses an effect whose identifier is not among the known ones.
    pub fn check_effects(&self, known: &[&str]) -> Result<(), RecordingError> {
        for effect in &self.effects {
            if !known.contains(&effect.id.as_str()) {
                return Err(effect.place.clone().refuse(Problem::NotAChoice {
                    found: effect.id.clone(),
                    choices: "the effects of `shakedown effects`".to_owned(),
                    suggestion: nearest(&effect.id, known.iter().copied()),
                }));
            }
        }
        Ok(())
    }

    /// Refuses a parameter of `id` that is not among that effect's keys.
    pub fn check_effect_keys(&self, id: &str, keys: &[&str]) -> Result<(), RecordingError> {
        for effect in self.effects.iter().filter(|e| e.id == id) {
            if let Some(key) = effect.parameters.keys().find(|k| !keys.contains(&k.as_str())) {
                return Err(effect.place.clone().column(&format!("effects.{id}.{key}")).refuse(unknown_key(key, keys)));
            }
        }
        Ok(())
    }

    /// True where `fit` frees this parameter: a baseline's name, or an effect's key with its identifier before it.
    pub fn fits(&self, parameter: &str) -> bool {
        let owner = parameter.split('.').next();
        self.fit.iter().any(|f| f == parameter || Some(f.as_str()) == owner)
    }

    /// The model as the text of a `table.toml`, which [`Model::load`] reads back.
    pub fn to_toml(&self) -> String {
        let mut text = format!("[model]\nkind = \"{}\"\n", self.baseline.kind());
        for (name, value) in self.baseline.parameters() {
            line(&mut text, name, value, self.accuracy.get(name));
        }
        if let Some(bandwidth) = self.bandwidth_hz {
            line(&mut text, "bandwidth_hz", bandwidth, None);
        }
        list(&mut text, "fit", self.fit.iter().map(String::as_str));
        list(&mut text, "effects", self.effects.iter().map(|e| e.id.as_str()));
        for effect in self.effects.iter().filter(|e| !e.parameters.is_empty()) {
            let _ = write!(text, "\n[effects.{}]\n", effect.id);
            for (key, &value) in &effect.parameters {
                line(&mut text, key, value, self.accuracy.get(&format!("{}.{key}", effect.id)));
            }
        }
        text + &own_effect::to_toml(self.effects.iter().map(|e| e.id.as_str()))
    }
}

fn model_section<'a>(root: &Section<'a>) -> Result<Section<'a>, RecordingError> {
    root.required("model", "write a [model] table with its `kind`")?.section()
}

fn listed(entry: &Entry<'_>) -> Result<Vec<StatedEffect>, RecordingError> {
    let mut effects: Vec<StatedEffect> = Vec::new();
    for item in entry.list()? {
        let id = item.string()?.to_owned();
        if effects.iter().any(|e| e.id == id) {
            return Err(item.refuse(Problem::Contradiction(format!("`{id}` is listed twice; list it once"))));
        }
        effects.push(StatedEffect { id, parameters: BTreeMap::new(), place: item.place() });
    }
    Ok(effects)
}

fn read_parameters(
    tables: &Section<'_>,
    effects: &mut [StatedEffect],
    accuracy: &mut BTreeMap<String, Accuracy>,
) -> Result<(), RecordingError> {
    for (id, entry) in tables.entries() {
        let Some(effect) = effects.iter_mut().find(|e| e.id == id) else {
            let remedy =
                format!("`{id}` has parameters but is not in `effects` of [model]; add it there, or remove them");
            return Err(entry.refuse(Problem::Contradiction(remedy)));
        };
        effect.place = entry.place();
        for (key, value) in entry.section()?.entries() {
            let (number, known) = quantity(&value)?;
            effect.parameters.insert(key.to_owned(), number);
            known.map(|a| accuracy.insert(format!("{id}.{key}"), a));
        }
    }
    Ok(())
}

/// A parameter: a number, or a table with `value` and what is known of its accuracy.
fn quantity(entry: &Entry<'_>) -> Result<(f64, Option<Accuracy>), RecordingError> {
    if !entry.is_table() {
        return Ok((entry.number()?, None));
    }
    let section = entry.section()?;
    let value = section.required("value", "write the parameter's number")?.number()?;
    let accuracy = Accuracy { std: section.number("std")?, low: section.number("low")?, high: section.number("high")? };
    section.string("unit")?;
    section.finish()?;
    Ok((value, Some(accuracy)))
}

fn fitted(entry: &Entry<'_>, baseline: &Baseline, effects: &[StatedEffect]) -> Result<Vec<String>, RecordingError> {
    let names = baseline.names();
    entry
        .list()?
        .iter()
        .map(|item| {
            let name = item.string()?;
            let owner = name.split('.').next().unwrap_or(name);
            if names.contains(&name) || effects.iter().any(|e| e.id == owner) {
                return Ok(name.to_owned());
            }
            let known: Vec<&str> = names.iter().copied().chain(effects.iter().map(|e| e.id.as_str())).collect();
            Err(item.refuse(Problem::NotAChoice {
                found: name.to_owned(),
                choices: format!("what this model can fit ({})", known.join(", ")),
                suggestion: nearest(name, known),
            }))
        })
        .collect()
}
