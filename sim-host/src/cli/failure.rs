//! Errors are handled once: here they become one message and an exit status.

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
}

impl Failure {
    /// Prints the one message and gives the exit status.
    pub(crate) fn report(&self) -> ExitCode {
        let (Self::Input(message) | Self::Work(message)) = self;
        eprintln!("error: {message}");
        ExitCode::from(match self {
            Self::Input(_) => 2,
            Self::Work(_) => 1,
        })
    }
}

/// A file that was refused; `hint` where its name says that it was never meant to be TOML.
pub(crate) fn refused(path: &Path, error: impl Display, hint: &str) -> Failure {
    let meant = path.extension().is_none_or(|extension| extension.eq_ignore_ascii_case("toml"));
    Failure::Input(if meant { error.to_string() } else { format!("{error}; {hint}") })
}

/// What experiments are and where they come from.
pub(crate) const EXPERIMENT: &str =
    "an experiment is TOML: `shakedown init FOLDER` proposes one for the recordings of a folder";

/// Refuses an option whose value lies outside its range, or is no number.
pub(crate) fn within(option: &str, value: f64, low: f64, high: f64) -> Result<(), Failure> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(Failure::Input(format!("{option} {value}: expected {low} to {high}")))
}
