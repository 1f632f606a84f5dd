//! An experiment: the model, the channels and the runs of one TOML file, read, checked and brought to SI.

use super::channel::{Channel, PerChannel};
use super::copies;
use super::document::read_text;
use super::document::{Section, Source, parse};
use super::error::{Place, Problem, RecordingError};
use super::holdout::{HeldBack, assign};
use super::law::{RecordedLaw, Shaping};
use super::model::{Baseline, Model};
use super::run::{Run, Use};
use crate::files::layout::Stated;
use std::path::{Path, PathBuf};

mod channels;
mod load;

pub(crate) use channels::{ChannelSource, Origin};

/// Fewest samples of a run.
pub(crate) const LEAST_SAMPLES: usize = 16;

/// One experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// What it is called.
    pub name: String,
    /// The TOML file.
    pub path: PathBuf,
    /// The model the user believes in.
    pub model: Model,
    /// Where each channel comes from.
    pub sources: PerChannel<ChannelSource>,
    /// The runs, in the order given, in SI.
    pub runs: Vec<Run>,
    /// How it was decided which runs judge.
    pub held_back: HeldBack,
    /// Every file that was read, for fingerprints.
    pub inputs: Vec<PathBuf>,
    /// What was assumed to read the recordings, each with its file, in words.
    pub notes: Vec<String>,
}

/// One entry of `[[runs]]`, before its file is read.
#[derive(Debug, Clone)]
struct RunEntry {
    file: String,
    law: RecordedLaw,
    shaping: Shaping,
    controller_rate_hz: Option<f64>,
    stated: Option<Use>,
    from_s: Option<f64>,
    to_s: Option<f64>,
    place: Place,
}

impl Experiment {
    /// Reads an experiment and every recording it names.
    pub fn load(path: &Path) -> Result<Self, RecordingError> {
        Self::load_with(path, &[])
    }

    /// The same with the runs of further files, each of `[[runs]]` alone, whose recordings have the channels of the experiment's.
    pub fn load_with(path: &Path, more: &[PathBuf]) -> Result<Self, RecordingError> {
        let text = read_text(path)?;
        let source = Source::new(path, &text);
        let document = parse(&source, &text)?;
        let root = Section::root(&source, &document);
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let mut inputs = vec![path.to_path_buf()];

        let name = root.string("name")?.unwrap_or_else(|| stem(path));
        let model = Model::read(&root, &folder, &mut inputs)?;
        let sources = channels::read(&root)?;
        let text_layout = root.get("text").map(|e| layout(&e)).transpose()?.unwrap_or_default();
        let entries = run_entries(&root, &folder)?;
        root.finish()?;
        let channels_at = root.required("channels", "")?.place();
        for entry in &entries {
            check_needs(&model, &entry.law, &sources, &channels_at)?;
        }
        let (mut runs, mut notes) = load::runs(&entries, &sources, &folder, &text_layout)?;
        let mut places = places_of(entries);
        for path in more {
            let text = read_text(path)?;
            let source = Source::new(path, &text);
            let document = parse(&source, &text)?;
            let root = Section::root(&source, &document);
            let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
            let entries = run_entries(&root, &folder)?;
            root.finish()?;
            for entry in &entries {
                check_needs(&model, &entry.law, &sources, &channels_at)?;
            }
            let (added, told) = load::runs(&entries, &sources, &folder, &text_layout)?;
            runs.extend(added);
            notes.extend(told);
            places.extend(places_of(entries));
            inputs.push(path.clone());
        }
        for run in &runs {
            add_inputs(&mut inputs, &run.0);
        }
        let (runs, held_back) = assign(runs);
        copies::refuse(&runs, &places)?;
        Ok(Self { name, path: path.to_path_buf(), model, sources, runs, held_back, inputs, notes })
    }

    /// The runs of one use.
    pub fn runs_for(&self, purpose: Use) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |r| r.purpose == purpose)
    }
}

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

fn add_inputs(inputs: &mut Vec<PathBuf>, run: &Run) {
    let settings = match &run.law {
        RecordedLaw::Core { path, .. } => Some(path.clone()),
        _ => None,
    };
    for path in std::iter::once(run.path.clone()).chain(settings) {
        if !inputs.contains(&path) {
            inputs.push(path);
        }
    }
}

fn run_entries(root: &Section<'_>, folder: &Path) -> Result<Vec<RunEntry>, RecordingError> {
    let list = root.required("runs", "write a [[runs]] table with its `file` for every recording")?;
    let entries = list.tables()?.iter().map(|e| run_entry(&e.section()?, folder)).collect::<Result<Vec<_>, _>>()?;
    if entries.is_empty() {
        let problem = Problem::Missing { key: "runs", remedy: "name at least one recording" };
        return Err(list.refuse(problem));
    }
    Ok(entries)
}

fn places_of(entries: Vec<RunEntry>) -> Vec<Place> {
    entries.into_iter().map(|entry| entry.place).collect()
}

fn run_entry(section: &Section<'_>, folder: &Path) -> Result<RunEntry, RecordingError> {
    let file = section.required("file", "name the recording, relative to the experiment")?;
    let none = || Ok((RecordedLaw::Open, Shaping::default()));
    let (law, shaping) = section.get("controller").map_or_else(none, |e| RecordedLaw::read(&e, folder))?;
    let entry = RunEntry {
        file: file.string()?.to_owned(),
        law,
        shaping,
        controller_rate_hz: section.get("controller_rate_hz").map(|e| e.positive()).transpose()?,
        stated: section.get("use").map(|e| purpose(&e)).transpose()?,
        from_s: section.number("from_s")?,
        to_s: section.number("to_s")?,
        place: file.place(),
    };
    if let (Some(from), Some(to), Some(at)) = (entry.from_s, entry.to_s, section.get("to_s"))
        && to <= from
    {
        return Err(at.refuse(Problem::OutOfRange { value: to, expected: "it must be after `from_s`" }));
    }
    section.finish()?;
    Ok(entry)
}

/// `[text]`: how the recordings' columns of text are laid out, as far as it is not to be found.
fn layout(entry: &super::document::Entry<'_>) -> Result<Stated, RecordingError> {
    let section = entry.section()?;
    let refuse = |e: &super::document::Entry<'_>, why: String| e.refuse(Problem::Contradiction(why));
    let mut stated = Stated::default();
    if let Some(e) = section.get("skip_lines") {
        stated.skip_lines = Some(e.not_negative()? as usize);
    }
    if let Some(e) = section.get("delimiter") {
        stated.delimiter = Some(e.string()?.parse().map_err(|why| refuse(&e, why))?);
    }
    if let Some(e) = section.get("decimal") {
        stated.decimal = Some(e.string()?.parse().map_err(|why| refuse(&e, why))?);
    }
    if let Some(e) = section.get("units") {
        stated.units = Some(e.list()?.iter().map(|u| u.string().map(str::to_owned)).collect::<Result<_, _>>()?);
    }
    section.finish()?;
    Ok(stated)
}

fn purpose(entry: &super::document::Entry<'_>) -> Result<Use, RecordingError> {
    match entry.string()? {
        "fit" => Ok(Use::Fit),
        "holdout" => Ok(Use::HoldOut),
        other => Err(entry.refuse(Problem::NotAChoice {
            found: other.to_owned(),
            choices: "\"fit\", \"holdout\"".to_owned(),
            suggestion: super::error::nearest(other, ["fit", "holdout"]),
        })),
    }
}

/// Refuses an experiment without the channels that its model and its controller take.
fn check_needs(
    model: &Model,
    law: &RecordedLaw,
    sources: &PerChannel<ChannelSource>,
    place: &Place,
) -> Result<(), RecordingError> {
    let missing = |channel: Channel| sources.get(channel).is_none();
    let refuse = |key, remedy| Err(place.clone().refuse(Problem::Missing { key, remedy }));
    if let Baseline::ForceBalance(_) = model.baseline {
        if missing(Channel::PressureDifference) {
            return refuse("pressure_difference", "it is what a force balance explains");
        }
        if missing(Channel::Displacement) && missing(Channel::Acceleration) {
            return refuse("acceleration", "a force balance is driven by the measured motion");
        }
        return Ok(());
    }
    match law {
        RecordedLaw::Open if missing(Channel::Command) => {
            return refuse("command", "no controller is given, so the recorded command must drive the model");
        }
        RecordedLaw::Open => {}
        _ if missing(Channel::Reference) => {
            return refuse("reference", "the simulation closes the loop from it; without it leave `controller` out");
        }
        _ => {}
    }
    if [Channel::Displacement, Channel::Acceleration, Channel::Velocity].into_iter().all(missing) {
        return refuse("displacement", "a measured motion is needed to compare the model with");
    }
    Ok(())
}

#[cfg(test)]
mod tests;
