//! A campaign stops and goes on, comes in pieces and joins to the result of one run, and opens no answer early.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use serde_json::{Value, json};
use shakedown::blocks::prove::campaign::{CampaignError, Plan, join, run};
use shakedown::blocks::prove::summary::summarise;
use shakedown::blocks::prove::{Answer, Examinee, laboratory};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

const SEED: u64 = 21;
const CASES: u64 = 5;

/// Says that all is well, and watches that no opened answer lies about while it is asked.
struct Contented {
    asked: AtomicUsize,
    records: PathBuf,
}

impl Contented {
    fn beside(folder: &Path) -> Self {
        Self { asked: AtomicUsize::new(0), records: folder.join("records") }
    }
}

impl Examinee for Contented {
    fn diagnose(&self, experiment: &Path) -> Result<Answer, String> {
        self.asked.fetch_add(1, Ordering::SeqCst);
        let folder = experiment.parent().ok_or("no folder")?;
        let names: Vec<String> = std::fs::read_dir(folder)
            .map_err(|e| e.to_string())?
            .flatten()
            .map(|e| e.file_name().to_string_lossy().into_owned())
            .collect();
        assert!(names.iter().all(|n| n == "experiment.toml" || n.starts_with("run-")), "{names:?}");
        let case = folder.file_name().ok_or("no name")?;
        assert!(!self.records.join(case).with_extension("json").exists(), "opened before it was answered");
        let diagnosis = json!({"verdict": "consistent", "candidates": [{"ids": [], "probability": 1.0}]});
        Ok(Answer { diagnosis, seconds: 0.0 })
    }

    fn identify(&self, _experiment: &Path) -> Option<Result<Value, String>> {
        None
    }

    fn version(&self) -> String {
        "contented".into()
    }
}

fn piece(shard: u64, shards: u64) -> Plan {
    Plan {
        examiner: 1,
        lock: 0,
        strata: Vec::new(),
        kinds: Vec::new(),
        seed: SEED,
        cases: CASES,
        shard,
        shards,
        engine: "contented".into(),
        quick: false,
    }
}

#[test]
fn pieces_join_to_the_result_of_one_run_and_a_lost_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, parts) = (folder.path().join("whole"), folder.path().join("parts"));
    run(&piece(1, 1), &whole, &Contented::beside(&whole), &|_| ()).unwrap();
    let one = parts.join("a");
    run(&piece(1, 2), &one, &Contented::beside(&one), &|_| ()).unwrap();
    let lost = join(&parts, false).unwrap_err().to_string();
    assert!(lost.contains("shard 2/2: 2 cases missing (1, 3)"), "{lost}");
    assert_eq!(join(&parts, true).unwrap().1.len(), 3);
    let two = parts.join("b");
    run(&piece(2, 2), &two, &Contented::beside(&two), &|_| ()).unwrap();

    let result = |folder: &Path| {
        let (plan, records) = join(folder, false).unwrap();
        serde_json::to_string(&summarise(&plan, &records)).unwrap()
    };
    assert_eq!(result(&whole), result(&parts));

    // It goes on where it stopped: nothing is asked twice.
    std::fs::remove_file(whole.join("records/case-0003.json")).unwrap();
    std::fs::remove_file(whole.join("answers/case-0003.json")).unwrap();
    let again = Contented::beside(&whole);
    run(&piece(1, 1), &whole, &again, &|_| ()).unwrap();
    assert_eq!(again.asked.load(Ordering::SeqCst), 1);
    assert_eq!(result(&whole), result(&parts));

    // An answer given before the seal was broken stands.
    std::fs::remove_file(whole.join("records/case-0003.json")).unwrap();
    let stopped = Contented::beside(&whole);
    run(&piece(1, 1), &whole, &stopped, &|_| ()).unwrap();
    assert_eq!(stopped.asked.load(Ordering::SeqCst), 0);

    // Another engine's campaign is not mixed in.
    let other = Plan { engine: "another".into(), ..piece(1, 1) };
    assert!(matches!(run(&other, &whole, &again, &|_| ()), Err(CampaignError::Other { .. })));
}

#[test]
fn a_part_of_examiner_2_is_dealt_and_what_is_always_content_misses_its_gates() {
    let folder = tempfile::tempdir().unwrap();
    let strata = vec!["null".into(), "single, gross".into()];
    let plan = Plan { examiner: 2, strata, cases: 3, ..piece(1, 1) };
    run(&plan, folder.path(), &Contented::beside(folder.path()), &|_| ()).unwrap();
    let (plan, records) = join(folder.path(), false).unwrap();
    assert_eq!(records.len(), 3);
    for record in &records {
        let truth = &record.truth;
        let gross = truth.stratum == "single" && truth.effects.len() == 1;
        assert!(truth.stratum == "null" || gross, "{truth:?}");
    }
    let summary = laboratory::summarise(&plan, &records);
    let wrong = records.iter().filter(|r| r.truth.stratum == "single").count();
    assert_eq!(summary.misses.len(), wrong);
    // No case of these decides any gate about pairs.
    let pairs = summary.gates.iter().find(|g| g.name.contains("any pair")).unwrap();
    assert!(pairs.holds.is_none() && pairs.cases == 0);
}
