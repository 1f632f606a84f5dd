//! Identification against known truth and real recordings. Prints the figures it asserts:
//! `cargo test --release -p shakedown --test identify -- --nocapture --test-threads 1`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "the lint knows test functions, not helpers"
)]

#[path = "support/coverage.rs"]
mod coverage;

#[path = "support/skipped.rs"]
mod skipped;

use shakedown::blocks::closed_loop::sweep_recording;
use shakedown::blocks::diagnose::leftover;
use shakedown::blocks::identify::{Score, fitted, prepare, score};
use shakedown::blocks::plant::paper::Paper;
use shakedown::identify::{Identified, IdentifyError, identify};
use shakedown::recording::{Experiment, Fault, Severity, check, is_bad_data};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder of the development data, or nothing and a line that says so.
fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SHAKEDOWN_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    let path = folder.join("recordings").join(name);
    if path.exists() {
        return path.canonicalize().ok();
    }
    skipped::without(&path);
    None
}

fn load(folder: &TempDir, text: &str) -> Experiment {
    let path = folder.path().join("e.toml");
    fs::write(&path, text).unwrap();
    Experiment::load(&path).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn found(text: &str) -> Identified {
    identify(&load(&TempDir::new().unwrap(), text)).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn print(found: &Identified) {
    for (name, q) in &found.quantities {
        println!("  {name:28} {:12.5} +/- {:.2e} ({:?} to {:?})", q.value, q.std.unwrap_or(f64::NAN), q.low, q.high);
    }
    println!("  fitted {:?}\n  held out {:?}", found.fitted.nrmse, found.held_back.nrmse);
    for doubt in found.doubts() {
        println!("  {doubt}");
    }
}

fn value(found: &Identified, name: &str) -> f64 {
    found.quantities[name].value
}

fn nrmse(score: &Score, channel: &str) -> f64 {
    score.nrmse.iter().find(|(c, _)| c.name() == channel).unwrap().1
}

/// Eq. 7 and 0.242 m/s from sweeps with the laboratory's noise, from starting values some thirty per cent off.
#[test]
fn the_paper_is_recovered_from_simulated_sweeps() {
    let folder = TempDir::new().unwrap();
    let path = sweep_recording::write(folder.path(), Paper::default(), 1).unwrap();
    let experiment = Experiment::load(&path).unwrap();
    let found = identify(&experiment).unwrap();
    print(&found);
    for (name, truth, bound) in
        [("b1", 0.69, 0.05), ("b0", 138.0, 0.02), ("a1", 57.65, 0.02), ("velocity_limit", 0.242, 0.02)]
    {
        let error = value(&found, name) / truth - 1.0;
        println!("{name}: {:.5}, {:+.3} % (at most {} %)", value(&found, name), 100.0 * error, 100.0 * bound);
        assert!(error.abs() <= bound, "{name}");
        assert!(found.quantities[name].std.is_some());
    }
    assert!(found.doubts().is_empty(), "{:?}", found.doubts());
    let bad: Vec<_> = found.findings.iter().filter(|f| f.severity == Severity::BadData).collect();
    assert!(bad.is_empty(), "{bad:#?}");
    // The file that `run` and `diagnose` take is read back as it was written.
    let table = folder.path().join("table.toml");
    fs::write(&table, found.model(&experiment.model).to_toml()).unwrap();
    let again = shakedown::recording::Model::load(&table).unwrap();
    assert_eq!(again.baseline, found.model(&experiment.model).baseline);
}

/// The run at 5 mm stays far below the limit: what can be said is a lower bound, and that is what is said.
#[test]
fn a_limit_that_was_not_reached_is_given_from_below() {
    let folder = TempDir::new().unwrap();
    let path = sweep_recording::write(folder.path(), Paper::default(), 1).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    let (head, runs) = text.split_once("[[runs]]").unwrap();
    let first = runs.split("[[runs]]").next().unwrap();
    fs::write(&path, format!("{head}[[runs]]{first}")).unwrap();
    let found = identify(&Experiment::load(&path).unwrap()).unwrap();
    print(&found);
    let limit = &found.quantities["velocity_limit"];
    assert_eq!((limit.std, limit.high), (None, None));
    let fastest = 0.005 * std::f64::consts::TAU * 0.9;
    assert!(limit.low.unwrap() > 0.5 * fastest && limit.low.unwrap() < 0.1, "{limit:?}");
    assert!(found.doubts().iter().any(|d| d.contains("velocity_limit") && d.contains("at least")));
}

/// The full count, 200 seeds, is `cargo run --release -p shakedown --example coverage`; a few seeds show that it counts.
#[test]
fn intervals_hold_the_truth_as_often_as_they_say() {
    for colour in [0.0, 0.9] {
        let (profile, normal) = coverage::total(&coverage::count(16, colour));
        println!("colour {colour}: profile {profile:.3}, from std {normal:.3}");
        assert!((0.7..=1.0).contains(&profile) && (0.7..=1.0).contains(&normal));
    }
}

const AXIS: &str = r#"
name = "EMPS"
[model]
kind = "rigid-mass"
mass = 80.0
viscous = 150.0
gain = 35.15
effects = ["coulomb_friction", "null_bias"]
fit = ["mass", "viscous", "coulomb_friction.force", "null_bias"]
# The published friction is a sign: the contact bends over next to nothing.
[effects.coulomb_friction]
presliding = 1e-6
[channels]
time = { column = "t", unit = "s" }
reference = { column = "qg", unit = "m" }
displacement = { column = "qm", unit = "m" }
command = { column = "vir", unit = "V" }
"#;
const PULSES: &str = "disturbance = { column = \"pulses_N\", unit = \"V\", optional = true }\n";

fn axis_run(folder: &Path, file: &str, more: &str) -> String {
    format!(
        "[[runs]]\nfile = \"{}\"\ncontroller = {{ kind = \"cascade\", kp = 160.18, kv = 243.45 }}\n{more}\n",
        folder.join(file).display()
    )
}

#[test]
fn a_servo_axis_gives_its_published_parameters() {
    let Some(folder) = data("emps") else { return };
    let found = found(&format!("{AXIS}{}", axis_run(&folder, "DATA_EMPS.mat", "use = \"fit\"")));
    print(&found);
    for (name, published, bound) in [
        ("mass", 95.109, 0.01),
        ("viscous", 203.5, 0.02),
        ("coulomb_friction.force", 20.39, 0.015),
        ("null_bias.offset", 3.165, 0.03),
    ] {
        let error = value(&found, name) / published - 1.0;
        println!(
            "{name}: {:.4}, {:+.2} % of {published} (at most {} %)",
            value(&found, name),
            100.0 * error,
            100.0 * bound
        );
        assert!(error.abs() <= bound, "{name}");
    }
}

#[test]
fn a_servo_axis_is_foreseen_and_so_are_its_pulses() {
    let Some(folder) = data("emps") else { return };
    let split = [
        axis_run(&folder, "DATA_EMPS.mat", "use = \"fit\"\nto_s = 16.56"),
        axis_run(&folder, "DATA_EMPS.mat", "use = \"holdout\"\nfrom_s = 16.56"),
    ];
    let rest = nrmse(&found(&format!("{AXIS}{}", split.concat())).held_back, "command");
    println!("controller voltage on the rest of the run: {:.2} % (at most 6)", 100.0 * rest);
    assert!(rest <= 0.06);
    let pulses = [split[0].clone(), axis_run(&folder, "DATA_EMPS_PULSES.mat", "use = \"holdout\"")].concat();
    let declared = nrmse(&found(&format!("{AXIS}{PULSES}{pulses}")).held_back, "command");
    println!("controller voltage with the pulse declared: {:.2} % (at most 9)", 100.0 * declared);
    assert!(declared <= 0.09);
    let undeclared = identify(&load(&TempDir::new().unwrap(), &format!("{AXIS}{pulses}")));
    let Err(IdentifyError::BadData(findings)) = undeclared else { panic!("the missing input was not noticed") };
    assert!(findings.iter().any(|f| f.fault == Fault::MissingInput && f.remedy.contains("disturbance")));
}

/// From valve voltage to table velocity, which is the slope of the table's displacement. The law of a recorded command
/// holds it; the rate makes the steps short enough for dry friction.
fn valve_to_velocity(file: &Path, end: f64, model: &str) -> String {
    let cut = 0.6 * end;
    format!(
        r#"
[model]
kind = "servo"
b1 = 0.0
bandwidth_hz = 20
{model}
[channels]
time = {{ column = "Time", unit = "s" }}
command = {{ column = "Voltage command", unit = "V" }}
velocity = {{ column = "Table disp", unit = "mm", differentiate = true }}
[[runs]]
file = "{}"
to_s = {cut}
use = "fit"
controller_rate_hz = 819.2
[[runs]]
file = "{}"
from_s = {cut}
use = "holdout"
controller_rate_hz = 819.2
"#,
        file.display(),
        file.display()
    )
}

const LAG_ALONE: &str = "b0 = 18.0\na1 = 90.0\neffects = [\"null_bias\"]\nfit = [\"b0\", \"a1\", \"null_bias\"]";
/// Friction and a specimen act on the table through the oil: all three, or none shows. The valve's lag is an effect of
/// its own and the model's far away, since a servo model's lag also passes on the forces.
const FULL: &str = r#"b0 = 806.0
a1 = 4000.0
effects = ["valve_lag", "null_bias", "oil_compliance", "coulomb_friction", "payload_resonance"]
fit = ["b0", "valve_lag", "null_bias", "oil_compliance", "coulomb_friction", "payload_resonance"]
[effects.valve_lag]
frequency = 130.0
damping = 1.9
[effects.null_bias]
offset = -0.0126
[effects.oil_compliance]
frequency = 54.0
damping = 0.006
[effects.coulomb_friction]
force = 4.5
[effects.payload_resonance]
mass_ratio = 1.1
frequency = 7.46
damping = 0.0015"#;

#[test]
fn the_real_table_follows_its_valve() {
    follows("CHY027", "1999_921_CHY027_NS.csv", 90.05, LAG_ALONE, 0.993);
    follows("KAU039", "1999_921_KAU039_NS.csv", 61.06, LAG_ALONE, 0.993);
    follows("TAP089, gain and lag alone", "2004_1015_TAP089_NS.csv", 72.05, LAG_ALONE, 0.91);
}

#[test]
fn the_third_run_follows_its_valve_with_the_oil_and_the_specimen() {
    follows("TAP089", "2004_1015_TAP089_NS.csv", 72.05, FULL, 0.96);
}

/// Fits the first 60 % of a run and asks for the R2 of the table's velocity on the rest.
fn follows(name: &str, file: &str, end: f64, model: &str, least: f64) {
    let Some(folder) = data("shake_table") else { return };
    let experiment = load(&TempDir::new().unwrap(), &valve_to_velocity(&folder.join(file), end, model));
    let prepared = prepare(&experiment).unwrap();
    let fit = fitted(&prepared).unwrap();
    let held_back = score(&fit.model, &prepared.holdout).unwrap();
    let r2 = 1.0 - nrmse(&held_back, "velocity").powi(2);
    println!("{name}: R2 held out {r2:.4} (at least {least})");
    for (name, value) in fit.model.names().iter().zip(fit.model.values()).filter(|(_, v)| v.free) {
        println!("  {name:32} {:.5}", value.value);
    }
    let place = leftover(&prepared.holdout, &held_back.predicted);
    for band in &place.frequency {
        println!("  left over: {:.1} to {:.1} Hz at {:.1} times the floor", band.from_hz, band.to_hz, band.ratio);
    }
    for stretch in &place.time {
        println!("  left over: {:.1} to {:.1} s, {:.0} %", stretch.from_s, stretch.to_s, 100.0 * stretch.share);
    }
    assert!(r2 >= least, "{name}: {r2}");
    assert!(!place.frequency.is_empty() && !place.time.is_empty(), "{name}");
}

/// One wrong thing at a time in files that are right otherwise.
#[test]
fn wrong_data_are_refused_by_name() {
    let folder = TempDir::new().unwrap();
    let path = sweep_recording::write(folder.path(), Paper::default(), 3).unwrap();
    let right = fs::read_to_string(&path).unwrap();
    assert!(!is_bad_data(&check(&Experiment::load(&path).unwrap())), "a false alarm");
    let in_g = "unit = \"g\", noise = 0.021";
    let in_si = "unit = \"m/s2\", noise = 0.21";
    let runs: Vec<PathBuf> = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().path()).collect();
    let files: Vec<(PathBuf, String)> = runs
        .into_iter()
        .filter(|p| p.extension().is_some_and(|e| e == "csv"))
        .map(|p| (p.clone(), fs::read_to_string(p).unwrap()))
        .collect();
    let edited = |edit: &dyn Fn(usize, Vec<f64>) -> Vec<f64>| {
        for (path, text) in &files {
            let (head, rows) = text.split_once('\n').unwrap();
            // Units in the heading would give the fault away.
            let mut out = head.replace(" [m/s2]", "").replace(" [m]", "") + "\n";
            for (k, row) in rows.lines().enumerate() {
                let values = edit(k, row.split(',').map(|x| x.parse().unwrap()).collect());
                out += &(values.iter().map(ToString::to_string).collect::<Vec<_>>().join(",") + "\n");
            }
            fs::write(path, out).unwrap();
        }
    };
    let row = |change: fn(usize, &mut Vec<f64>)| {
        move |k: usize, mut values: Vec<f64>| {
            change(k, &mut values);
            values
        }
    };
    let cases: [(&str, Box<dyn Fn(usize, Vec<f64>) -> Vec<f64>>, String, &str, Fault); 7] = [
        ("nothing", Box::new(row(|_, _| {})), right.clone(), "", Fault::Hum),
        ("inverted accelerometer", Box::new(row(|_, v| v[3] *= -1.0)), right.clone(), "acceleration", Fault::Inverted),
        ("g given as m/s2", Box::new(row(|_, v| v[3] /= 9.80665)), right.clone(), "acceleration", Fault::WrongUnit),
        ("m/s2 given as g", Box::new(row(|_, _| {})), right.replace(in_si, in_g), "acceleration", Fault::WrongUnit),
        ("swapped columns", Box::new(row(|_, v| v.swap(1, 2))), right.clone(), "reference", Fault::Swapped),
        (
            "stuck LVDT",
            Box::new(row(|k, v| v[2] = if (4000..4600).contains(&k) { 0.001 } else { v[2] })),
            right.clone(),
            "displacement",
            Fault::Stuck,
        ),
        (
            "duplicated stamps",
            Box::new(row(|k, v| v[0] = if (4000..4040).contains(&k) { 7.998 } else { v[0] })),
            right.clone(),
            "time",
            Fault::RepeatedTime,
        ),
    ];
    for (name, edit, text, channel, fault) in cases {
        edited(&*edit);
        fs::write(&path, text).unwrap();
        let findings = check(&Experiment::load(&path).unwrap());
        let bad: Vec<_> = findings.iter().filter(|f| f.severity == Severity::BadData).collect();
        for finding in &bad {
            println!("{name}: {}, {} {:?}: {}", finding.run, finding.channel, finding.fault, finding.problem);
        }
        if channel.is_empty() {
            assert!(bad.is_empty(), "{name}: a false alarm: {bad:#?}");
            continue;
        }
        assert!(bad.iter().any(|f| f.fault == fault && f.channel == channel), "{name}: {findings:#?}");
        assert!(matches!(identify(&Experiment::load(&path).unwrap()), Err(IdentifyError::BadData(_))), "{name}");
    }
}

#[test]
fn clean_recordings_raise_no_alarm() {
    let quiet = |experiment: &Experiment| {
        let bad: Vec<_> = check(experiment).into_iter().filter(|f| f.severity == Severity::BadData).collect();
        assert!(bad.is_empty(), "{}: {bad:#?}", experiment.path.display());
    };
    for seed in 10..13 {
        let folder = TempDir::new().unwrap();
        quiet(&Experiment::load(&sweep_recording::write(folder.path(), Paper::default(), seed).unwrap()).unwrap());
    }
    let folder = TempDir::new().unwrap();
    if let Some(tables) = data("shake_table") {
        for name in ["CHY027", "KAU039", "TAP089"] {
            quiet(&Experiment::load(&tables.join(format!("{name}.toml"))).unwrap());
        }
        for (file, end) in
            [("1999_921_CHY027_NS.csv", 90.05), ("1999_921_KAU039_NS.csv", 61.06), ("2004_1015_TAP089_NS.csv", 72.05)]
        {
            quiet(&load(&folder, &valve_to_velocity(&tables.join(file), end, FULL)));
        }
    }
    if let Some(axis) = data("emps") {
        let runs = [
            axis_run(&axis, "DATA_EMPS.mat", "use = \"fit\""),
            axis_run(&axis, "DATA_EMPS_PULSES.mat", "use = \"holdout\""),
        ];
        quiet(&load(&folder, &format!("{AXIS}{PULSES}{}", runs.concat())));
    }
    if let Some(drives) = data("coupled_drives/drive.mat") {
        for i in 1..=3 {
            let text = format!(
                "[model]\nkind = \"servo\"\nb1 = 0.0\nb0 = 1.0\na1 = 1.0\n[channels]\ntime = {{ step = 0.02, unit = \"s\" }}\n\
                 command = {{ column = \"u{i}\", unit = \"V\" }}\nvelocity = {{ column = \"z{i}\", unit = \"m/s\" }}\n\
                 [[runs]]\nfile = {drives:?}\n"
            );
            quiet(&load(&folder, &text));
        }
    }
}
