//! The paper's own loose end: near the limit its measured and simulated accelerations part ("severe saturation"). Recordings
//! from a truth with a spool that lags and an orifice that softens before it chokes, given the paper's model and nothing
//! else, are diagnosed. The truth shares no code with the diagnosis.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use crate::paper_table::{Stated, paper, write};
use shakedown::diagnose::{Diagnosis, Options, Verdict, diagnose_file};
use shakedown_truth::plant::{Lag, Physics};

fn diagnosed(physics: &Physics) -> Diagnosis {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), physics, &Stated::default());
    let diagnosis = diagnose_file(&folder.path().join("experiment.toml"), &Options::default()).unwrap();
    let named: Vec<&str> = diagnosis.effects.iter().map(|e| e.id).collect();
    let (before, after) = (diagnosis.judged.before.chi2, diagnosis.judged.after.chi2);
    eprintln!("{:?}: {named:?}, held-out chi2 {before:.2} -> {after:.2}", diagnosis.verdict);
    diagnosis
}

#[test]
#[ignore = "minutes of diagnosis: cargo xtask nightly"]
fn severe_saturation_is_told_as_spool_and_orifice() {
    let mut physics = paper();
    physics.valve.lag = Some(Lag { frequency: 14.0, damping: 0.8, motor: 10.0 });
    physics.flow.corner = 0.15;
    let diagnosis = diagnosed(&physics);
    let named: Vec<&str> = diagnosis.effects.iter().map(|e| e.id).collect();
    assert_eq!(diagnosis.verdict, Verdict::Mismatch);
    assert_eq!(named, ["valve_lag", "flow_softening"]);
    assert!(diagnosis.share_left < 0.05, "{}", diagnosis.share_left);
}

/// The control of the test above: the paper's model as it is, saturated as severely, lacks nothing.
#[test]
fn saturation_alone_is_no_mismatch() {
    let diagnosis = diagnosed(&paper());
    assert_eq!(diagnosis.verdict, Verdict::Consistent);
}
