//! The proof on concealed data: deals cases of an examiner that shares nothing with the diagnosis, has them answered
//! through its public entry, opens the answers only then, and scores.
//!
//! Examiner 1 is kept as it was; what examiner 2's cases are scored by is in [`laboratory`].
//!
//! One case leaves one file, so that a campaign stops and goes on, and pieces of it run anywhere: [`campaign`] makes the
//! files, [`summary`] joins them, whoever made them, to the same result.

mod attainable;
pub mod bounds;
pub mod campaign;
pub mod examiner;
pub mod gates;
pub mod inject;
pub mod laboratory;
pub mod page;
mod plan;
pub mod record;
pub mod rival;
pub mod score;
pub mod summary;

use serde_json::Value;
use std::path::Path;

/// An answer to an experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The object of `diagnose --json`.
    pub diagnosis: Value,
    /// Processor time that it took, or wall time where that is not known (s).
    pub seconds: f64,
}

/// Who is examined: the diagnosis behind its public entry, and nothing else of it.
pub trait Examinee: Sync {
    /// Answers an experiment.
    fn diagnose(&self, experiment: &Path) -> Result<Answer, String>;

    /// Fits an experiment's declared effects: the object of `identify --json`. Asked for data without noise, after the
    /// answer was opened; the values it gives are the best that the library's own equations can do, and those that
    /// intervals are to cover. None where there is no such thing.
    fn identify(&self, experiment: &Path) -> Option<Result<Value, String>>;

    /// What tells one version of it from another.
    fn version(&self) -> String;
}
