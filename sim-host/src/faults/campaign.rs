//! Runs a campaign in pieces that can stop and go on: one file a chunk of runs, whole or not there.

use super::case::{Beside, Case};
use super::class::Class;
use super::motions::{Motions, MotionsError};
use super::rig::RigError;
use super::watcher::{Outcome, judge};
use crate::files::json::{self, JsonError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Runs in one file.
const CHUNK: u64 = 1000;

/// A campaign, or a piece of one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of every run.
    pub seed: u64,
    /// Runs of the whole campaign.
    pub runs: u64,
    /// Where every fault is of one class, its name.
    pub class: Option<String>,
    /// The aid beside the guard.
    pub beside: Beside,
    /// Records that runs are taken from: their number and names' order is part of the campaign.
    pub records: Vec<String>,
    /// Version of what is tested.
    pub version: String,
}

/// Why a campaign stopped.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file could not be read, written or taken.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// The folder holds another campaign.
    #[error("{0}: another campaign was begun there; give another --out")]
    Other(PathBuf),
    /// The folder does not hold every run.
    #[error("{folder}: {missing} of {runs} runs are missing; run the shards again")]
    Missing {
        /// The folder.
        folder: PathBuf,
        /// Runs that are not there.
        missing: u64,
        /// Runs of the campaign.
        runs: u64,
    },
    /// A run could not begin.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// There are no records.
    #[error(transparent)]
    Motions(#[from] MotionsError),
}

impl Plan {
    /// Numbers of the chunks of a shard, from 1, of so many.
    fn chunks(&self, shard: u64, shards: u64) -> Vec<u64> {
        (0..self.runs.div_ceil(CHUNK)).filter(|chunk| chunk % shards == shard - 1).collect()
    }

    fn numbers(&self, chunk: u64) -> std::ops::Range<u64> {
        chunk * CHUNK..((chunk + 1) * CHUNK).min(self.runs)
    }

    fn only(&self) -> Option<&'static Class> {
        self.class.as_deref().and_then(Class::named)
    }

    fn case(&self, number: u64, only: Option<&'static Class>, motions: &Motions) -> Case {
        Case::deal(self.seed, number, only, motions).beside(self.beside)
    }

    /// Does the runs of one chunk.
    fn judge(
        &self,
        chunk: u64,
        motions: &Motions,
        done: &(impl Fn(u64) + Sync),
    ) -> Result<Vec<Outcome>, CampaignError> {
        let only = self.only();
        let outcomes: Result<Vec<Outcome>, RigError> = self
            .numbers(chunk)
            .into_par_iter()
            .map(|number| {
                let outcome = judge(&self.case(number, only, motions));
                done(1);
                outcome
            })
            .collect();
        Ok(outcomes?)
    }
}

fn chunk_path(folder: &Path, chunk: u64) -> PathBuf {
    folder.join(format!("chunk-{chunk:05}.json"))
}

/// Runs all of `plan` in memory.
pub fn run(plan: &Plan, motions: &Motions, done: &(impl Fn(u64) + Sync)) -> Result<Vec<Outcome>, CampaignError> {
    let chunks: Result<Vec<_>, _> =
        plan.chunks(1, 1).into_iter().map(|chunk| plan.judge(chunk, motions, done)).collect();
    Ok(chunks?.concat())
}

/// Runs the chunks of a shard (from 1, of `shards`) that are not in `folder` yet.
pub fn run_shard(
    plan: &Plan,
    shard: (u64, u64),
    folder: &Path,
    motions: &Motions,
    done: &(impl Fn(u64) + Sync),
) -> Result<(), CampaignError> {
    std::fs::create_dir_all(folder).map_err(JsonError::file(folder))?;
    let path = folder.join("plan.json");
    if path.exists() {
        if json::read::<Plan>(&path)? != *plan {
            return Err(CampaignError::Other(folder.to_path_buf()));
        }
    } else {
        json::write(&path, serde_json::to_string(plan))?;
    }
    for chunk in plan.chunks(shard.0, shard.1) {
        let path = chunk_path(folder, chunk);
        if path.exists() {
            let numbers = plan.numbers(chunk);
            done(numbers.end - numbers.start);
        } else {
            json::write(&path, serde_json::to_string(&plan.judge(chunk, motions, done)?))?;
        }
    }
    Ok(())
}

/// Every outcome in `folder`, once all shards are there.
pub fn join(plan: &Plan, folder: &Path) -> Result<Vec<Outcome>, CampaignError> {
    let mut outcomes = Vec::new();
    let mut missing = 0;
    for chunk in plan.chunks(1, 1) {
        let path = chunk_path(folder, chunk);
        let numbers = plan.numbers(chunk);
        if path.exists() {
            outcomes.extend(json::read::<Vec<Outcome>>(&path)?);
        } else {
            missing += numbers.end - numbers.start;
        }
    }
    if missing > 0 {
        return Err(CampaignError::Missing { folder: folder.to_path_buf(), missing, runs: plan.runs });
    }
    Ok(outcomes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::class::CLASSES;

    /// A few runs of every class, with limit switches: what is long is for `shakedown faults`.
    #[test]
    fn every_class_keeps_its_promise_in_a_few_runs() {
        let motions = Motions::new(None).unwrap();
        for class in CLASSES.iter() {
            let plan = Plan {
                seed: 20262,
                runs: 6,
                class: Some(class.id.into()),
                beside: Beside::LimitSwitches,
                records: Vec::new(),
                version: String::new(),
            };
            let outcomes = run(&plan, &motions, &|_| ()).unwrap();
            let broken: Vec<_> = outcomes.iter().filter(|outcome| !outcome.broken.is_empty()).collect();
            assert!(broken.is_empty(), "{broken:#?}");
        }
    }
}
