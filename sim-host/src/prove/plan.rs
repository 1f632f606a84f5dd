//! Which cases a campaign deals.

use serde::{Deserialize, Serialize};

/// A campaign, or a piece of one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Which examiner: 1, the frozen one, or 2.
    pub examiner: u8,
    /// Lock of examiner 2's grammar.
    pub lock: u64,
    /// Strata that are dealt; all where empty.
    pub strata: Vec<String>,
    /// Kinds of flaws that are dealt; all where empty.
    pub kinds: Vec<String>,
    /// Seed of the cases.
    pub seed: u64,
    /// Cases of the whole campaign.
    pub cases: u64,
    /// This piece, from 1.
    pub shard: u64,
    /// Pieces of the whole.
    pub shards: u64,
    /// Version of the examinee.
    pub engine: String,
    /// Leaves out the fits of cases without noise.
    #[serde(default)]
    pub quick: bool,
}
