//! Errors are handled once: here they become one message and an exit status.

use super::output::tell;
use std::fmt::Display;
use std::path::Path;
use std::process::ExitCode;

/// Why a command ended early.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The input or the command line is wrong: exit status 2. Names the file, the place and the remedy.
    Input(String),
    /// The work failed: exit status 1.
    Work(String),
    /// The reader of standard output has gone: exit status 1, and nobody left to be told.
    Cut,
}

impl Failure {
    /// Prints the one message and gives the exit status.
    pub(crate) fn report(&self) -> ExitCode {
        if let Self::Input(message) | Self::Work(message) = self {
            tell(&format!("error: {}", short(message)));
        }
        ExitCode::from(match self {
            Self::Input(_) => 2,
            Self::Work(_) | Self::Cut => 1,
        })
    }
}

/// Longest message, characters.
const LONGEST: usize = 4000;

/// A message without the numbers that the operating system has for its errors.
fn without_numbers(message: &str) -> String {
    let mut parts = message.split(" (os error ");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once(')').map_or("", |(_, rest)| rest))
}

/// What the operating system says of files, and what a person would.
const OF_FILES: [(&str, &str); 4] = [
    ("Is a directory", "it is a folder; name a file"),
    ("Not a directory", "it is no folder"),
    ("Permission denied", "no permission; check the rights of the file and of its folder"),
    ("Inappropriate ioctl for device", "it is no serial port"),
];

/// A message without what a damaged file makes unreadable: control characters, and what is beyond [`LONGEST`].
fn short(message: &str) -> String {
    let clean = |c: char| if c.is_control() && c != '\n' { '\u{fffd}' } else { c };
    let said = OF_FILES.iter().fold(without_numbers(message), |text, (theirs, ours)| text.replace(theirs, ours));
    let mut text: String = said.chars().take(LONGEST).map(clean).collect();
    if message.chars().nth(LONGEST).is_some() {
        text.push_str(" ... (cut)");
    }
    text
}

/// A file that was refused; `hint` where its name says that it was never meant to be TOML.
pub(crate) fn refused(path: &Path, error: impl Display, hint: &str) -> Failure {
    let meant = path.extension().is_none_or(|extension| extension.eq_ignore_ascii_case("toml"));
    Failure::Input(if meant { error.to_string() } else { format!("{error}; {hint}") })
}

/// What experiments are and where they come from.
pub(crate) const EXPERIMENT: &str =
    "an experiment is TOML: `shakedown init FOLDER` proposes one for the recordings of a folder";

/// What files of a model are and where they come from.
pub(crate) const MODEL: &str = "a model is TOML: `shakedown identify EXPERIMENT.toml --out FILE` writes one";

/// A number for a message: in powers of ten where its digits would be many.
pub(crate) fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e7).contains(&value.abs()) { format!("{value:e}") } else { value.to_string() }
}

/// The first of these options that is given.
pub(crate) fn first_given(options: impl IntoIterator<Item = (&'static str, bool)>) -> Option<&'static str> {
    options.into_iter().find(|(_, given)| *given).map(|(option, _)| option)
}

/// Refuses an option whose value lies outside its range in `unit`, or is no number.
pub(crate) fn within(option: &str, value: f64, low: f64, high: f64, unit: &str) -> Result<(), Failure> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    Err(Failure::Input(format!("{option} {}: expected {low} to {high}{unit}", number(value))))
}
