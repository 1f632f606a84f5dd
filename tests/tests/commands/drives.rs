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
    done(folder.path(), "modify near-field-moderate --method taut --out b.rpc");
    assert!(folder.path().join("b.toml").exists());
    done(folder.path(), "run --record b.rpc --trace b-trace.csv --json b.json");
    let message = done(folder.path(), "modify near-field-moderate --method taut --out b16.rpc --sixteen-bit");
    assert!(message.contains("sixteen bits"), "{message}");
    done(folder.path(), "run --record b16.rpc --json b16.json");
    done(folder.path(), "modify near-field-moderate --method taut --out c.csv --drive-unit V --volts-per-metre 80");
    done(folder.path(), "run --record c.csv --json c.json");
    done(folder.path(), "modify near-field-moderate --method taut --out d.csv --drive-unit %");
    done(folder.path(), "run --record d.csv --json d.json");
    let e_d = |name: &str| json(folder.path(), name)["metrics"]["e_d"].as_f64().unwrap();
    assert!((e_d("c.json") - e_d("d.json")).abs() < 1e-9);
    for name in ["b.json", "b16.json"] {
        assert!((e_d(name) - e_d("d.json")).abs() < 1e-3, "{name}: {} {}", e_d(name), e_d("d.json"));
    }
    // Single precision holds what the text does.
    done(folder.path(), "modify near-field-moderate --method taut --out e.csv");
    let (text, played) = (column(&folder.path().join("e.csv"), 1), column(&folder.path().join("b-trace.csv"), 1));
    let peak = text.iter().fold(0.0_f64, |p, mm| p.max(mm.abs())) * 1e-3;
    let worst = text.iter().zip(&played).map(|(mm, m)| (mm * 1e-3 - m).abs()).fold(0.0, f64::max);
    println!("RPC III: {:.1e} of the peak apart at most", worst / peak);
    assert!(worst <= 1e-6 * peak, "{worst} m of {peak} m");
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

/// `compare` by what the files are: a drive and its recording, two recordings, two results; and what does not go together.
#[test]
fn comparing_goes_by_what_the_files_are() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    done(at, "modify near-field-moderate --method taut --velocity 0.1 --out drive.csv");
    for (name, controller) in [("a", "strong"), ("b", "current")] {
        let line = format!("run --record drive.csv --controller {controller} --trace {name}.csv --json {name}.json");
        done(at, &line);
    }
    done(at, "compare drive.csv a.csv --json played.json --report played.html");
    let played = json(at, "played.json");
    let number = |place: &str| played.pointer(place).and_then(serde_json::Value::as_f64).unwrap();
    assert!(number("/start_s").abs() < 2e-3 && number("/covered") > 0.999, "{played}");
    assert!(number("/reference_error") < 1e-3);
    let ran = json(at, "a.json");
    let of_run = |place: &str| ran.pointer(place).and_then(serde_json::Value::as_f64).unwrap();
    assert!((number("/metrics/e_d") - of_run("/metrics_with_sensors/e_d")).abs() < 5e-3);
    assert!((number("/metrics/e_a") - of_run("/metrics_with_sensors/e_a")).abs() < 0.02);
    assert!((number("/delay_s") - of_run("/indices/delay_s")).abs() < 3e-3);
    assert!(played["runs_entry"].as_str().unwrap().contains("[[runs]]\nfile = \"a.csv\""));
    // The order does not matter, and another drive is none of it.
    done(at, "compare a.csv drive.csv");
    done(at, "modify far-field --method taut --velocity 0.1 --out other.csv");
    let other = run(at, "compare other.csv a.csv");
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("nothing in the recording resembles the drive"));
    done(at, "compare a.json b.json --json both.json");
    let both = json(at, "both.json");
    assert!(both["differ"].as_u64().unwrap() > 5);
    let values = both["values"].as_array().unwrap();
    assert!(values.iter().any(|v| v["value"] == "metrics.e_a" && v["a"] != v["b"]));
    let mixed = run(at, "compare a.json a.csv");
    assert_eq!(mixed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&mixed.stderr).contains("is a result and a.csv is a recording"));
}

/// A campaign runs what is missing and nothing twice; pieces make the whole; a wrong name is refused before anything runs.
#[test]
fn a_campaign_goes_on_where_it_stopped() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    for (name, hertz) in [("slow", 0.8), ("fast", 2.5)] {
        let mut text = String::from("time [s],acceleration [g]\n");
        for k in 0..1200 {
            let t = f64::from(k) * 0.01;
            let rise = (t / 3.0).min((12.0 - t) / 3.0).clamp(0.0, 1.0);
            text += &format!("{t:.2},{:.6}\n", 0.05 * rise * (std::f64::consts::TAU * hertz * t).sin());
        }
        fs::write(at.join(format!("{name}.csv")), text).unwrap();
    }
    let campaign =
        "records = [\"slow.csv\", \"fast.csv\"]\nscales = [0.5, \"0.06g\"]\ncontrollers = [\"current\", \"strong\"]\n";
    fs::write(at.join("autumn.toml"), campaign).unwrap();
    let said = done(at, "campaign autumn.toml --out results --shard 1/2 --json half.json");
    assert!(said.contains("8 tests: 0 done before, 4 to run"), "{said}");
    assert_eq!(json(at, "half.json")["open"].as_u64(), Some(4));
    let said = done(at, "campaign autumn.toml --out results --json all.json --report all.html");
    assert!(said.contains("8 tests: 4 done before, 4 to run"), "{said}");
    let all = json(at, "all.json");
    let results = all["results"].as_array().unwrap();
    assert_eq!(results.len(), 8);
    let peak = |i: usize| results[i].pointer("/metrics/reference_peak_g").and_then(serde_json::Value::as_f64).unwrap();
    assert!((peak(2) / 0.06 - 1.0).abs() < 0.05 && peak(0) < 0.03, "{} {}", peak(0), peak(2));
    let said = done(at, "campaign autumn.toml --out results");
    assert!(said.contains("8 done before, 0 to run"), "{said}");
    fs::write(at.join("wrong.toml"), campaign.replace("strong", "stronger")).unwrap();
    let wrong = run(at, "campaign wrong.toml --out elsewhere");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("stronger") && !at.join("elsewhere").exists());
}

/// A learnt drive carries what it is true for, and is refused where that has changed.
#[test]
fn a_learnt_drive_goes_on_or_is_stale() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let learn = "learn --seed 2 --velocity 0.2 --runs 2";
    done(at, &format!("{learn} --out learnt.csv --json first.json"));
    let text = fs::read_to_string(at.join("learnt.csv")).unwrap();
    assert!(text.contains("# method = learnt, run 2 of 2") && text.contains("# model_sha256 = the paper's table"));
    done(at, &format!("{learn} --from learnt.csv --json second.json"));
    let e_a = |name: &str, run: usize| json(at, name)["runs"][run]["e_a"].as_f64().unwrap();
    assert!((e_a("second.json", 0) / e_a("first.json", 1) - 1.0).abs() < 0.2, "it begins where it stopped");
    let stale = run(at, &format!("{learn} --controller strong --from learnt.csv"));
    assert_eq!(stale.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&stale.stderr).contains("is stale: its controller"));
    let warned = done(at, "run --record learnt.csv --controller strong");
    assert!(warned.contains("the drive is stale: it was learnt with controller = current"), "{warned}");
    assert!(!done(at, "run --record learnt.csv").contains("stale"));
    done(at, "learn --check check.csv");
    fs::write(at.join("soft.toml"), SOFT).unwrap();
    for (name, table) in [("then", "stiff"), ("now", "stiff"), ("later", "soft")] {
        fs::write(at.join("stiff.toml"), SOFT.replace("3.4", "4.0")).unwrap();
        done(at, &format!("run --record check.csv --controller strong --table {table}.toml --trace {name}.csv"));
    }
    done(at, "compare then.csv now.csv --json same.json");
    assert_eq!(json(at, "same.json")["stale"].as_bool(), Some(false));
    let from = format!("{learn} --from learnt.csv --check-then then.csv --check-now");
    let said = done(at, &format!("{from} now.csv --json fresh.json"));
    assert!(said.contains("the drive holds"), "{said}");
    assert_eq!(json(at, "fresh.json")["checked"]["stale"].as_bool(), Some(false));
    let softer = run(at, &format!("{from} later.csv"));
    let said = String::from_utf8_lossy(&softer.stderr).into_owned();
    assert_eq!(softer.status.code(), Some(2), "{said}");
    assert!(
        said.contains("learnt.csv: is stale: later.csv answers") && said.contains("the specimen has changed"),
        "{said}"
    );
}

/// Learning on a table itself: the next drive from the recording of the last one, run by run.
#[test]
fn a_table_that_is_recorded_teaches_the_next_drive() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    let learn = "learn --seed 2 --velocity 0.2";
    done(at, &format!("{learn} --runs 1 --out 1.csv"));
    let mut errors = Vec::new();
    for run in 1..=3 {
        done(at, &format!("run --record {run}.csv --controller current --trace played{run}.csv"));
        let next = run + 1;
        done(at, &format!("{learn} --from {run}.csv --played played{run}.csv --out {next}.csv --json {run}.json"));
        let result = json(at, &format!("{run}.json"));
        assert_eq!(result["run"].as_u64(), Some(run));
        assert!(result.pointer("/next/velocity").and_then(serde_json::Value::as_f64).unwrap() <= 0.2);
        errors.push(result["e_a"].as_f64().unwrap());
    }
    println!("E_a run by run: {errors:.3?}");
    assert!(errors[1] < 0.35 * errors[0] && errors[2] <= 1.05 * errors[1], "{errors:?}");
    let text = fs::read_to_string(at.join("4.csv")).unwrap();
    assert!(text.contains("# run = 4\n") && text.contains("# recording = played3.csv"), "{}", &text[..800]);
    // What the table did of half of it teaches nothing, and of another drive neither.
    let trace = fs::read_to_string(at.join("played1.csv")).unwrap();
    let half: Vec<&str> = trace.lines().take(trace.lines().count() / 2).collect();
    fs::write(at.join("half.csv"), half.join("\n")).unwrap();
    let refused = run(at, &format!("{learn} --from 1.csv --played half.csv"));
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("record the whole of it"));
}

/// A record fitted to a required spectrum and to the table's limits; what no motion reaches is proven, and said by its frequency.
#[test]
fn a_record_is_fitted_to_a_required_spectrum() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("floor.csv"), "frequency [Hz],acceleration [g]\n1,0.15\n3,0.4\n8,0.4\n33,0.2\n").unwrap();
    fs::write(at.join("far.csv"), "1,15\n3,40\n8,40\n33,20\n").unwrap();
    let modify = "modify near-field-moderate --objective spectrum --velocity 0.5 --stroke 0.125";
    done(at, &format!("{modify} --standard own --rrs floor.csv --out a.rpc --json a.json --report a.html"));
    let found = json(at, "a.json");
    let number = |key: &str| found[key].as_f64().unwrap();
    assert_eq!(found["way"].as_str(), Some("the record, its spectrum corrected"));
    assert!((1.0..1.1).contains(&number("margin")), "{}", number("margin"));
    assert!(number("peak_velocity") <= 0.5 && number("peak_displacement") <= 0.125);
    let over = found["spectrum"]
        .as_array()
        .unwrap()
        .iter()
        .map(|o| o["reached"].as_f64().unwrap() / o["required"].as_f64().unwrap());
    let over: Vec<f64> = over.collect();
    let mean = over.iter().sum::<f64>() / over.len() as f64;
    println!("reached over required: {mean:.3} in the mean");
    assert!(mean < 1.5, "a fit comes near: {mean}");
    done(at, "qualify a.rpc --standard own --rrs floor.csv");
    let proof = run(at, &format!("{modify} --standard own --rrs far.csv --json far.json"));
    assert_eq!(proof.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&proof.stderr).contains("No motion within the table's limits"));
    assert_eq!(json(at, "far.json")["outcome"].as_str(), Some("impossible"));
    for (line, said) in [
        ("modify near-field-moderate --standard own --rrs floor.csv", "--objective spectrum"),
        ("modify near-field-moderate --objective spectrum --rrs floor.csv", "--standard"),
        ("modify near-field-moderate --objective spectrum --standard own", "--rrs FILE"),
        ("modify near-field-moderate --objective spectrum --standard own --rrs floor.csv --band 0.1,0.5", "--band"),
        ("qualify a.rpc", "--standard"),
        // A record is judged, not a motion of the command's own.
        ("qualify none.AT2 --standard own --rrs floor.csv --velocity 1", "cannot be used with"),
        ("qualify a.rpc --standard own --rrs floor.csv --seed 2", "cannot be used with"),
        ("qualify a.rpc --standard own --rrs floor.csv --drive-unit V", "is judged as it is"),
    ] {
        let refused = run(at, line);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && message.contains(said), "{line}: {message}");
    }
}

/// The table with a payload that has softened.
const SOFT: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n\
    effects = [\"payload_resonance\"]\n[effects.payload_resonance]\nmass_ratio = 0.3\nfrequency = 3.4\ndamping = 0.03\n";

/// What `learn` and `qualify` write is a drive of every form and unit, the table's where nothing else is asked for.
#[test]
fn every_command_writes_drives_in_the_controllers_unit() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    fs::write(at.join("rig.toml"), format!("{SERVO}[table]\nstroke = 0.2\ndrive_unit = \"V\"\nvolts_per_metre = 50\n"))
        .unwrap();
    let learn = "learn --velocity 0.2 --runs 1";
    done(at, &format!("{learn} --table rig.toml --out a.csv"));
    done(at, &format!("{learn} --table rig.toml --out b.csv --drive-unit mm --rate 2048"));
    let (volts, mm) = (column(&at.join("a.csv"), 1), column(&at.join("b.csv"), 1));
    let peak = |values: &[f64]| values.iter().fold(0.0_f64, |p, v| p.max(v.abs()));
    assert!((peak(&volts) / 50.0 / (peak(&mm) * 1e-3) - 1.0).abs() < 1e-3, "{} V, {} mm", peak(&volts), peak(&mm));
    assert!(mm.len() > 2 * volts.len());
    done(at, &format!("{learn} --out c.AT2"));
    assert!(fs::read_to_string(at.join("c.AT2")).unwrap().starts_with("SHAKEDOWN DRIVE, NOT A RECORDED"));
    done(at, &format!("{learn} --out d.rpc --drive-unit %"));
    done(at, "run --record d.rpc");
    for (line, said) in [
        (format!("{learn} --out e.mat"), "e.mat"),
        (format!("{learn} --rate 500"), "--out"),
        (format!("{learn} --out e.csv --sixteen-bit"), "is for RPC III"),
        (format!("{learn} --played a.csv"), "--from"),
        (format!("{learn} --check-then a.csv --check-now b.csv"), "name the drive"),
        ("qualify --standard ac156 --sds 0.5 --synthesise e.rpc".into(), "--velocity and --stroke"),
        ("qualify --standard ac156 --sds 0.5 --synthesise e.txt".into(), ".csv, .rpc"),
    ] {
        let refused = run(at, &line);
        let message = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(refused.status.code() == Some(2) && message.contains(said), "{line}: {message}");
    }
    let qualify = "--standard ac156 --sds 0.2 --z-over-h 0";
    done(at, &format!("qualify {qualify} --synthesise f.AT2"));
    done(at, &format!("qualify f.AT2 {qualify}"));
    done(at, &format!("qualify {qualify} --synthesise g.csv --velocity 0.5 --stroke 0.125 --json g.json"));
    let text = fs::read_to_string(at.join("g.csv")).unwrap();
    assert!(text.contains("# limit_velocity = 0.5") && text.contains("# unit = mm"), "{}", &text[..600]);
    // What is held against the standard again is the drive, at the controller's rate.
    done(at, &format!("qualify g.csv {qualify} --json again.json"));
    let margin = |name: &str| json(at, name)["margin"].as_f64().unwrap();
    assert!(
        (margin("again.json") / margin("g.json") - 1.0).abs() < 5e-3,
        "{} {}",
        margin("again.json"),
        margin("g.json")
    );
}

const SERVO: &str = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
