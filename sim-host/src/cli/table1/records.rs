//! The three records of the table: files of a folder, or generated stand-ins.

use super::super::Failure;
use crate::closed_loop::published::Event;
use crate::closed_loop::table1::Case;
use crate::motion::generate::{self, GenerateError};
use crate::motion::{Record, read};
use std::path::{Path, PathBuf};

/// Where a record comes from.
#[derive(Debug, Clone)]
pub(super) enum Source {
    /// A file.
    File(Event, PathBuf),
    /// Made here.
    Generated(Event),
}

/// What the files are called: parts of their names in the order of preference.
fn names(event: Event) -> &'static [&'static str] {
    match event {
        Event::Kobe => &["kjm000"],
        Event::ElCentro => &["rsn6_", "elc180"],
        Event::Taft => &["taf021"],
    }
}

/// The three records in `folder`, or three stand-ins.
pub(super) fn find(folder: Option<&Path>) -> Result<Vec<Source>, Failure> {
    let Some(folder) = folder else { return Ok(Event::ALL.map(Source::Generated).to_vec()) };
    let entries = std::fs::read_dir(folder)
        .map_err(|e| Failure::Input(format!("{}: {e}: --records expects a folder of records", folder.display())))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    Event::ALL.iter().map(|&event| pick(event, folder, &files)).collect()
}

fn pick(event: Event, folder: &Path, files: &[PathBuf]) -> Result<Source, Failure> {
    let called = |path: &PathBuf, part: &str| {
        path.file_name().is_some_and(|name| name.to_string_lossy().to_lowercase().contains(part))
    };
    let found = names(event).iter().find_map(|part| files.iter().find(|path| called(path, part)));
    found.map(|path| Source::File(event, path.clone())).ok_or_else(|| {
        Failure::Input(format!(
            "{}: no record of {}: expected a file whose name holds {}",
            folder.display(),
            event.name(),
            names(event).join(" or ").to_uppercase()
        ))
    })
}

impl Source {
    /// The file, where it is one.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(_, path) => Some(path),
            Self::Generated(_) => None,
        }
    }

    /// The record, conditioned.
    pub(super) fn case(&self) -> Result<Case, Failure> {
        match self {
            Self::File(event, path) => {
                let record =
                    read::record(path, &read::Options::default()).map_err(|e| Failure::Input(e.to_string()))?;
                Case::new(*event, &record, false).map_err(|e| Failure::Input(format!("{}: {e}", path.display())))
            }
            Self::Generated(event) => {
                let failed = |e: String| Failure::Work(format!("stand-in for {}: {e}", event.name()));
                let record = stand_in(*event).map_err(|e| failed(e.to_string()))?;
                Case::new(*event, &record, true).map_err(|e| failed(e.to_string()))
            }
        }
    }
}

/// A generated motion in place of a record: a strong and a moderate near-field one, and a far-field one.
fn stand_in(event: Event) -> Result<Record, GenerateError> {
    let recipe = match event {
        Event::Kobe => generate::NEAR_FIELD_STRONG,
        Event::ElCentro => generate::NEAR_FIELD_MODERATE,
        Event::Taft => generate::FAR_FIELD,
    };
    recipe.generate(1)
}
