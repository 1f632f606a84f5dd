//! Bad input on the command line: exit status 2, one message that names the file, the place and the remedy, and nothing
//! written, half or whole.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::Path;
use std::process::{Output, Stdio};
use tempfile::TempDir;

/// Runs the binary in a folder, asking for both outputs.
fn run(folder: &TempDir, arguments: &[&str]) -> Output {
    let mut command = shakedown();
    command.current_dir(folder.path()).args(arguments).args(["--json", "out.json", "--report", "out.html"]);
    command.output().unwrap()
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

fn files(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// The one message of a refusal, after checking that it is one.
fn refusal(folder: &TempDir, arguments: &[&str]) -> String {
    let before = files(folder.path());
    let output = run(folder, arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} printed {}", String::from_utf8_lossy(&output.stdout));
    assert_eq!(message.matches("error: ").count(), 1, "{message}");
    assert_eq!(files(folder.path()), before, "{arguments:?} left something behind");
    message
}

/// Every command that reads a record from `--record`.
const READERS: [&[&str]; 2] = [&["run"], &["sweep", "trade-off"]];

/// Refusals of `name` by every reader; each must hold all of `parts`.
fn every_reader_refuses(folder: &TempDir, name: &str, options: &[&str], parts: &[&str]) {
    for command in READERS {
        let message = refusal(folder, &[command, &["--record", name], options].concat());
        for part in [&[name], parts].concat() {
            assert!(message.contains(part), "{command:?}: `{part}` is not in: {message}");
        }
    }
}

const COLUMNS: [&str; 4] = ["--dt", "0.01", "--unit", "g"];

#[test]
fn a_missing_file_is_named() {
    let folder = TempDir::new().unwrap();
    every_reader_refuses(&folder, "none.AT2", &[], &["no such file", "check the path"]);
    assert!(refusal(&folder, &["run", "none.toml"]).contains("none.toml"));
    assert!(refusal(&folder, &["table1", "--records", "nowhere"]).contains("nowhere"));
    assert!(refusal(&folder, &["table1", "--records", "."]).contains("KJM000"));
}

#[test]
fn a_wrong_unit_is_refused() {
    let folder = TempDir::new().unwrap();
    write(&folder, "a.txt", &"0.1\n-0.2\n".repeat(50));
    let message = refusal(&folder, &["run", "--record", "a.txt", "--dt", "0.01", "--unit", "furlong"]);
    assert!(message.contains("`furlong`") && message.contains("expected m/s2"), "{message}");
    every_reader_refuses(&folder, "a.txt", &["--dt", "0.01"], &["unit"]);
    let at2 = "PEER\nx\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 4, DT= .0100 SEC\n 0.1 -0.1 0.1 -0.1\n";
    write(&folder, "a.AT2", at2);
    every_reader_refuses(&folder, "a.AT2", &["--unit", "m/s2"], &["m/s2 (--unit) but g in the file"]);
}

#[test]
fn rows_that_are_no_numbers_are_refused_with_their_line() {
    let folder = TempDir::new().unwrap();
    write(&folder, "a.txt", "0.1\n0.2\nNaN\n0.3\n");
    every_reader_refuses(&folder, "a.txt", &COLUMNS, &["line 3", "not finite", "interpolation"]);
}

#[test]
fn a_header_peak_that_the_data_contradict_is_quoted_beside_them() {
    let folder = TempDir::new().unwrap();
    let header = "Origin Time       2018/01/24 19:51:00\nLat.              41.0\nLong.             142.4\n\
                  Depth. (km)       34\nMag.              6.3\nStation Code      AOM001\nStation Lat.      41.5\n\
                  Station Long.     140.9\nStation Height(m) 5\nRecord Time       2018/01/24 19:51:41\n\
                  Sampling Freq(Hz) 100Hz\nDuration Time(s)  1\nDir.              N-S\n\
                  Scale Factor      3920(gal)/6182761\nMax. Acc. (gal)   9.9\nLast Correction   2018/01/24 19:51:26\nMemo.\n";
    let rows = "1000 -1000 1000 -1000 1000 -1000 1000 -1000\n".repeat(12) + "1000 -1000 1000 -1000\n";
    write(&folder, "a.NS", &(header.to_owned() + &rows));
    every_reader_refuses(&folder, "a.NS", &[], &["line 15", "9.9 gal", "0.634 gal"]);
}

#[test]
fn an_empty_file_is_refused() {
    let folder = TempDir::new().unwrap();
    write(&folder, "a.AT2", "");
    every_reader_refuses(&folder, "a.AT2", &[], &["empty"]);
}

#[test]
fn a_gigabyte_is_refused_unread() {
    let folder = TempDir::new().unwrap();
    fs::File::create(folder.path().join("a.AT2")).unwrap().set_len(1 << 30).unwrap();
    every_reader_refuses(&folder, "a.AT2", &[], &["1073741824 bytes"]);
}

/// A file of a gigabyte where a person's own is expected.
#[test]
fn a_gigabyte_is_refused_by_whoever_reads_what_people_write() {
    let folder = TempDir::new().unwrap();
    fs::File::create(folder.path().join("large.toml")).unwrap().set_len(1 << 30).unwrap();
    write(&folder, "settings.toml", "settings = \"large.toml\"\n");
    write(&folder, "table.toml", "table = \"large.toml\"\n");
    let readers: [&[&str]; 7] = [
        &["run", "large.toml"],
        &["run", "settings.toml"],
        &["run", "table.toml"],
        &["run", "--table", "large.toml"],
        &["identify", "large.toml"],
        &["diagnose", "large.toml"],
        &["design", "large.toml"],
    ];
    for command in readers {
        let message = refusal(&folder, command);
        assert!(message.contains("large.toml") && message.contains("16777216 bytes"), "{command:?}: {message}");
    }
}

/// What a scenario or a table states out of all proportion is an error and no result.
#[test]
fn what_leaves_the_numbers_is_refused() {
    let folder = TempDir::new().unwrap();
    let servo = "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\nvelocity_limit = 0.242\n";
    write(
        &folder,
        "negative.toml",
        &format!("{servo}effects = [\"leakage\"]\n[effects.leakage]\ncoefficient = -1.0\n"),
    );
    write(&folder, "noise.toml", "[sensors]\nacceleration_noise = nan\n");
    write(&folder, "huge.toml", "conditioning = [{ do = \"scale\", factor = 1e300 }]\n");
    for (command, part) in [
        (
            &["run", "--table", "negative.toml"][..],
            "line 8, `effects.leakage.coefficient`: is -1; it cannot be negative",
        ),
        (&["run", "noise.toml"], "acceleration_noise = NaN"),
        (&["run", "huge.toml"], "step 1 makes the motion larger"),
    ] {
        let message = refusal(&folder, command);
        assert!(message.contains(part), "{command:?}: {message}");
    }
}

#[test]
fn a_scenario_is_refused_with_its_line() {
    let folder = TempDir::new().unwrap();
    write(&folder, "a.toml", "controller = \"strong\"\nvelocity = 1\n");
    assert!(refusal(&folder, &["run", "a.toml"]).contains("a.toml, line 2: unknown key `velocity`"));
    write(&folder, "b.toml", "controller = \"fast\"\n");
    assert!(refusal(&folder, &["run", "b.toml"]).contains("`fast`: expected one of current"));
    write(&folder, "c.toml", "[record]\nfile = \"none.AT2\"\n");
    assert!(refusal(&folder, &["run", "c.toml"]).contains("none.AT2"));
}

#[test]
fn options_that_cannot_be_are_refused() {
    let folder = TempDir::new().unwrap();
    for (arguments, part) in [
        (&["run", "--controller", "fast"][..], "fast"),
        (&["run", "--scale-to", "0.74"], "no unit"),
        (&["run", "--dt", "0.01"], "--record"),
        (&["sweep", "bode", "--step", "0"], "--step"),
        (&["sweep", "bode", "--gains", "3.7"], "Kp,Ki"),
        (&["sweep", "slew-rate", "--area", "0"], "--area"),
        (&["sweep", "everything"], "everything"),
        (&["learn", "--from", "none.csv"], "no such file"),
        (&["learn", "--check", "check.csv"], "--check"),
        (&["init", ".", "--out", "a/b.toml"], "beside the recordings"),
    ] {
        let message = refusal(&folder, arguments);
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
}

/// A table whose file states no speed is told so, not that an option which nobody gave is infinite.
#[test]
fn a_table_without_a_limit_is_told_what_it_lacks() {
    let folder = TempDir::new().unwrap();
    write(&folder, "slow.toml", "[model]\nkind = \"servo\"\nb1 = 0.69\nb0 = 138.0\na1 = 57.65\n");
    let message = refusal(&folder, &["learn", "--table", "slow.toml"]);
    assert!(message.contains("slow.toml: [model] states no velocity_limit"), "{message}");
}

#[test]
fn an_effect_that_is_stated_twice_is_found() {
    let folder = TempDir::new().unwrap();
    let effect = include_str!("../../examples/effects/accelerometer_curvature.toml");
    write(&folder, "once.toml", effect);
    write(&folder, "twice.toml", &format!("{effect}\n{effect}"));
    assert!(run(&folder, &["effects", "--check", "once.toml"]).status.success());
    let output = run(&folder, &["effects", "--check", "twice.toml"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && message.contains("stated twice"), "{message}");
}

/// What somebody wrote is not written over by recordings that can be made again.
#[test]
fn an_experiment_is_not_written_over() {
    let folder = TempDir::new().unwrap();
    let made = || shakedown().current_dir(folder.path()).args(["sweep", "--write", "made"]).output().unwrap();
    write(&folder, "experiment.toml", "# mine");
    let output = shakedown().current_dir(folder.path()).args(["sweep", "--write", "."]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(fs::read_to_string(folder.path().join("experiment.toml")).unwrap(), "# mine");
    assert_eq!([made(), made()].map(|output| output.status.code()), [Some(0), Some(2)]);
}

/// A place that takes no file is refused before the work, whatever option names it.
#[test]
fn a_place_that_takes_no_file_is_refused_before_the_work() {
    let folder = TempDir::new().unwrap();
    write(&folder, "file", "");
    for arguments in [
        &["run", "--trace", "file/a.csv"][..],
        &["run", "--trace", "."],
        &["modify", "none.AT2", "--out", "file/a.AT2"],
        &["design", "none.toml", "--out", "file/a.toml"],
        &["identify", "none.toml", "--out", "file/a.toml"],
        &["diagnose", "none.toml", "--model", "file/a.toml"],
    ] {
        let message = refusal(&folder, arguments);
        assert!(message.contains("no file can be written there"), "{arguments:?}: {message}");
    }
}

/// No result is written over what is read, nor over another result.
#[test]
fn two_arguments_that_name_one_file_are_refused() {
    let folder = TempDir::new().unwrap();
    write(&folder, "kobe.AT2", "as it was recorded");
    fs::create_dir(folder.path().join("below")).unwrap();
    for (arguments, part) in [
        (&["modify", "kobe.AT2", "--out", "kobe.AT2"][..], "<RECORD> and --out <FILE> name one file"),
        (&["modify", "kobe.AT2", "--out", "below/../kobe.AT2"], "name one file"),
        (&["run", "--record", "kobe.AT2", "--trace", "./kobe.AT2"], "name one file"),
        (&["run", "--trace", "out.json"], "name one file"),
        (&["run", "--trace", "below/../out.html"], "name one file"),
        (&["run", "--trace", "-"], "standard output is not among its places"),
    ] {
        let message = refusal(&folder, arguments);
        assert!(message.contains(part), "{arguments:?}: {message}");
    }
    assert_eq!(fs::read_to_string(folder.path().join("kobe.AT2")).unwrap(), "as it was recorded");
    let output = shakedown().args(["effects", "--json", "/dev/null", "--report", "/dev/null"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// What was never meant to be TOML is told where it goes.
#[test]
fn a_record_in_place_of_a_scenario_is_told_where_it_goes() {
    let folder = TempDir::new().unwrap();
    write(&folder, "kobe.AT2", "PEER STRONG MOTION DATABASE RECORD\n");
    write(&folder, "recording.csv", "time [s],displacement [mm]\n0,0\n");
    assert!(refusal(&folder, &["run", "kobe.AT2"]).contains("given by --record"));
    for command in ["identify", "diagnose"] {
        assert!(refusal(&folder, &[command, "recording.csv"]).contains("`shakedown init FOLDER`"));
    }
    fs::create_dir(folder.path().join("empty")).unwrap();
    assert!(refusal(&folder, &["faults", "--records", "empty"]).contains("empty: no PEER record"));
}

/// An interrupt in the middle of the work leaves nothing behind, neither the outputs nor parts of them.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_nothing() {
    let folder = TempDir::new().unwrap();
    let mut child = shakedown()
        .current_dir(folder.path())
        .args(["sweep", "bode", "--step", "0.01", "--json", "out.json", "--report", "out.html"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(child.try_wait().unwrap().is_none(), "the work was over before it was interrupted");
    let sent = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert!(!child.wait().unwrap().success());
    assert_eq!(files(folder.path()), Vec::<String>::new());
}
