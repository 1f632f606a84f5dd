//! Set-ups that are stated wrong where the recordings alone do not show it: without a recorded command, and of values that `fit` does not
//! list. Each looks like missing physics, and is told as what it is.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use crate::paper_table::{Stated, paper, write};
use shakedown::diagnose::{Diagnosis, Options, Verdict, diagnose_file};
use shakedown_tests::binary::shakedown;
use shakedown_truth::plant::{Machine, Physics};

fn diagnosed(physics: &Physics, stated: &Stated) -> Diagnosis {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), physics, stated);
    diagnose_file(&folder.path().join("experiment.toml"), &Options::default()).unwrap()
}

/// What is found of the set-up that is called so, and of which channel.
fn found(diagnosis: &Diagnosis, what: &str) -> Vec<(Option<&'static str>, f64)> {
    let called = |found: &&shakedown::recording::SetUpFinding| serde_json::to_value(found.what).unwrap() == what;
    diagnosis.set_up.iter().filter(called).map(|found| (found.channel, found.found)).collect()
}

#[test]
#[ignore = "minutes of diagnosis: cargo xtask nightly"]
fn a_channel_that_was_recorded_a_sample_late_is_no_lag() {
    let diagnosis = diagnosed(&paper(), &Stated { command: false, late: 1, ..Stated::default() });
    assert_eq!(diagnosis.verdict, Verdict::Consistent, "{:?}", diagnosis.effects);
    assert_eq!(found(&diagnosis, "sample_shift"), [(Some("displacement"), 0.005)]);
}

#[test]
fn an_integral_gain_that_is_stated_wrong_is_no_physics() {
    let diagnosis = diagnosed(&paper(), &Stated { command: false, integral: 0.9, ..Stated::default() });
    assert_eq!(diagnosis.verdict, Verdict::Consistent, "{:?}", diagnosis.effects);
    let gains = found(&diagnosis, "controller_ki");
    assert!(matches!(gains[..], [(None, ki)] if (ki / 0.6 - 1.0).abs() < 0.01), "{gains:?}");
}

/// Beside a gain that drifts as the oil warms it is no physics either.
#[test]
#[ignore = "minutes of diagnosis: cargo xtask nightly"]
fn an_integral_gain_that_is_stated_wrong_is_no_second_effect() {
    let mut physics = paper();
    physics.command.warming = Some((-0.006, 1e4));
    let diagnosis = diagnosed(&physics, &Stated { command: false, integral: 0.9, ..Stated::default() });
    let named: Vec<_> = diagnosis.effects.iter().map(|effect| effect.id).collect();
    assert_eq!(named, ["gain_drift"], "{:?}", diagnosis.set_up);
    let gains = found(&diagnosis, "controller_ki");
    assert!(matches!(gains[..], [(None, ki)] if (ki / 0.6 - 1.0).abs() < 0.02), "{gains:?}");
}

/// What is too faint to be physics is said all the same: a filter of 1 ms and a hum of an eighth of the noise in the accelerometer, and one
/// sample of each run that is wrong by the largest acceleration.
#[test]
fn faint_faults_of_a_sensor_are_said_and_are_no_physics() {
    let lag = 1e-3;
    let mut physics = paper();
    physics.sensors.acceleration_lag = lag;
    let faults = Stated { hum: 0.0125, spike: 2.0, ..Stated::default() };
    let diagnosis = diagnosed(&physics, &faults);
    assert_eq!(diagnosis.verdict, Verdict::Consistent, "{:?}", diagnosis.effects);
    let near = |what: &str, truth: f64| match found(&diagnosis, what)[..] {
        [(Some("acceleration"), value)] => (value / truth - 1.0).abs() < 0.3,
        _ => false,
    };
    assert!(near("sensor_lag", lag) && near("hum", faults.hum), "{:?}", diagnosis.set_up);
    assert_eq!(found(&diagnosis, "outliers"), [(Some("acceleration"), 1.0); 4]);
}

/// The control: as it is stated without a recorded command.
#[test]
fn a_set_up_that_is_stated_right_is_not_doubted() {
    let diagnosis = diagnosed(&paper(), &Stated { command: false, ..Stated::default() });
    assert_eq!(diagnosis.verdict, Verdict::Consistent, "{:?}", diagnosis.effects);
    assert!(found(&diagnosis, "sample_shift").is_empty() && found(&diagnosis, "controller_ki").is_empty());
    let faint = ["sensor_lag", "hum", "outliers"].map(|what| found(&diagnosis, what));
    assert!(faint.iter().all(Vec::is_empty), "{faint:?}");
    assert!(found(&diagnosis, "model_value").is_empty() && diagnosis.stated_values_instead.is_empty());
}

/// A table of less than half the stated gain is told first, and its recordings are explained with what was found.
#[test]
fn a_table_that_is_not_the_stated_one_is_told_first() {
    let folder = tempfile::tempdir().unwrap();
    let table = Machine::Servo { b1: 0.69 / 2.2, b0: 138.0 / 2.2, a1: 57.65, velocity_limit: 0.242 };
    write(folder.path(), &Physics::baseline(table), &Stated::default());
    let output = shakedown()
        .args(["diagnose", "experiment.toml", "--json", "out.json"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.starts_with("The stated model is not this table's:"), "{text}");
    assert!(text.contains("b0 is 62.") && text.contains("stated 138") && text.contains("nothing is missing"), "{text}");
    let said: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path().join("out.json")).unwrap()).unwrap();
    let far = said["set_up"].as_array().unwrap().iter().find(|s| s["what"] == "model_value" && s["parameter"] == "b0");
    let found = far.expect("b0 among the set-up")["found"].as_f64().unwrap();
    assert!((found - 138.0 / 2.2).abs() < 0.5, "{found}");
}
