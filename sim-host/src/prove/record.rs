//! What a case leaves behind: the examinee's reply, written before the seal is broken, and the truth beside it.

mod reply;
mod truth;

pub use reply::{
    Candidate, Estimate, Found, Holdout, HoldoutScore, Location, Named, Region, Remainder, Reply, Stretch,
};
pub use truth::{Misstated, TrueEffect, TrueLocation, TrueRegion, Truth};

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The schema of a record's file.
pub const SCHEMA: &str = "shakedown.proof-case/2";

/// What the library's own equations make of the case without noise.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Attainable {
    /// Values that intervals are to cover, by `ID.key`.
    pub parameters: BTreeMap<String, f64>,
    /// Chi2 that the true set leaves on the run held out, noise added: the floor.
    pub floor: Option<f64>,
}

/// One case as it is stored: everything that was said and everything that was true, so that scores, constants and rivals
/// are computed from it without another campaign.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// [`SCHEMA`].
    pub schema: String,
    /// Which examiner.
    pub examiner: u8,
    /// Lock of its grammar.
    pub lock: u64,
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of the case.
    pub case: u64,
    /// Version of the examinee.
    pub engine: String,
    /// Salted SHA-256 of the answer, as it was before the reply.
    pub seal: String,
    /// The salt.
    pub salt: String,
    /// Processor time of the reply (s).
    pub seconds: f64,
    /// The reply in whole.
    pub diagnosis: Value,
    /// The answer in whole.
    pub answer: Value,
    /// What could be attained; none where it was not asked for.
    #[serde(default)]
    pub attainable: Option<Attainable>,
    /// What the rivals of [`super::rival`] replied, in their order; empty with examiner 2.
    #[serde(default)]
    pub rivals: Vec<Reply>,
}

impl Evidence {
    /// The part of it that is scored.
    pub fn record(self) -> Result<Record, serde_json::Error> {
        Ok(Record {
            case: self.case,
            reply: Reply::of(&self.diagnosis),
            seconds: self.seconds,
            truth: serde_json::from_value(self.answer)?,
            attainable: self.attainable,
            rivals: self.rivals,
        })
    }
}

/// One case, answered and opened: what is scored of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// Number of the case.
    pub case: u64,
    /// The reply.
    pub reply: Reply,
    /// Processor time of the reply (s).
    pub seconds: f64,
    /// The answer.
    pub truth: Truth,
    /// What could be attained; none where it was not asked for.
    pub attainable: Option<Attainable>,
    /// What the rivals of [`super::rival`] replied, in their order; empty where the data could not be read.
    pub rivals: Vec<Reply>,
}
