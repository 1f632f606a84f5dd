//! Drives and outputs from the command line: written through links and devices, read back, played as they are, and no failure
//! of a disk or a pipe that ends with status 0.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]
#![cfg(unix)]

use shakedown_tests::binary::shakedown;
use std::fs::{self, File};
use std::os::unix::fs::{FileTypeExt as _, PermissionsExt as _, symlink};
use std::path::Path;
use std::process::{Output, Stdio};
use tempfile::TempDir;

fn run(folder: &Path, line: &str) -> Output {
    shakedown().current_dir(folder).args(line.split(' ')).output().unwrap()
}

fn done(folder: &Path, line: &str) -> String {
    let output = run(folder, line);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {message}");
    message
}

fn json(folder: &Path, name: &str) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join(name)).unwrap()).unwrap()
}

/// Values of the second column of a drive's rows, or of the named column of a run's trace.
fn column(path: &Path, index: usize) -> Vec<f64> {
    let text = fs::read_to_string(path).unwrap();
    let rows = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|line| line.split(',').nth(index).unwrap().parse().unwrap()).collect()
}

#[test]
fn a_drive_says_where_it_comes_from_and_is_played_as_it_is() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    done(
        folder.path(),
        "modify near-field-moderate --method taut --out drive.csv --drive displacement --unit mm --rate 1000 --json fit.json",
    );
    let text = fs::read_to_string(at("drive.csv")).unwrap();
    assert!(text.starts_with("# shakedown drive 1: not a recorded ground motion"), "{}", &text[..80]);
    for fact in [
        "source = generated near-field-moderate",
        "limit_velocity = 0.242",
        "limit_stroke = 0.12",
        "method = taut",
        "command_line = shakedown modify",
        "version = ",
    ] {
        assert!(text.contains(fact), "{fact}");
    }
    assert_eq!(json(folder.path(), "fit.json")["drive"]["unit"].as_str(), Some("mm"));
    done(
        folder.path(),
        "run --record drive.csv --controller strong --trace trace.csv --json run.json --report run.html",
    );
    let (written, played) = (column(&at("drive.csv"), 1), column(&at("trace.csv"), 1));
    assert_eq!(written.len(), played.len());
    let peak = written.iter().fold(0.0_f64, |p, v| p.max(v.abs())) * 1e-3;
    let worst = written.iter().zip(&played).map(|(mm, m)| (mm * 1e-3 - m).abs()).fold(0.0, f64::max);
    assert!(worst <= 1e-6 * peak, "{worst} m of {peak} m");
    let result = json(folder.path(), "run.json");
    assert_eq!(result["conditioning"].as_str(), Some("none: a drive is played as it is"));
    assert_eq!(result["drive"]["source"].as_str(), Some("generated near-field-moderate-1"));
    assert!(fs::read_to_string(at("run.html")).unwrap().contains("a drive is played as it is"));
    // The fit's own figure and the drive's: what is commanded never passes the limit.
    let speed = written.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!(speed <= 0.242 && speed > 0.2419, "{speed} m/s");
}

#[test]
fn other_forms_and_units_read_back() {
    let folder = TempDir::new().unwrap();
    done(folder.path(), "modify near-field-moderate --method taut --out a.AT2 --rate 1000");
    done(folder.path(), "run --record a.AT2 --json a.json");
    let message = done(folder.path(), "modify near-field-moderate --method taut --out b.rpc");
    assert!(message.contains("sixteen bits"), "{message}");
    assert!(folder.path().join("b.toml").exists());
    done(folder.path(), "run --record b.rpc --json b.json");
    done(folder.path(), "modify near-field-moderate --method taut --out c.csv --drive-unit V --volts-per-metre 80");
    done(folder.path(), "run --record c.csv --json c.json");
    done(folder.path(), "modify near-field-moderate --method taut --out d.csv --drive-unit %");
    done(folder.path(), "run --record d.csv --json d.json");
    let e_d = |name: &str| json(folder.path(), name)["metrics"]["e_d"].as_f64().unwrap();
    assert!((e_d("c.json") - e_d("d.json")).abs() < 1e-9);
    assert!((e_d("b.json") - e_d("d.json")).abs() < 1e-3, "{} {}", e_d("b.json"), e_d("d.json"));
    let again = run(folder.path(), "modify a.AT2");
    assert_eq!(again.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&again.stderr).contains("is a drive"));
}

/// Neither a link nor a device is replaced, and others may read what was written.
#[test]
fn outputs_go_through_links_and_devices() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("target.csv"), "stale").unwrap();
    symlink(at("target.csv"), at("link.csv")).unwrap();
    let modify = "modify near-field-moderate --method clip --out";
    done(folder.path(), &format!("{modify} link.csv"));
    assert!(fs::symlink_metadata(at("link.csv")).unwrap().is_symlink());
    assert!(fs::read_to_string(at("target.csv")).unwrap().starts_with("# shakedown drive"));
    done(folder.path(), &format!("{modify} new.csv"));
    fs::write(at("plain"), "").unwrap();
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode("new.csv"), mode("plain"));
    done(folder.path(), &format!("{modify} /dev/null"));
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    if Path::new("/dev/full").exists() {
        let full = run(folder.path(), &format!("{modify} /dev/full"));
        assert_eq!(full.status.code(), Some(1), "{}", String::from_utf8_lossy(&full.stderr));
        assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
    }
}

/// A full disk behind standard output, and a reader that has gone.
#[test]
fn what_was_not_written_is_no_success() {
    if !Path::new("/dev/full").exists() {
        eprintln!("SKIPPED: no /dev/full here");
        return;
    }
    for line in [
        "effects",
        "effects --markdown",
        "effects --json -",
        "sweep slew-rate",
        "effects leakage",
        "--help",
        "--version",
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = shakedown().args(line.split(' ')).stdout(full).stderr(Stdio::piped()).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{line}: {message}");
        assert!(message.contains("standard output: cannot write"), "{line}: {message}");
        // And neither does a standard error that takes nothing make it panic.
        let full = || File::options().write(true).open("/dev/full").unwrap();
        let status = shakedown().args(line.split(' ')).stdout(full()).stderr(full()).status().unwrap();
        assert_eq!(status.code(), Some(1), "{line}");
    }
    // Gone before the program starts: one that goes while it writes may have taken everything.
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let output = shakedown().args(["effects", "--markdown"]).stdout(writer).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
