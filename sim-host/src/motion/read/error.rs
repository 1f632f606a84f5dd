//! What can be wrong with a record file, each with its place and its remedy.

use std::path::PathBuf;

/// Fewest samples of a record.
pub const LEAST_SAMPLES: usize = 16;

/// The beginning of a text, short enough for a message.
pub(super) fn excerpt(text: &str) -> String {
    let mut short: String = text.trim().chars().take(40).collect();
    if text.trim().chars().count() > 40 {
        short.push_str("...");
    }
    short
}

/// A number for a message: in powers of ten where its digits would be many.
pub(super) fn plain(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) { format!("{value:.4e}") } else { value.to_string() }
}

/// Channels by number and name, as many as a message can hold.
pub(super) fn listed(labels: &[String]) -> String {
    const SHOWN: usize = 20;
    let short = |label: &str| excerpt(label);
    let mut all: Vec<String> =
        labels.iter().take(SHOWN).enumerate().map(|(i, label)| format!("{} ({})", i + 1, short(label))).collect();
    if labels.len() > SHOWN {
        all.push(format!("... {} in all", labels.len()));
    }
    all.join(", ")
}

/// A record file that cannot be read: where, and what is wrong.
#[derive(Debug)]
pub struct ReadError {
    /// The file.
    pub file: PathBuf,
    /// The line, from 1, where one is to blame.
    pub line: Option<usize>,
    /// The column of text on that line, from 1.
    pub column: Option<usize>,
    /// What is wrong.
    pub problem: Box<Problem>,
}

impl std::error::Error for ReadError {}

impl std::fmt::Display for ReadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ", column {column}")?;
        }
        write!(f, ": {}", self.problem)
    }
}

/// What is wrong with a record file. Every message says what was found, what was expected and what to do.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// There is no such file.
    #[error("no such file: check the path")]
    Absent,
    /// The operating system refuses.
    #[error("cannot be read ({0}): expected a readable file")]
    Unreadable(std::io::Error),
    /// Nothing in it.
    #[error("the file is empty: expected a ground-motion record; download or export it again")]
    Empty,
    /// More than the limit.
    #[error(
        "the file has {} bytes or more: a record is expected to have at most {limit}; cut out the component and time \
         wanted, or resample it first",
        bytes
    )]
    TooLarge {
        /// Its size as far as known.
        bytes: u64,
        /// The limit, bytes.
        limit: u64,
    },
    /// More lines than the limit.
    #[error("the file has more than {limit} lines: expected a record of at most that; cut it or resample it first")]
    TooManyLines {
        /// The limit.
        limit: usize,
    },
    /// A drive, which is no record.
    #[error(
        "is a drive that shakedown wrote, and no recorded ground motion: play it with `shakedown run --record`; to fit anew, start \
         from the record that its header names"
    )]
    Drive,
    /// A zipped folder that does not hold one record.
    #[error("{0}")]
    Archive(String),
    /// UTF-16 without the mark that says so.
    #[error("{0}")]
    Encoding(String),
    /// Columns whose layout is not plain.
    #[error("{reason}")]
    Layout {
        /// What is wrong, and the remedy.
        reason: String,
    },
    /// Several columns, and none of them asked for.
    #[error(
        "has several columns: {available}; name one with --channel, or say --channel all where the rows are one series, wrapped"
    )]
    SeveralColumns {
        /// What there is.
        available: String,
    },
    /// Not text.
    #[error("byte {byte:#04x} at offset {offset} is not text: expected a text file; unpack it, or export it as text")]
    Binary {
        /// Where the byte is, from 0.
        offset: usize,
        /// The byte.
        byte: u8,
    },
    /// No format known here.
    #[error(
        "the format is not recognised from `{first}`: expected PEER AT2, CSMIP V2, COSMOS, GeoNet V2A, K-NET ASCII, or \
         columns of numbers with --dt and --unit"
    )]
    UnknownFormat {
        /// How the file begins.
        first: String,
    },
    /// A file of something else.
    #[error("`{found}`: expected {expected}; give the file that holds it")]
    WrongKind {
        /// What the file says it is.
        found: String,
        /// What is wanted.
        expected: &'static str,
    },
    /// A text where a number belongs.
    #[error("`{found}` is not a number: expected {expected}; correct the file or download it again")]
    NotANumber {
        /// The text.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// NaN or infinity.
    #[error(
        "`{found}` is not finite: expected {expected}; a ground motion has no gaps, so repair them in the source, \
         by interpolation or by cutting the record"
    )]
    NotFinite {
        /// The text.
        found: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// Something a file of this format has is not there.
    #[error("{expected} is missing: {remedy}")]
    Missing {
        /// What was expected.
        expected: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// The file says two things, or the person and the file do.
    #[error("{what}: {stated} but {found}; {remedy}")]
    Contradiction {
        /// The quantity.
        what: &'static str,
        /// What is stated.
        stated: String,
        /// What is found.
        found: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A value out of its range.
    #[error("{what} is {}{unit}: expected {expected}; check the file and its unit", plain(*.found))]
    OutOfRange {
        /// The quantity.
        what: &'static str,
        /// Its value.
        found: f64,
        /// Its unit after a blank, where it is not among the words.
        unit: &'static str,
        /// Its range.
        expected: &'static str,
    },
    /// A unit that is no acceleration's.
    #[error("unit `{found}`: expected m/s2, cm/s2 (gal), mm/s2 or g; convert the record or correct its header")]
    Unit {
        /// The unit as the file writes it.
        found: String,
    },
    /// No such component.
    #[error("there is no channel `{asked}`: expected one of {available}; name it with --channel")]
    NoChannel {
        /// What was asked for.
        asked: String,
        /// What there is.
        available: String,
    },
    /// One value from end to end.
    #[error(
        "every one of its {samples} accelerations is {}: expected a ground motion; check the file and its column",
        if *.value == 0.0 { "zero".to_owned() } else { plain(*.value) + " m/s2" }
    )]
    Constant {
        /// How many there are.
        samples: usize,
        /// The value, m/s2.
        value: f64,
    },
    /// Too few samples.
    #[error("{samples} sample(s): expected at least {LEAST_SAMPLES}; give a whole record")]
    TooShort {
        /// How many there are.
        samples: usize,
    },
}
