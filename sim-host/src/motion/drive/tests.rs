use super::*;
use crate::motion::generate::NEAR_FIELD_MODERATE;

fn drive(quantity: Quantity, symbol: &str, rate_hz: Option<f64>) -> Drive {
    let motion = NEAR_FIELD_MODERATE.generate(1).unwrap().motion();
    let unit = DriveUnit::fixed(symbol, quantity).unwrap();
    let mut drive = Drive::of(&motion, quantity, unit, rate_hz);
    drive.facts = vec![("source".into(), "kobe.AT2".into()), ("source_sha256".into(), "00ff".into())];
    drive
}

#[test]
fn every_form_reads_back_as_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    for (name, quantity, unit, bound) in [
        ("a.csv", Quantity::Displacement, "mm", 1e-12),
        ("b.csv", Quantity::Acceleration, "g", 1e-12),
        ("c.AT2", Quantity::Acceleration, "g", 1e-6),
        ("d.rpc", Quantity::Displacement, "mm", 1e-7),
        ("e.drv", Quantity::Acceleration, "g", 1e-7),
    ] {
        let path = folder.path().join(name);
        let mut written = drive(quantity, unit, Some(1000.0));
        let last = written.values.len() - 1;
        written.values[last] = 0.0;
        written.write(&path, Form::of(&path).unwrap()).unwrap();
        let read = Drive::read(&path).unwrap().unwrap();
        assert_eq!((read.quantity, read.fact("source_sha256")), (quantity, Some("00ff")), "{name}");
        assert!((read.dt - 0.001).abs() < 1e-12);
        let worst = written.values.iter().zip(&read.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= bound * peak(&written.values), "{name}: {worst}");
        assert_eq!(read.values.len(), written.values.len(), "{name}: what fills a frame is none of the drive");
        let refused = read::record(&path, &read::Options::default()).unwrap_err().to_string();
        assert!(refused.contains("is a drive"), "{name}: {refused}");
    }
}

#[test]
fn a_higher_rate_changes_nothing_of_the_motion() {
    let motion = NEAR_FIELD_MODERATE.generate(2).unwrap().motion();
    let unit = DriveUnit::fixed("m", Quantity::Displacement).unwrap();
    let fine = Drive::of(&motion, Quantity::Displacement, unit, Some(1000.0));
    for (k, x) in motion.displacement.iter().enumerate() {
        assert!((fine.values[5 * k] - x).abs() < 1e-12);
    }
    let speed = fine.values.windows(2).map(|w| (w[1] - w[0]).abs() / fine.dt).fold(0.0, f64::max);
    // What a finite difference finds is a mean of the velocity, and never above its peak between samples.
    let (_, fast) = motion.peaks_between();
    assert!(speed <= fast * (1.0 + 1e-12) && speed > fast * (1.0 - 1e-4), "{speed} {fast}");
}

#[test]
fn files_that_are_no_drives_and_damaged_ones_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    std::fs::write(&path, "time [s],acceleration [g]\n0,1\n").unwrap();
    assert!(Drive::read(&path).unwrap().is_none());
    let written = drive(Quantity::Displacement, "mm", None);
    written.write(&path, Form::Csv).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    for (from, to, said) in [
        ("unit_in_si = 0.001", "unit_in_si = 1", "one mm is 0.001"),
        ("# unit = mm\n", "", "`unit` is missing"),
        ("# samples = ", "# samples = 1", "but `samples = 1"),
        ("displacement [mm]", "displacement [m]", "expected the header"),
        ("0.005000000,", "0.006000000,", "does not follow"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let refused = Drive::read(&path).unwrap_err().to_string();
        assert!(refused.contains(said), "{refused}");
    }
    assert!(Form::of(Path::new("a.mat")).unwrap_err().contains(".csv, .rpc"));
}

/// What ends at rest elsewhere goes back slowly before a form that fills up with zeros takes it; what ends in motion is refused.
#[test]
fn a_drive_returns_to_zero_before_it_is_filled_with_zeros() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rpc");
    let mut ends = drive(Quantity::Displacement, "mm", Some(1000.0));
    let count = ends.values.len();
    let away = |k: usize| 0.02 * (k as f64 / 2000.0).min(1.0);
    ends.values = (0..count).map(away).collect();
    let speed = |values: &[f64]| values.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max) / 1e-3;
    let before = ends.values.clone();
    let time = ends.return_to_zero().unwrap();
    assert!(time >= 2.0 && ends.values.last().unwrap().abs() < 1e-12 && ends.values[..count] == before);
    assert!(speed(&ends.values[count - 1..]) <= 0.05 * speed(&before) * 1.001);
    assert_eq!(ends.return_to_zero(), None);
    ends.write(&path, Form::of(&path).unwrap()).unwrap();
    ends.values.truncate(1500);
    assert_eq!(ends.return_to_zero(), None);
    let refused = ends.write(&path, Form::of(&path).unwrap()).unwrap_err().to_string();
    assert!(refused.contains("step of the table"), "{refused}");
}
