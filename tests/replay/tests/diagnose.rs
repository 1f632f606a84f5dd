//! A recording that the device saved, read by `shakedown diagnose` as it is.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

mod common;

use std::path::PathBuf;
use std::process::Command;

use common::{image, near_field, seen::Seen, setup};
use shakedown::device::{Progress, Row, csv, experiment};
use shakedown_core::Mode;

/// The table at the emulated converters is Eq. 7 with its limiter, and so is the model that the device's experiment names:
/// nothing is missing.
#[test]
fn a_recording_of_the_device_is_diagnosed_as_the_plant_that_it_is() {
    let setup = setup(Mode::Controller);
    let seen = shakedown_replay::run(&image(), Seen::new(setup, near_field(20))).unwrap().world;
    assert_eq!(seen.progress, Progress::Done);
    let rows: Vec<Row> = seen.drive.telemetry().run().copied().collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("experiment.toml");
    std::fs::write(folder.path().join("recording.csv"), csv(&rows, &setup, setup.telemetry_every)).unwrap();
    std::fs::write(&file, experiment("device", "recording.csv", &setup)).unwrap();

    let tool = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../target/release/shakedown");
    let output = Command::new(&tool).arg("diagnose").arg(&file).args(["--json", "-"]).output().unwrap();
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["verdict"], "complete", "{value:#}");
}
