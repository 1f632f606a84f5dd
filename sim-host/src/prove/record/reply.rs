//! What an examinee says: the part of `diagnose --json` that is scored.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

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
pub struct HoldoutScore {
    /// Mean of (residual / noise)^2.
    #[serde(default)]
    pub chi2: Option<f64>,
}

/// Before and after.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Holdout {
    /// Of the refitted baseline.
    #[serde(default)]
    pub before: HoldoutScore,
    /// Of the accepted model.
    #[serde(default)]
    pub after: HoldoutScore,
}

/// Something found wrong with the set-up or with the data.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Found {
    /// Kind of a fault of the set-up.
    #[serde(default)]
    pub what: String,
    /// Kind of a fault of the data.
    #[serde(default)]
    pub fault: String,
    /// Channel, where it concerns one.
    #[serde(default)]
    pub channel: Option<String>,
    /// As stated, where something was.
    #[serde(default)]
    pub stated: Option<f64>,
    /// As found.
    #[serde(default)]
    pub found: Option<f64>,
}

/// A stretch of a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Stretch {
    /// File of the run; none for all of them.
    #[serde(default)]
    pub run: Option<String>,
    /// Its start (s).
    pub from_s: f64,
    /// Its end (s).
    pub to_s: f64,
}

/// A region of one variable, as replied: from `from` to `to`, or as the last two numbers of `where`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Region {
    /// The variable.
    pub variable: String,
    /// In words.
    #[serde(default, rename = "where")]
    pub words: String,
    /// Lower end (SI).
    #[serde(default)]
    pub from: Option<f64>,
    /// Upper end (SI).
    #[serde(default)]
    pub to: Option<f64>,
}

/// Where model and recordings part, as replied.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Location {
    /// Block of the signal path.
    #[serde(default)]
    pub block: Option<String>,
    /// Stretches of time.
    #[serde(default)]
    pub time: Vec<Stretch>,
    /// Regions of state.
    #[serde(default)]
    pub state: Vec<Region>,
}

/// What denotes physics in no library.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Remainder {
    /// Share of the stated model's excess that it removes on the runs held out.
    #[serde(default)]
    pub share: Option<f64>,
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
    /// Whether it fitted stretches of the hold-out runs too.
    #[serde(default)]
    pub held_out_shared: bool,
    /// What it finds wrong with the data.
    #[serde(default)]
    pub findings: Vec<Found>,
    /// Whether it says that more is missing than it names.
    #[serde(default)]
    pub more_missing: bool,
    /// What it finds wrong with the set-up as stated.
    #[serde(default)]
    pub set_up: Vec<Found>,
    /// Where it says the model and the recordings part.
    #[serde(default)]
    pub location: Option<Location>,
    /// The curve or equation that it gives for what is in no library.
    #[serde(default)]
    pub remainder: Option<Remainder>,
    /// Why there is no reply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

impl Reply {
    /// The scored part of a diagnosis; what does not have its shape is a failure of the examinee.
    pub fn of(diagnosis: &Value) -> Self {
        Self::deserialize(diagnosis).unwrap_or_else(|e| Self {
            verdict: "failed".into(),
            failure: Some(format!("not the shape of diagnose --json: {e}")),
            ..Self::default()
        })
    }
}
