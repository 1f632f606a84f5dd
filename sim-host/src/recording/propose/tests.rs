use super::*;
use crate::recording::{Channel, Experiment, check, is_bad_data};
use std::f64::consts::PI;
use std::fs;
use tempfile::TempDir;

/// A PI loop around an integrator, written in millimetres and g.
fn recording(header: &str, phase: f64) -> String {
    let (dt, kp, ki) = (0.005, 4.0, 0.5);
    let (mut x, mut sum, mut v_before) = (0.0, 0.0, 0.0);
    let mut rows = vec![header.to_owned()];
    for k in 0..6000 {
        let t = f64::from(k) * dt;
        let r = 0.02
            * (1.0 - (-t).exp())
            * ((2.0 * PI * 0.4 * t + phase).sin()
                + 0.4 * (2.0 * PI * 1.7 * t).sin()
                + 0.15 * (2.0 * PI * 4.1 * t).sin());
        let e = r - x;
        sum += e * dt;
        let u = kp * e + ki * sum;
        let v = 2.4 * u;
        let a = (v - v_before) / dt;
        v_before = v;
        rows.push(format!("{t},{},{},{},{u}", 1e3 * r, 1e3 * x, a / 9.80665));
        x += v * dt;
    }
    rows.join("\n") + "\n"
}

fn folder(files: &[(&str, String)]) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn channels_units_and_gains_are_proposed_with_their_evidence() {
    let header = "time,setpoint,LVDT pos,accel,valve command";
    let folder = folder(&[
        ("b.csv", recording(header, 0.3)),
        ("a.csv", recording(header, 0.0)),
        ("notes.txt", "hello\n".into()),
    ]);
    let proposal = propose(folder.path()).unwrap();
    let symbol =
        |channel| proposal.choices.iter().find(|c| c.channel == channel).and_then(|c| c.unit).map(|u| u.symbol);
    assert_eq!(symbol(Channel::Time), Some("s"));
    assert_eq!(symbol(Channel::Reference), Some("mm"));
    assert_eq!(symbol(Channel::Displacement), Some("mm"));
    assert_eq!(symbol(Channel::Acceleration), Some("g"), "{}", proposal.text);
    assert_eq!(proposal.files, ["a.csv", "b.csv"]);
    assert!(proposal.text.contains("controller = { kp = 4.00000, ki = 0.50000 }"), "{}", proposal.text);
    assert!(proposal.text.contains("times the second derivative of displacement"), "{}", proposal.text);
    let path = folder.path().join("experiment.toml");
    fs::write(&path, &proposal.text).unwrap();
    let experiment = Experiment::load(&path).unwrap();
    assert_eq!(experiment.runs.len(), 2);
    assert!(!is_bad_data(&check(&experiment)));
}

#[test]
fn what_the_header_says_is_taken_and_the_rest_is_left_open() {
    let header = "t [ms],reference [mm],displacement [mm],noise,humidity";
    let folder = folder(&[("a.csv", recording(header, 0.0))]);
    let proposal = propose(folder.path()).unwrap();
    assert!(proposal.text.contains("the header says [mm]"), "{}", proposal.text);
    assert!(proposal.text.contains("#   humidity ("), "{}", proposal.text);
    assert!(proposal.open.iter().any(|q| q.contains("controller")), "{:?}", proposal.open);
}

#[test]
fn a_folder_without_recordings_is_refused_with_the_reasons() {
    let folder = folder(&[("a.csv", "1,2\n3,4\n".into()), ("readme.md", "x".into())]);
    let error = propose(folder.path()).unwrap_err().to_string();
    assert!(error.contains("holds no recording"), "{error}");
    let error = propose(&folder.path().join("nowhere")).unwrap_err().to_string();
    assert!(error.contains("name a folder that holds recordings"), "{error}");
}

#[test]
fn the_real_folders_are_understood() {
    let data = std::env::var("SHAKEDOWN_DATA").map_or_else(|_| "../../shared/data".into(), PathBuf::from);
    let (table, emps) = (data.join("recordings/shake_table"), data.join("recordings/emps"));
    if !table.exists() {
        crate::skipped::without(&table);
        return;
    }
    let proposal = propose(&table).unwrap();
    let column = |channel| proposal.text.lines().find(|l| l.starts_with(&format!("{channel} = "))).map(str::to_owned);
    assert_eq!(column("time").unwrap(), "time = { column = \"Time\", unit = \"s\" }");
    assert_eq!(column("reference").unwrap(), "reference = { column = \"Dis command\", unit = \"mm\" }");
    assert_eq!(column("displacement").unwrap(), "displacement = { column = \"Table disp\", unit = \"mm\" }");
    assert_eq!(column("acceleration").unwrap(), "acceleration = { column = \"Acc 1F\", unit = \"mm/s2\" }");
    assert_eq!(column("pressure_difference").unwrap(), "pressure_difference = { column = \"Delta P\", unit = \"1\" }");
    assert_eq!(proposal.files.len(), 3);
    let proposal = propose(&emps).unwrap();
    assert!(proposal.text.contains("controller = { kind = \"cascade\", kp = 159"), "{}", proposal.text);
}

/// Of a table whose loop nobody states, a pressure beside the motion is what can be explained.
#[test]
fn without_a_known_loop_the_pressure_is_explained_by_the_motion() {
    let strange = |row: &str| {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        let [t, x, a] = [0, 2, 3].map(|i| cells[i].parse::<f64>().unwrap());
        // A command of no law of reference and displacement, and the pressure of a mass.
        cells[4] = format!("{}", (40.0 * t).sin() + 0.1 * (x * 3.0).cos());
        cells.push(format!("{}", 0.2 * a * 9.80665));
        cells.join(",")
    };
    let plain = recording("time,setpoint,LVDT pos,accel,valve command", 0.0);
    let mut lines = plain.lines();
    let header = format!("{},delta p", lines.next().unwrap());
    let text = std::iter::once(header).chain(lines.map(strange)).collect::<Vec<_>>().join("\n");
    let folder = folder(&[("a.csv", text)]);
    let proposal = propose(folder.path()).unwrap();
    assert!(proposal.text.contains("kind = \"force-balance\"     # the loop is not known"), "{}", proposal.text);
    assert!(proposal.text.contains("bandwidth_hz = 40.0"), "{}", proposal.text);
    let path = folder.path().join("experiment.toml");
    fs::write(&path, &proposal.text).unwrap();
    Experiment::load(&path).unwrap();
}

/// The samples of a P loop, its command to so many decimals, its motion in these units of length (m) and acceleration (m/s2).
fn plain_loop(header: &str, decimals: usize, (length, acceleration): (f64, f64)) -> String {
    let (dt, kp) = (0.01, 3.7);
    let (mut x, mut v) = (0.0, 0.0);
    let mut rows = vec![header.to_owned()];
    for k in 0..800 {
        let t = f64::from(k) * dt;
        let r = 0.02 * (2.0 * PI * 0.7 * t).sin() * (1.0 - (-t).exp()) + 0.004 * (2.0 * PI * 3.1 * t).sin();
        let u = kp * (r - x);
        let a = (2.4 * u - v) / 0.03;
        rows.push(format!(
            "{t:.3},{:.decimals$},{:.decimals$},{:.decimals$},{u:.decimals$}",
            r / length,
            x / length,
            a / acceleration
        ));
        v += a * dt;
        x += v * dt;
    }
    rows.join("\n") + "\n"
}

/// One velocity more misses less by the rounding of what was recorded, and is no reason for another law.
#[test]
fn a_plain_law_is_no_cascade_for_its_rounding() {
    for decimals in [4, 6, 9] {
        let folder =
            folder(&[("a.csv", plain_loop("t,reference,displacement,acc,command", decimals, (1e-3, 9.80665)))]);
        let law = propose(folder.path()).unwrap().control.expect("a law");
        assert!(law.text.starts_with("{ kp = 3.7") || law.text.starts_with("{ kp = 3.69"), "{decimals}: {}", law.text);
    }
}

/// A cell that is no number takes its column, and is said with file, line and column.
#[test]
fn a_cell_that_is_no_number_is_said() {
    let whole = plain_loop("t,reference,displacement,acc,command", 6, (1e-3, 9.80665));
    let mut lines: Vec<&str> = whole.lines().collect();
    let broken = lines[49].replacen(',', ",abc", 1);
    lines[49] = &broken;
    let folder = folder(&[("a.csv", lines.join("\n"))]);
    let open = propose(folder.path()).unwrap().open;
    let said = open.iter().find(|question| question.contains("left out")).expect("a word");
    assert!(said.contains("line 50") && said.contains("reference"), "{said}");
}

/// A displacement in volts that its size takes for millimetres leaves the acceleration's unit in doubt too; one whose heading says volts
/// is said to be in no unit of length.
#[test]
fn doubt_about_the_displacement_passes_on() {
    let volts = |header: &str| {
        let folder = folder(&[("a.csv", plain_loop(header, 6, (12.5e-3, 9.80665)))]);
        propose(folder.path()).unwrap()
    };
    let proposal = volts("t,reference,LVDT,acc,command");
    let doubtful = |channel| proposal.choices.iter().any(|c| c.channel == channel && c.doubtful);
    assert!(doubtful(Channel::Displacement) && doubtful(Channel::Acceleration), "{}", proposal.text);
    let open = volts("t,reference,LVDT displacement [V],acc,command").open;
    assert!(open.iter().any(|question| question.contains("LVDT") && question.contains("no unit of it")), "{open:?}");
}

#[test]
fn headings_in_german_are_known() {
    let header = "Zeit [s],Sollwert [mm],Istwert [mm],Beschleunigung [g],Stellsignal [V]";
    let folder = folder(&[("a.csv", plain_loop(header, 6, (1e-3, 9.80665)))]);
    let proposal = propose(folder.path()).unwrap();
    let column = |channel| proposal.choices.iter().find(|c| c.channel == channel).map(|c| c.column);
    let wanted = [Channel::Time, Channel::Reference, Channel::Displacement, Channel::Acceleration, Channel::Command];
    assert_eq!(wanted.map(column), [0, 1, 2, 3, 4].map(Some), "{}", proposal.text);
}
