//! Why an experiment or a recording was refused: the file, the place in it, what is wrong, what to do.

use super::channel::Channel;
pub(crate) use crate::files::nearest::nearest;
pub(crate) use crate::files::nearest::suggestion;
use std::fmt;
use std::path::{Path, PathBuf};

/// An experiment or a recording that was refused.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct RecordingError {
    /// Which file, and where in it.
    pub place: Place,
    /// What is wrong there, and the remedy.
    pub problem: Box<Problem>,
}

/// A place in a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// Line, from one.
    pub line: Option<usize>,
    /// Column of the table by its name, or the key of an experiment.
    pub column: Option<String>,
}

impl Place {
    /// The file as a whole.
    pub fn file(path: &Path) -> Self {
        Self { path: path.to_path_buf(), line: None, column: None }
    }

    /// A line of it.
    pub fn line(path: &Path, line: usize) -> Self {
        Self { line: Some(line), ..Self::file(path) }
    }

    /// A column or a key of it.
    #[must_use]
    pub fn column(mut self, name: &str) -> Self {
        self.column = Some(name.to_owned());
        self
    }

    /// The problem at this place, as an error.
    pub fn refuse(self, problem: Problem) -> RecordingError {
        RecordingError { place: self, problem: Box::new(problem) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", `{column}`")?;
        }
        Ok(())
    }
}

/// What is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be opened or read.
    #[error("{}", unread(.0))]
    Unreadable(#[from] std::io::Error),
    /// The file is larger than what is read.
    #[error("holds more than {limit} {what}; cut the file, or leave out channels that are not needed")]
    TooLarge {
        /// What is counted.
        what: &'static str,
        /// How many are read at most.
        limit: usize,
    },
    /// The experiment is not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// A key that does not exist.
    #[error("unknown key{}; known here: {known}", did_you_mean(.suggestion.as_deref()))]
    UnknownKey {
        /// The nearest key there is.
        suggestion: Option<String>,
        /// All keys there are.
        known: String,
    },
    /// A key that must be there.
    #[error("`{key}` is missing; {remedy}")]
    Missing {
        /// The key.
        key: &'static str,
        /// What to write.
        remedy: &'static str,
    },
    /// A value of the wrong kind.
    #[error("is {found} where {expected} is expected")]
    WrongType {
        /// What is expected.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// A number outside its range.
    #[error("is {}; {expected}", short(*.value))]
    OutOfRange {
        /// What was given.
        value: f64,
        /// The range, in words.
        expected: &'static str,
    },
    /// A word that is not among the choices.
    #[error("`{found}` is not among {choices}{}", did_you_mean(.suggestion.as_deref()))]
    NotAChoice {
        /// What was given.
        found: String,
        /// The choices.
        choices: String,
        /// The nearest.
        suggestion: Option<String>,
    },
    /// A unit of another dimension than the channel's.
    #[error("`{unit}` is no unit of {channel}; use one of {choices}")]
    UnitOfOtherKind {
        /// The channel.
        channel: Channel,
        /// What was given.
        unit: String,
        /// What can be given.
        choices: String,
    },
    /// The header's unit is not the experiment's.
    #[error("the header gives the unit [{header}], the experiment `{stated}`; correct the one that is wrong")]
    UnitContradicted {
        /// The header's.
        header: String,
        /// The experiment's.
        stated: &'static str,
    },
    /// A column that the file does not have.
    #[error("no column `{wanted}`{}; there are: {available}", did_you_mean(.suggestion.as_deref()))]
    NoSuchColumn {
        /// What was looked for.
        wanted: String,
        /// The nearest there is.
        suggestion: Option<String>,
        /// All there are.
        available: String,
    },
    /// Two columns of one name.
    #[error("{count} columns have this name; give each its own in the header")]
    SameName {
        /// How many.
        count: usize,
    },
    /// A row with more or fewer fields than the header.
    #[error("{found} fields where the header has {expected}; write NaN for a sample that was dropped")]
    Ragged {
        /// Fields in the header.
        expected: usize,
        /// Fields in the row.
        found: usize,
    },
    /// A field that is no number.
    #[error("`{found}` is not a number{hint}")]
    NotANumber {
        /// What is there.
        found: String,
        /// What may have been meant.
        hint: &'static str,
    },
    /// A number that nothing measured.
    #[error("`{found}` is {hint}; write NaN for a sample that was dropped")]
    NoMeasurement {
        /// What is there.
        found: String,
        /// Why it is none.
        hint: &'static str,
    },
    /// A file with nothing to read.
    #[error("{0}")]
    Malformed(String),
    /// Channels of different length.
    #[error("has {found} values where the first channel has {expected}")]
    LengthsDiffer {
        /// Values in the first channel.
        expected: usize,
        /// Values in this one.
        found: usize,
    },
    /// Too little left of a run.
    #[error("{found} samples {place}; at least {least} are needed")]
    TooShort {
        /// How many are left.
        found: usize,
        /// How many are needed.
        least: usize,
        /// Of what.
        place: String,
    },
    /// Time that does not advance.
    #[error("{0}")]
    NoTimeStep(String),
    /// Two statements that cannot both hold.
    #[error("{0}")]
    Contradiction(String),
}

/// Why a file is not read, and what to do where there is none.
fn unread(error: &std::io::Error) -> String {
    if error.kind() == std::io::ErrorKind::NotFound {
        return "no such file: check its name and its folder".to_owned();
    }
    format!("cannot be read: {error}")
}

/// A number for a message: in powers of ten where its digits would be many.
fn short(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) { format!("{value:e}") } else { value.to_string() }
}

fn did_you_mean(suggestion: Option<&str>) -> String {
    suggestion.map_or_else(String::new, |s| format!("; did you mean `{s}`?"))
}
