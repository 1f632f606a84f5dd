//! Makes cases, has them answered, opens the answers, and keeps one file a case so that a campaign can stop and go on.

use super::Examinee;
use super::attainable::attainable;
use super::record::{Record, Reply, SCHEMA, Truth};
use super::rival;
use crate::files::json::{self, JsonError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use shakedown_truth::case;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A campaign, or a piece of one.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
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
}

impl Plan {
    /// The numbers of this piece's cases: dealt round, so that every piece has the same mix.
    pub fn numbers(&self) -> Vec<u64> {
        (0..self.cases).filter(|number| number % self.shards == self.shard - 1).collect()
    }

    fn file(&self, folder: &Path) -> PathBuf {
        folder.join(format!("shard-{}-of-{}.json", self.shard, self.shards))
    }
}

/// Why a campaign stopped or cannot be joined.
#[derive(Debug, thiserror::Error)]
pub enum CampaignError {
    /// A file could not be read, written or taken.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// The folder holds another campaign.
    #[error("{path}: begun as seed {seed}, {cases} cases, engine {engine}; give another --out")]
    Other {
        /// Its plan.
        path: PathBuf,
        /// Its seed.
        seed: u64,
        /// Its cases.
        cases: u64,
        /// Its engine.
        engine: String,
    },
    /// The seal stayed closed.
    #[error(transparent)]
    Seal(#[from] shakedown_truth::answer::SealError),
    /// There is nothing to join.
    #[error("{0}: no shard-I-of-N.json there or one folder below; `shakedown prove --out {0}` makes one")]
    Nothing(PathBuf),
    /// Pieces are missing.
    #[error("{}", missing_text(.missing, .plan))]
    Missing {
        /// Number of the piece and of its missing cases.
        missing: Vec<(u64, Vec<u64>)>,
        /// Plan of one of the pieces.
        plan: Box<Plan>,
    },
}

fn missing_text(missing: &[(u64, Vec<u64>)], plan: &Plan) -> String {
    let pieces: Vec<String> = missing
        .iter()
        .map(|(shard, cases)| {
            let few: Vec<String> = cases.iter().take(5).map(u64::to_string).collect();
            let more = if cases.len() > 5 { ", ..." } else { "" };
            format!("shard {shard}/{}: {} cases missing ({}{more})", plan.shards, cases.len(), few.join(", "))
        })
        .collect();
    format!(
        "{}; run each again with `shakedown prove --seed {} --cases {} --shard I/{}`",
        pieces.join("; "),
        plan.seed,
        plan.cases,
        plan.shards
    )
}

/// What the examinee said, as it is kept before the seal is broken.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Answered {
    engine: String,
    seal: String,
    seconds: f64,
    diagnosis: Value,
}

/// Runs the cases of a piece that are not there yet; `done` is called after each, and once for those found done.
pub fn run(
    plan: &Plan,
    folder: &Path,
    examinee: &impl Examinee,
    done: &(impl Fn(u64) + Sync),
) -> Result<(), CampaignError> {
    for part in ["answers", "records"] {
        let path = folder.join(part);
        std::fs::create_dir_all(&path).map_err(JsonError::file(&path))?;
    }
    begin(plan, folder)?;
    let open: Vec<u64> = plan.numbers().into_iter().filter(|n| !record_path(folder, *n).exists()).collect();
    done((plan.numbers().len() - open.len()) as u64);
    open.par_iter().try_for_each(|number| {
        let record = examine(plan, folder, examinee, *number)?;
        write(&record_path(folder, *number), &record)?;
        done(1);
        Ok(())
    })
}

/// Writes the plan, or finds the same one there.
fn begin(plan: &Plan, folder: &Path) -> Result<(), CampaignError> {
    for other in plans(folder)? {
        let same = (other.seed, other.cases, &other.engine) == (plan.seed, plan.cases, &plan.engine);
        if !same || other.shards != plan.shards {
            let path = other.file(folder);
            return Err(CampaignError::Other { path, seed: other.seed, cases: other.cases, engine: other.engine });
        }
    }
    Ok(write(&plan.file(folder), plan)?)
}

fn record_path(folder: &Path, number: u64) -> PathBuf {
    folder.join("records").join(format!("case-{number:04}.json"))
}

/// For people to read too.
fn write(path: &Path, value: &impl Serialize) -> Result<(), JsonError> {
    json::write(path, serde_json::to_string_pretty(value))
}

/// One case: dealt, answered, the answer stored, and only then opened.
fn examine(plan: &Plan, folder: &Path, examinee: &impl Examinee, number: u64) -> Result<Record, CampaignError> {
    let dealt = case(plan.seed, number);
    let seal = dealt.sealed.seal.clone();
    let scratch = tempfile::tempdir().map_err(JsonError::file(folder))?;
    let stored = folder.join("answers").join(format!("{}.json", dealt.name));
    // An answer that a stopped campaign left is kept: it was given before its seal was broken.
    let answered = match json::read::<Answered>(&stored) {
        Ok(earlier) if earlier.engine == plan.engine && earlier.seal == seal => earlier,
        _ => {
            let desk = scratch.path().join(&dealt.name);
            dealt.write(&desk).map_err(JsonError::file(&desk))?;
            let answered = answer(examinee, &desk, plan, &seal);
            write(&stored, &answered)?;
            answered
        }
    };
    let rivals = rival::replies(&dealt.experiment).map(Vec::from).unwrap_or_default();
    let opened = dealt.sealed.open_after(&stored)?;
    let reply = reply(&answered.diagnosis);
    let truth: Truth = serde_json::from_value(opened.answer.to_json()).map_err(JsonError::content(&stored))?;
    let attainable = attainable(examinee, &opened, &reply, &truth, scratch.path());
    Ok(Record {
        schema: SCHEMA.into(),
        seed: plan.seed,
        case: number,
        engine: answered.engine,
        seal,
        salt: opened.salt,
        reply,
        seconds: answered.seconds,
        truth,
        attainable,
        rivals,
    })
}

fn answer(examinee: &impl Examinee, desk: &Path, plan: &Plan, seal: &str) -> Answered {
    let start = Instant::now();
    let diagnosis = examinee
        .diagnose(&desk.join("experiment.toml"))
        .unwrap_or_else(|failure| serde_json::json!({"verdict": "failed", "failure": failure}));
    let seconds = start.elapsed().as_secs_f64();
    Answered { engine: plan.engine.clone(), seal: seal.to_string(), seconds, diagnosis }
}

/// The scored part of a diagnosis; what does not have its shape is a failure of the examinee.
fn reply(diagnosis: &Value) -> Reply {
    Reply::deserialize(diagnosis).unwrap_or_else(|e| Reply {
        verdict: "failed".into(),
        failure: Some(format!("not the shape of diagnose --json: {e}")),
        ..Reply::default()
    })
}

fn plans(folder: &Path) -> Result<Vec<Plan>, CampaignError> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(Vec::new()) };
    let mut found = Vec::new();
    for entry in entries.flatten() {
        let path = entry.path();
        let named = path.file_stem().is_some_and(|name| name.to_string_lossy().starts_with("shard-"));
        if named && path.extension().is_some_and(|extension| extension == "json") {
            found.push(json::read(&path)?);
        }
    }
    Ok(found)
}

/// Joins the pieces in `folder` or in the folders one below it: the plan and every record, in order.
pub fn join(folder: &Path) -> Result<(Plan, Vec<Record>), CampaignError> {
    let below = std::fs::read_dir(folder).map_err(|_| CampaignError::Nothing(folder.to_path_buf()))?;
    let mut folders = vec![folder.to_path_buf()];
    folders.extend(below.flatten().map(|e| e.path()).filter(|p| p.is_dir()));
    folders.sort();
    let mut pieces: Vec<(PathBuf, Plan)> = Vec::new();
    for place in folders {
        pieces.extend(plans(&place)?.into_iter().map(|plan| (place.clone(), plan)));
    }
    let Some(first) = pieces.first().map(|(_, plan)| plan.clone()) else {
        return Err(CampaignError::Nothing(folder.to_path_buf()));
    };
    if let Some((place, odd)) = pieces.iter().find(|(_, p)| Plan { shard: first.shard, ..p.clone() } != first) {
        let path = odd.file(place);
        return Err(CampaignError::Other { path, seed: odd.seed, cases: odd.cases, engine: odd.engine.clone() });
    }
    let (mut records, mut missing) = (Vec::new(), Vec::new());
    for shard in 1..=first.shards {
        let plan = Plan { shard, ..first.clone() };
        let places: Vec<&PathBuf> = pieces.iter().filter(|(_, p)| p.shard == shard).map(|(place, _)| place).collect();
        let mut lost = Vec::new();
        for number in plan.numbers() {
            match places.iter().map(|place| record_path(place, number)).find(|path| path.exists()) {
                Some(path) => records.push(json::read::<Record>(&path)?),
                None => lost.push(number),
            }
        }
        if !lost.is_empty() {
            missing.push((shard, lost));
        }
    }
    if !missing.is_empty() {
        return Err(CampaignError::Missing { missing, plan: Box::new(first) });
    }
    records.sort_by_key(|record| record.case);
    Ok((Plan { shard: 1, shards: 1, ..first }, records))
}
