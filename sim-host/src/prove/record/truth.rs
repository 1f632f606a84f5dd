//! What is true of a case, as either examiner writes it.

use super::Stretch;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// A flaw that is there.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TrueEffect {
    /// Identifier, or the kind of a flaw in no library.
    pub id: String,
    /// Parameters as the truth was built.
    pub parameters: BTreeMap<String, f64>,
    /// Its form.
    #[serde(default)]
    pub form: String,
    /// Block at which it acts.
    #[serde(default)]
    pub block: String,
    /// What it adds to chi2 on the rows held out, all else being there.
    #[serde(default)]
    pub excess: Option<f64>,
    /// What it leaves on all rows, in standard deviations.
    #[serde(default)]
    pub sigma: Option<f64>,
}

/// Something in the set-up that is not as stated.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Misstated {
    /// Kind.
    pub what: String,
    /// Channel; empty where it is the run's.
    pub channel: String,
    /// The quantity misstated.
    pub quantity: String,
    /// As stated; none where nothing was.
    pub stated: Option<f64>,
    /// As it is.
    pub is: f64,
    /// What it leaves on all rows, in standard deviations; none where it was not measured.
    #[serde(default)]
    pub sigma: Option<f64>,
    /// Effects with the same equation at this place.
    #[serde(default)]
    pub tolerated: Vec<String>,
}

/// A region of one variable in which a flaw acts.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TrueRegion {
    /// The variable.
    pub variable: String,
    /// Whether the variable's magnitude is meant.
    pub magnitude: bool,
    /// Lower end (SI).
    pub low: f64,
    /// Upper end (SI).
    pub high: f64,
    /// The variable's values at even shares of all rows, in ascending order.
    #[serde(default)]
    pub quantiles: Vec<f64>,
}

/// Where the flaws act.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TrueLocation {
    /// Blocks.
    pub blocks: Vec<String>,
    /// Stretches of time; empty where always.
    pub time: Vec<Stretch>,
    /// Regions of state; empty where everywhere.
    pub state: Vec<TrueRegion>,
}

/// The opened answer, as either examiner writes it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Truth {
    /// `null`, `single`, `pair`, `unlisted`, and the examiner's others.
    pub stratum: String,
    /// `servo`, `rigid`, `axis`.
    pub machine: String,
    /// `faint`, `clear`, `gross`.
    pub strength: Option<String>,
    /// Listed effects that are missing from the stated model.
    pub effects: Vec<TrueEffect>,
    /// The flaw's name where no library holds it.
    pub unlisted: Option<String>,
    /// Each of the flaws that no library holds.
    #[serde(default)]
    pub unlisted_kinds: Vec<TrueEffect>,
    /// Effects that these data cannot tell apart.
    pub groups: Vec<Vec<String>>,
    /// Effects whose naming is no wrong name.
    pub tolerated: Vec<String>,
    /// What was done to the data.
    pub fault: Option<Value>,
    /// Whether `bad-data` is as right a verdict as any.
    pub bad_data_accepted: bool,
    /// Whether everything but the noise is as stated.
    #[serde(default)]
    pub perfect_set_up: bool,
    /// What of the set-up is not as stated.
    #[serde(default)]
    pub set_up: Vec<Misstated>,
    /// Where the flaws act.
    #[serde(default)]
    pub location: TrueLocation,
    /// Whether two of the flaws act at one place or look alike by their kinds.
    #[serde(default)]
    pub one_family: bool,
    /// Largest cosine between what two of the flaws leave.
    #[serde(default)]
    pub alike: Option<f64>,
    /// Chi2 of the refitted baseline on the run held out, by the examiner's own estimate.
    pub baseline_chi2: f64,
}
