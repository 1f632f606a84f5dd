//! Makes cases, has them answered, opens the answers, and keeps one file a case so that a campaign can stop and go on.

use super::attainable::attainable;
use super::examiner::{Dealt, wanted};
pub use super::plan::Plan;
use super::record::{Evidence, Record, Reply, SCHEMA, Truth};
use super::rival;
use super::{Answer, Examinee};
use crate::files::json::{self, JsonError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Instant;

impl Plan {
    /// The numbers of this piece's cases: dealt round, so that every piece has the same mix.
    pub fn numbers(&self) -> Vec<u64> {
        let all = self.all();
        let mine = |i: &usize| *i as u64 % self.shards == self.shard - 1;
        all.into_iter().enumerate().filter(|(i, _)| mine(i)).map(|(_, number)| number).collect()
    }

    /// The numbers of the whole campaign's cases: the first ones, or the first that are of the strata and kinds asked for.
    fn all(&self) -> Vec<u64> {
        if self.strata.is_empty() && self.kinds.is_empty() {
            return (0..self.cases).collect();
        }
        // A kind comes at least once in some cycles; a name that is no kind ends the search here.
        let far = 5000 + 400 * self.cases;
        (0..far)
            .filter(|number| wanted(self, *number))
            .take(usize::try_from(self.cases).unwrap_or(usize::MAX))
            .collect()
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
    #[error("{path}: begun as examiner {examiner}, seed {seed}, {cases} cases, engine {engine}; give another --out")]
    Other {
        /// Its plan.
        path: PathBuf,
        /// Its examiner.
        examiner: u8,
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
        "{}; run each again with `shakedown prove --examiner {} --seed {} --cases {} --shard I/{}`",
        pieces.join("; "),
        plan.examiner,
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
        let evidence = examine(plan, folder, examinee, *number)?;
        write(&record_path(folder, *number), &evidence)?;
        done(1);
        Ok(())
    })
}

/// Writes the plan, or finds the same one there.
fn begin(plan: &Plan, folder: &Path) -> Result<(), CampaignError> {
    for other in plans(folder)? {
        if (Plan { shard: plan.shard, ..other.clone() }) != *plan {
            return Err(other_campaign(other.file(folder), other));
        }
    }
    Ok(write(&plan.file(folder), plan)?)
}

fn other_campaign(path: PathBuf, other: Plan) -> CampaignError {
    let Plan { examiner, seed, cases, engine, .. } = other;
    CampaignError::Other { path, examiner, seed, cases, engine }
}

fn record_path(folder: &Path, number: u64) -> PathBuf {
    folder.join("records").join(format!("case-{number:04}.json"))
}

/// For people to read too.
fn write(path: &Path, value: &impl Serialize) -> Result<(), JsonError> {
    json::write(path, serde_json::to_string_pretty(value))
}

/// One case: dealt, answered, the answer stored, and only then opened.
fn examine(plan: &Plan, folder: &Path, examinee: &impl Examinee, number: u64) -> Result<Evidence, CampaignError> {
    let dealt = Dealt::deal(plan, number);
    let seal = dealt.seal().to_string();
    let scratch = tempfile::tempdir().map_err(JsonError::file(folder))?;
    let stored = folder.join("answers").join(format!("{}.json", dealt.name()));
    // An answer that a stopped campaign left is kept: it was given before its seal was broken.
    let answered = match json::read::<Answered>(&stored) {
        Ok(earlier) if earlier.engine == plan.engine && earlier.seal == seal => earlier,
        _ => {
            let desk = scratch.path().join(dealt.name());
            dealt.write(&desk).map_err(JsonError::file(&desk))?;
            let answered = answer(examinee, &desk, plan, &seal);
            write(&stored, &answered)?;
            answered
        }
    };
    let rivals = dealt.first().and_then(rival::replies).map(Vec::from).unwrap_or_default();
    let opened = dealt.open_after(&stored)?;
    let truth: Truth = serde_json::from_value(opened.answer.clone()).map_err(JsonError::content(&stored))?;
    let reply = Reply::of(&answered.diagnosis);
    let attainable =
        if plan.quick { None } else { attainable(examinee, &opened.clean, &reply, &truth, scratch.path()) };
    Ok(Evidence {
        schema: SCHEMA.into(),
        examiner: plan.examiner,
        lock: plan.lock,
        seed: plan.seed,
        case: number,
        engine: answered.engine,
        seal,
        salt: opened.salt,
        seconds: answered.seconds,
        diagnosis: answered.diagnosis,
        answer: opened.answer,
        attainable,
        rivals,
    })
}

fn answer(examinee: &impl Examinee, desk: &Path, plan: &Plan, seal: &str) -> Answered {
    let start = Instant::now();
    let answer = examinee.diagnose(&desk.join("experiment.toml")).unwrap_or_else(|failure| Answer {
        diagnosis: serde_json::json!({"verdict": "failed", "failure": failure}),
        seconds: start.elapsed().as_secs_f64(),
    });
    Answered {
        engine: plan.engine.clone(),
        seal: seal.to_string(),
        seconds: answer.seconds,
        diagnosis: answer.diagnosis,
    }
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

fn read(path: &Path) -> Result<Record, CampaignError> {
    Ok(json::read::<Evidence>(path)?.record().map_err(JsonError::content(path))?)
}

/// Joins the pieces in `folder` or in the folders one below it: the plan and every record, in order; what is missing is an
/// error, unless a `part` will do.
pub fn join(folder: &Path, part: bool) -> Result<(Plan, Vec<Record>), CampaignError> {
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
        return Err(other_campaign(odd.file(place), odd.clone()));
    }
    let (mut records, mut missing) = (Vec::new(), Vec::new());
    for shard in 1..=first.shards {
        let plan = Plan { shard, ..first.clone() };
        let places: Vec<&PathBuf> = pieces.iter().filter(|(_, p)| p.shard == shard).map(|(place, _)| place).collect();
        let mut lost = Vec::new();
        for number in plan.numbers() {
            match places.iter().map(|place| record_path(place, number)).find(|path| path.exists()) {
                Some(path) => records.push(read(&path)?),
                None => lost.push(number),
            }
        }
        if !lost.is_empty() {
            missing.push((shard, lost));
        }
    }
    if !missing.is_empty() && !part {
        return Err(CampaignError::Missing { missing, plan: Box::new(first) });
    }
    records.sort_by_key(|record| record.case);
    Ok((Plan { shard: 1, shards: 1, ..first }, records))
}
