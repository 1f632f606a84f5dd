//! A first experiment from a user's own files: which column is which channel, in which unit, with the evidence for each
//! proposal written beside it. What the files cannot say is left open and named; nothing is assumed silently.

use super::error::RecordingError;
use super::file;
use super::inner_loop::InnerLoop;
use super::table::{Heading, Table};
use crate::files::layout::Stated;
use std::path::{Path, PathBuf};

mod columns;
mod control;
mod units;
mod write;

pub use columns::{Choice, Facts};
pub use control::Loop;

/// Most columns that are looked at.
const MOST_COLUMNS: usize = 60;

/// What is proposed for one folder.
#[derive(Debug, Clone)]
pub struct Proposal {
    /// The experiment as text, with comments.
    pub text: String,
    /// Files it takes as runs, relative to the folder.
    pub files: Vec<String>,
    /// Files that were left out, with the reason.
    pub left_out: Vec<(String, String)>,
    /// What was assumed to read the first of them, in words.
    pub notes: Vec<String>,
    /// The channels and what speaks for each.
    pub choices: Vec<Choice>,
    /// The columns of the first of the files, which the channels are taken from.
    pub facts: Vec<Facts>,
    /// The controller that reproduces the recorded command.
    pub control: Option<Loop>,
    /// The inner loop identified from reference, command and motion, whatever its law.
    pub inner: Option<InnerLoop>,
    /// What the user must settle before the experiment can be believed.
    pub open: Vec<String>,
}

impl Proposal {
    /// The columns that are no channel.
    pub fn unused(&self) -> impl Iterator<Item = &Facts> {
        columns::unused(&self.facts, &self.choices)
    }
}

/// Why nothing could be proposed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProposeError {
    /// The folder cannot be listed.
    #[error("{path}: cannot be listed: {error}; name a folder that holds recordings")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        error: std::io::Error,
    },
    /// No file in it is a recording.
    #[error("{path}: holds no recording (text with a header, .mat, .h5, .tdms, .rpc or .mseed){}", reasons(.left_out))]
    NoRecordings {
        /// The folder.
        path: PathBuf,
        /// The files that were tried, with the reason.
        left_out: Vec<(String, String)>,
    },
    /// A recording cannot be read after all.
    #[error(transparent)]
    Recording(#[from] RecordingError),
}

fn reasons(left_out: &[(String, String)]) -> String {
    left_out.iter().flat_map(|(_, reason)| ["\n  ", reason]).collect()
}

/// The columns of one file that are numbers throughout.
#[derive(Debug)]
struct Recording {
    headings: Vec<Heading>,
    table: Table,
    /// Columns that are not numbers throughout: where each fails, in words.
    unreadable: Vec<String>,
}

/// The columns of a file that are numbers throughout, and what is wrong with the others.
#[derive(Default)]
struct Numeric {
    kept: Vec<Heading>,
    columns: Vec<Vec<f64>>,
    notes: Vec<String>,
    errors: Vec<RecordingError>,
}

/// Looks at the recordings of a folder and proposes an experiment.
pub fn propose(folder: &Path) -> Result<Proposal, ProposeError> {
    propose_as(folder, &Stated::default())
}

/// The same of texts whose layout is stated in part.
pub(crate) fn propose_as(folder: &Path, stated: &Stated) -> Result<Proposal, ProposeError> {
    let mut left_out = Vec::new();
    let mut groups: Vec<(Vec<Heading>, Vec<String>)> = Vec::new();
    for name in candidates(folder)? {
        match file::headings_as(&folder.join(&name), stated) {
            Ok(headings) => match groups.iter_mut().find(|(h, _)| *h == headings) {
                Some((_, names)) => names.push(name),
                None => groups.push((headings, vec![name])),
            },
            Err(error) => left_out.push((name, error.to_string())),
        }
    }
    // One experiment has one set of channels: the headings that most files share.
    groups.sort_by_key(|(_, names)| std::cmp::Reverse(names.len()));
    let mut groups = groups.into_iter();
    let Some((headings, mut files)) = groups.next() else {
        return Err(ProposeError::NoRecordings { path: folder.to_path_buf(), left_out });
    };
    let others = groups.flat_map(|(_, names)| names);
    left_out.extend(others.map(|n| (n, "has other columns; give it an experiment of its own".to_owned())));
    let recording = first_readable(folder, &headings, &mut files, &mut left_out, stated)?;
    let notes = recording.table.notes.clone();
    let facts = columns::facts(&recording);
    let mut choices = columns::choose(&facts);
    units::settle(&mut choices, &facts);
    let inner = control::inner(&choices, &facts);
    let control = control::find(&choices, &facts).or_else(|| inner.as_ref().and_then(control::stated));
    let unusable = [recording.unreadable, columns::misfits(&facts, &choices)].concat();
    let open = write::open_questions(&choices, control.as_ref(), &unusable);
    let mut text = write::experiment(folder, &files, &left_out, &facts, &choices, control.as_ref(), &open);
    if let Some(inner) = &inner {
        write::inner_loop(&mut text, inner);
    }
    write::layout(&mut text, stated, &notes);
    Ok(Proposal { text, files, left_out, notes, choices, facts, control, inner, open })
}

/// One recording's columns as channels.
#[derive(Debug, Clone)]
pub(crate) struct Look {
    /// Every column of numbers.
    pub(crate) facts: Vec<Facts>,
    /// Which of them is which channel, in which unit, and what speaks for it.
    pub(crate) choices: Vec<Choice>,
    /// What was assumed to read the file, in words.
    pub(crate) notes: Vec<String>,
}

impl Look {
    /// A channel's samples in SI, gaps bridged; none where no column is it or its unit is open.
    pub(crate) fn channel(&self, channel: super::Channel) -> Option<Vec<f64>> {
        let choice = self.choices.iter().find(|c| c.channel == channel)?;
        let factor = choice.unit?.factor;
        Some(self.facts[choice.column].samples.iter().map(|x| x * factor).collect())
    }

    /// The step, s; none where no column is the time.
    pub(crate) fn step(&self) -> Option<f64> {
        let time = self.choices.iter().find(|c| c.channel == super::Channel::Time)?;
        Some(self.facts[time.column].step? * time.unit?.factor)
    }
}

/// Looks at one recording. A column named in `stated` is that channel, whatever its name suggests.
pub(crate) fn look(path: &Path, layout: &Stated, stated: &[(super::Channel, String)]) -> Result<Look, RecordingError> {
    let headings = file::headings_as(path, layout)?;
    for (_, column) in stated {
        super::table::locate(&headings, &[column], path)?;
    }
    let (folder, name) = (path.parent().unwrap_or(Path::new("")), path.file_name().unwrap_or_default());
    let (mut files, mut left_out) = (vec![name.to_string_lossy().into_owned()], Vec::new());
    let recording = first_readable(folder, &headings, &mut files, &mut left_out, layout).map_err(|e| match e {
        ProposeError::Recording(e) => e,
        other => super::Place::file(path).refuse(super::Problem::Contradiction(other.to_string())),
    })?;
    let facts = columns::facts(&recording);
    let mut choices = columns::choose(&facts);
    for (channel, column) in stated {
        let Some(found) = facts.iter().position(|f| f.heading.text == *column || f.heading.name == *column) else {
            continue;
        };
        choices.retain(|c| c.channel != *channel && c.column != found);
        choices.push(Choice {
            channel: *channel,
            column: found,
            unit: None,
            evidence: vec!["as stated".into()],
            doubtful: false,
        });
    }
    choices.sort_by_key(|c| c.channel);
    units::settle(&mut choices, &facts);
    Ok(Look { facts, choices, notes: recording.table.notes })
}

/// Names of the files that could be recordings, in order.
fn candidates(folder: &Path) -> Result<Vec<String>, ProposeError> {
    const KINDS: [&str; 17] = [
        "csv", "txt", "dat", "tsv", "asc", "lvm", "mat", "h5", "hdf5", "tdms", "rpc", "rsp", "tim", "drv", "mseed",
        "miniseed", "ms",
    ];
    let fail = |error| ProposeError::Folder { path: folder.to_path_buf(), error };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        if path.is_file() && kind.is_some_and(|k| KINDS.contains(&k.as_str())) {
            names.extend(path.file_name().map(|n| n.to_string_lossy().into_owned()));
        }
    }
    names.sort();
    Ok(names)
}

/// The first file whose rows can be read; those before it are moved to `left_out`.
fn first_readable(
    folder: &Path,
    headings: &[Heading],
    files: &mut Vec<String>,
    left_out: &mut Vec<(String, String)>,
    stated: &Stated,
) -> Result<Recording, ProposeError> {
    while let Some(name) = files.first().cloned() {
        let path = folder.join(&name);
        let Numeric { mut kept, mut columns, notes, errors } = numeric_columns(&path, headings, stated);
        // A file of variables also holds single numbers: gains, a date.
        let longest = columns.iter().map(Vec::len).max().unwrap_or(0);
        let whole: Vec<bool> = columns.iter().map(|c| c.len() == longest).collect();
        let mut keep = whole.iter();
        kept.retain(|_| *keep.next().unwrap_or(&false));
        columns.retain(|c| c.len() == longest);
        if longest >= super::experiment::LEAST_SAMPLES && columns.len() >= 2 {
            let table = Table { headings: kept.clone(), columns, notes };
            let unreadable = errors.iter().map(|error| format!("a column is left out: {error}")).collect();
            return Ok(Recording { headings: kept, table, unreadable });
        }
        let reason =
            errors.last().map_or_else(|| format!("{}: holds too few numbers", path.display()), ToString::to_string);
        left_out.push((name, reason));
        files.remove(0);
    }
    Err(ProposeError::NoRecordings { path: folder.to_path_buf(), left_out: std::mem::take(left_out) })
}

/// The columns that are numbers throughout, and what is wrong with the others.
fn numeric_columns(path: &Path, headings: &[Heading], stated: &Stated) -> Numeric {
    let named: Vec<&Heading> = headings.iter().filter(|h| !h.text.is_empty()).take(MOST_COLUMNS).collect();
    let all: Vec<&str> = named.iter().map(|h| h.text.as_str()).collect();
    if let Ok(Table { headings: kept, columns, notes }) = file::read_as(path, &all, stated) {
        return Numeric { kept, columns, notes, errors: Vec::new() };
    }
    let mut found = Numeric::default();
    for heading in named {
        match file::read_as(path, &[&heading.text], stated) {
            Ok(mut table) => {
                found.columns.append(&mut table.columns);
                found.kept.push(heading.clone());
                found.notes = table.notes;
            }
            Err(e) => found.errors.push(e),
        }
    }
    found
}

#[cfg(test)]
mod tests;
