//! Why a scenario was refused.

use std::path::Path;

/// Why a scenario was refused; the message names the file, the place and the remedy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{file}{place}: {problem}")]
pub struct ScenarioError {
    file: String,
    place: String,
    problem: String,
}

impl ScenarioError {
    pub(super) fn of(path: &Path, place: String, problem: String) -> Self {
        Self { file: path.display().to_string(), place, problem }
    }

    /// Of another file, whose message may begin with its name and its line.
    pub(super) fn within(file: String, text: &str) -> Self {
        let rest = text.strip_prefix(&file).and_then(|rest| rest.split_once(": "));
        let (place, problem) = rest.unwrap_or(("", text));
        Self { place: place.to_owned(), problem: problem.to_owned(), file }
    }
}
