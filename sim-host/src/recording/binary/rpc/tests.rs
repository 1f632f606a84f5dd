use super::*;
use proptest::prelude::*;

fn channel(name: &str, values: Vec<f64>) -> RpcChannel {
    RpcChannel { name: name.into(), unit: "mm".into(), values }
}

fn sine(count: usize) -> Vec<f64> {
    (0..count).map(|k| if k + 1 == count { 0.0 } else { 37.5 * (k as f64 * 0.01).sin() }).collect()
}

#[test]
fn what_is_written_reads_back_as_exactly_as_its_points_hold_it() {
    // Half a step of sixteen bits; half a unit in the last place of single precision.
    for (stored, bound) in [(Points::Short, 0.5001 / 32_752.0), (Points::Float, 6e-8)] {
        reads_back(stored, bound);
    }
}

fn reads_back(stored: Points, bound: f64) {
    let (a, b) = (sine(3000), sine(3000).iter().map(|v| v * 1e-3).collect::<Vec<_>>());
    let facts = [("PARENT_1".to_owned(), "kobe.AT2".to_owned())];
    let bytes = render(0.001, &[channel("x", a.clone()), channel("y", b.clone())], &facts, stored).unwrap();
    let content = parse(&bytes).unwrap();
    assert_eq!(content.columns.len(), 3);
    assert_eq!(content.columns[1].heading.unit.as_deref(), Some("mm"));
    assert!(content.notes.iter().any(|n| n.contains("kobe.AT2")));
    for (column, values) in content.columns[1..].iter().zip([a, b]) {
        let peak = values.iter().fold(0.0_f64, |p, v| p.max(v.abs()));
        assert_eq!(column.values.len(), 3072, "the last frame is whole");
        for (read, written) in column.values.iter().zip(values.iter().chain(std::iter::repeat(&0.0))) {
            assert!((read - written).abs() <= bound * peak, "{stored:?}: {read} {written}");
        }
    }
    assert!((content.columns[0].values[1] - 0.001).abs() < 1e-15);
}

#[test]
fn an_end_away_from_zero_is_refused() {
    let error = render(0.001, &[channel("x", vec![0.0, 1.0, 0.5])], &[], Points::Float).unwrap_err().to_string();
    assert!(error.contains("step of the table"), "{error}");
    assert_eq!(render(0.001, &[], &[], Points::Float), Err(RpcError::Unfit));
}

#[test]
fn big_endian_floats_are_read() {
    let bytes = render(0.01, &[channel("x", sine(1024))], &[], Points::Short).unwrap();
    let mut big = bytes[..bytes.len() - 2048].to_vec();
    let mut set = |key: &str, value: &str| {
        let at = (0..big.len() / RECORD).find(|i| record(&big, *i).unwrap().0 == key).unwrap() * RECORD + KEY;
        big[at..at + 96].fill(0);
        big[at..at + value.len()].copy_from_slice(value.as_bytes());
    };
    set("FORMAT", "BINARY_IEEE_BIG_END");
    set("DATA_TYPE", "FLOATING_POINT");
    set("SCALE.CHAN_1", "2.0");
    let values: Vec<f32> = (0..1024).map(|k| k as f32).collect();
    big.extend(values.iter().flat_map(|v| v.to_be_bytes()));
    let content = parse(&big).unwrap();
    assert_eq!(content.columns[1].values[3], 6.0);
}

#[test]
fn headers_that_cannot_be_are_refused_by_their_key() {
    let bytes = render(0.01, &[channel("x", sine(1024))], &[], Points::Short).unwrap();
    let with = |key: &str, value: &str| {
        let mut bytes = bytes.clone();
        let at = (0..bytes.len() / RECORD).find(|i| record(&bytes, *i).unwrap().0 == key).unwrap() * RECORD + KEY;
        bytes[at..at + 96].fill(0);
        bytes[at..at + value.len()].copy_from_slice(value.as_bytes());
        parse(&bytes).unwrap_err()
    };
    for (key, value) in [
        ("NUM_HEADER_BLOCKS", "999999"),
        ("CHANNELS", "-1"),
        ("CHANNELS", "200"),
        ("FRAMES", "18446744073709551615"),
        ("DELTA_T", "nan"),
        ("SCALE.CHAN_1", ""),
        ("DATA_TYPE", "DOUBLE"),
        ("HALF_FRAMES", "1"),
        ("FILE_TYPE", "HISTOGRAM"),
        ("PTS_PER_FRAME", "0"),
    ] {
        let flaw = with(key, value);
        assert!(flaw.contains(key) || flaw.contains("cut off"), "{key} = {value}: {flaw}");
    }
}

/// What MTS's own software wrote; the ranges are those that nCode's statistics in its header state.
#[test]
fn a_file_of_others_is_read() {
    let Some(path) = crate::recording::tests::data("files/test1.rsp") else { return };
    let content = parse(&std::fs::read(path).unwrap()).unwrap();
    assert_eq!(content.columns.len(), 6);
    assert!(content.columns.iter().all(|c| c.values.len() == 2048));
    assert!((content.columns[0].values[1] - 0.004).abs() < 1e-12);
}

proptest! {
    #[test]
    fn no_bytes_crash_it(mut bytes in prop::collection::vec(any::<u8>(), 0..2000), at in 0..6000usize, byte in any::<u8>()) {
        let _ = parse(&bytes);
        bytes = render(0.01, &[channel("x", sine(1024))], &[], Points::Short).unwrap();
        let n = bytes.len();
        bytes[at % n] = byte;
        let _ = parse(&bytes);
        bytes.truncate(at % n);
        let _ = parse(&bytes);
    }
}
