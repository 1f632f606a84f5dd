//! Every command that takes `--json` and `--report` writes both.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "the lint knows test functions, not helpers")]

use shakedown_tests::binary::shakedown;
use std::fmt::Write as _;
use std::fs;
use tempfile::TempDir;

/// A recording of a sine, as a logger would write it.
fn recording() -> String {
    let mut text = String::from("time [s],reference [mm],displacement [mm]\n");
    for k in 0..2000 {
        let t = f64::from(k) * 0.005;
        let _ = writeln!(text, "{t:.3},{:.4},{:.4}", 20.0 * (3.0 * t).sin(), 19.0 * (3.0 * t - 0.2).sin());
    }
    text
}

#[test]
fn a_command_that_takes_a_place_writes_there() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("recordings")).unwrap();
    fs::write(folder.path().join("recordings/a.csv"), recording()).unwrap();
    for (number, arguments) in [
        &["effects"][..],
        &["effects", "leakage"],
        &["init", "recordings"],
        &["init", "recordings", "--out", "-", "--force"],
        &["sweep", "slew-rate"],
        &["faults", "--runs", "3"],
        &["faults", "--run", "3"],
        &["run"],
    ]
    .into_iter()
    .enumerate()
    {
        let [json, report] = ["json", "html"].map(|end| format!("made/{number}.{end}"));
        let mut command = shakedown();
        command.current_dir(folder.path()).args(arguments).args(["--json", &json, "--report", &report]);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        let json = fs::read_to_string(folder.path().join(json)).unwrap();
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(value["version"].as_str(), Some(env!("CARGO_PKG_VERSION")), "{arguments:?}");
        let page = fs::read_to_string(folder.path().join(report)).unwrap();
        assert!(page.contains("</html>") && !page.contains("http://"), "{arguments:?}");
    }
}
