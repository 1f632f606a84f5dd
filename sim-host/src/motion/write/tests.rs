use super::super::generate::NEAR_FIELD_MODERATE;
use super::super::read::{Options, record_from_bytes};
use super::super::tests::data;
use super::super::{Fact, read};
use super::*;
use proptest::prelude::*;

const FORMATS: [Format; 6] =
    [Format::Peer, Format::Csmip, Format::Cosmos, Format::GeoNet, Format::KNet, Format::Columns];

fn round_trip(record: &Record) -> Record {
    let text = render(record).unwrap();
    record_from_bytes(Path::new("again.txt"), text.into_bytes(), &Options::default())
        .unwrap_or_else(|e| panic!("{}: {e}", record.format))
}

fn assert_same(record: &Record, again: &Record) {
    assert_eq!(again.format, record.format);
    assert!((again.dt / record.dt - 1.0).abs() < 1e-9, "{} {}", again.dt, record.dt);
    assert_eq!(again.acceleration.len(), record.acceleration.len());
    let tolerance = 1e-9 + 1e-3 * peak(&record.acceleration);
    for (a, b) in again.acceleration.iter().zip(&record.acceleration) {
        assert!((a - b).abs() <= tolerance.min(6e-4), "{}: {a} {b}", record.format);
    }
}

#[test]
fn every_format_reads_back_what_was_written() {
    for format in FORMATS {
        let made = NEAR_FIELD_MODERATE.generate(5).unwrap();
        let facts = vec![Fact { key: "station", value: "Statn No: 7 Site".into(), line: 1 }];
        let record = Record { format, component: "N28W".into(), facts, ..made };
        let again = round_trip(&record);
        assert_same(&record, &again);
        if !matches!(format, Format::Peer | Format::Columns) {
            assert_eq!(again.component, "N28W", "{format}");
        }
        // A record of less than half a second lasts none when rounded.
        let strong = record.acceleration.len() / 2;
        let short = Record { acceleration: record.acceleration[strong..strong + 9].to_vec(), ..record.clone() };
        assert_same(&short, &round_trip(&short));
        // A mean is part of the motion and survives, in K-NET too.
        let shifted = Record { acceleration: record.acceleration.iter().map(|a| a + 0.01).collect(), ..record };
        assert_same(&shifted, &round_trip(&shifted));
    }
}

#[test]
fn real_records_survive_their_own_format() {
    for name in ["RSN1106_KOBE_KJM000.AT2", "ce36456p_CE36456.V2", "20161113_110259_WTMC_20.V2A", "AOM0011801241951.NS"]
    {
        let Some(path) = data(name) else { return };
        let record = read::record(&path, &Options::default()).unwrap();
        let again = round_trip(&record);
        assert_same(&record, &again);
        assert_eq!(again.component, record.component);
    }
}

/// The header's peak has a sign, and digits enough to tell which; its samples may not.
#[test]
fn a_peak_that_is_reached_on_both_sides_reads_back() {
    let made = NEAR_FIELD_MODERATE.generate(5).unwrap();
    for (first, second) in [(19.938_13, -19.938_14), (-19.938_13, 19.938_14), (-19.938_14, 19.938_13)] {
        for format in FORMATS {
            let mut acceleration = vec![0.1; 200];
            (acceleration[40], acceleration[90]) = (first, second);
            assert_eq!(round_trip(&Record { acceleration, format, ..made.clone() }).acceleration.len(), 200);
        }
    }
}

#[test]
fn a_file_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let record = NEAR_FIELD_MODERATE.generate(1).unwrap();
    let path = folder.path().join("made.csv");
    write(&path, &record).unwrap();
    let kept = std::fs::read(&path).unwrap();
    let broken = Record { acceleration: vec![0.0, f64::NAN], ..record.clone() };
    assert!(matches!(write(&path, &broken), Err(WriteError::Unfit)));
    let drifting = Record { acceleration: vec![10.0; 20_000], format: Format::GeoNet, ..record.clone() };
    assert!(matches!(write(&path, &drifting), Err(WriteError::TooWide { what: "displacement", .. })));
    assert_eq!(std::fs::read(&path).unwrap(), kept);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let nowhere = write(&path.join("x.csv"), &record).unwrap_err().to_string();
    assert!(nowhere.contains("x.csv: cannot write"), "{nowhere}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_record_of_any_format_reads_back(
        a in prop::collection::vec(-20.0..20.0f64, 120..200), which in 0..6usize,
        dt in prop::sample::select(vec![0.01, 0.005, 0.02, 1.0 / 204.8, 0.004])
    ) {
        let record = Record {
            name: "any".into(), dt, acceleration: a, component: "UP".into(), format: FORMATS[which], facts: vec![],
        };
        let again = round_trip(&record);
        prop_assert!((again.dt / dt - 1.0).abs() < 1e-7);
        for (x, y) in again.acceleration.iter().zip(&record.acceleration) {
            prop_assert!((x - y).abs() < 6e-4, "{}: {x} {y}", record.format);
        }
    }
}
