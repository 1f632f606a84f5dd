//! What a case leaves behind: the examinee's reply, written before the seal is broken, and the truth beside it.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The schema of a record's file.
pub const SCHEMA: &str = "shakedown.proof-case/1";

/// An estimate as `diagnose --json` and `identify --json` give it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Estimate {
    /// Best value.
    pub value: f64,
    /// Standard deviation.
    #[serde(default)]
    pub std: Option<f64>,
    /// Lower end of its 90 % interval, where given.
    #[serde(default)]
    pub low: Option<f64>,
    /// Upper end.
    #[serde(default)]
    pub high: Option<f64>,
}

impl Estimate {
    /// The 90 % interval: as given, or from the standard deviation of a normal.
    pub fn interval(&self) -> Option<(f64, f64)> {
        const HALF_OF_90: f64 = 1.644_853_626_951_472_2;
        match (self.low, self.high, self.std) {
            (Some(low), Some(high), _) => Some((low, high)),
            (_, _, Some(std)) => Some((self.value - HALF_OF_90 * std, self.value + HALF_OF_90 * std)),
            _ => None,
        }
    }
}

/// An effect that the examinee names.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Named {
    /// Identifier.
    pub id: String,
    /// Probability.
    #[serde(default)]
    pub probability: Option<f64>,
    /// Parameters by key.
    #[serde(default)]
    pub parameters: BTreeMap<String, Estimate>,
}

/// A set of effects with its probability.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Candidate {
    /// Identifiers; empty for the baseline as it is.
    pub ids: Vec<String>,
    /// Probability.
    pub probability: f64,
}

/// A chi2 on the runs held out.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Fit {
    /// Mean of (residual / noise)^2.
    #[serde(default)]
    pub chi2: Option<f64>,
}

/// Before and after.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Holdout {
    /// Of the refitted baseline.
    #[serde(default)]
    pub before: Fit,
    /// Of the accepted model.
    #[serde(default)]
    pub after: Fit,
}

/// The part of `diagnose --json` that is scored.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Reply {
    /// `consistent`, `mismatch`, `bad-data`; `failed` where there was no reply.
    pub verdict: String,
    /// What it names.
    #[serde(default)]
    pub effects: Vec<Named>,
    /// The stated model's parameters as it fitted them.
    #[serde(default)]
    pub model: BTreeMap<String, Estimate>,
    /// With what probabilities.
    #[serde(default)]
    pub candidates: Vec<Candidate>,
    /// What it says cannot be told apart.
    #[serde(default)]
    pub indistinguishable: Vec<Vec<String>>,
    /// How it fits.
    #[serde(default)]
    pub holdout: Holdout,
    /// Whether it fitted stretches of the runs held back too.
    #[serde(default)]
    pub held_out_shared: bool,
    /// What it finds wrong with the data.
    #[serde(default)]
    pub findings: Vec<Value>,
    /// Why there is no reply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// An effect that is there.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Present {
    /// Identifier.
    pub id: String,
    /// Parameters as the truth was built.
    pub parameters: BTreeMap<String, f64>,
}

/// The opened answer, as the examiner writes it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Truth {
    /// `null`, `single`, `pair`, `unlisted`, `confounded`, `bad data`.
    pub stratum: String,
    /// `servo`, `rigid`, `axis`.
    pub machine: String,
    /// `faint`, `clear`, `gross`.
    pub strength: Option<String>,
    /// Listed effects that are missing from the stated model.
    pub effects: Vec<Present>,
    /// The flaw's name where no library holds it.
    pub unlisted: Option<String>,
    /// Effects that these data cannot tell apart.
    pub groups: Vec<Vec<String>>,
    /// Effects whose naming is no wrong name.
    pub tolerated: Vec<String>,
    /// What was done to the data.
    pub fault: Option<Value>,
    /// Whether `bad-data` is as right a verdict as any.
    pub bad_data_accepted: bool,
    /// Chi2 of the refitted baseline on the run held out, by the examiner's own reckoning.
    pub baseline_chi2: f64,
}

/// What the library's own equations make of the case without noise.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Attainable {
    /// Values that intervals are to cover, by `ID.key`.
    pub parameters: BTreeMap<String, f64>,
    /// Chi2 that the true set leaves on the run held out, noise added: the floor.
    pub floor: Option<f64>,
}

/// One case, answered and opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// [`SCHEMA`].
    pub schema: String,
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
    /// The reply.
    pub reply: Reply,
    /// Wall time of the reply (s).
    pub seconds: f64,
    /// The answer.
    pub truth: Truth,
    /// What could be attained; none where it was not asked for.
    #[serde(default)]
    pub attainable: Option<Attainable>,
    /// What the rivals of [`super::rival`] replied, in their order; empty where the data could not be read.
    #[serde(default)]
    pub rivals: Vec<Reply>,
}
