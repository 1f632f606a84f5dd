use super::*;
use proptest::prelude::*;

fn text(of: &str) -> Vec<u8> {
    [(of.len() as u32).to_le_bytes().to_vec(), of.as_bytes().to_vec()].concat()
}

fn segment_of(mask: u32, metadata: &[u8], raw: &[u8]) -> Vec<u8> {
    let lead = [b"TDSm".to_vec(), mask.to_le_bytes().to_vec(), 4713u32.to_le_bytes().to_vec()].concat();
    let offsets = [((metadata.len() + raw.len()) as u64).to_le_bytes(), (metadata.len() as u64).to_le_bytes()].concat();
    [lead, offsets, metadata.to_vec(), raw.to_vec()].concat()
}

/// A channel of i16 values with its raw index and a sampling interval.
fn channel(name: &str, count: u64) -> Vec<u8> {
    let index = [20u32.to_le_bytes(), 2u32.to_le_bytes(), 1u32.to_le_bytes()].concat();
    let increment = [text("wf_increment"), 10u32.to_le_bytes().to_vec(), 0.01f64.to_le_bytes().to_vec()].concat();
    let unit = [text("unit_string"), 0x20u32.to_le_bytes().to_vec(), text("mm")].concat();
    [
        text(&format!("/'rig'/'{name}'")),
        index,
        count.to_le_bytes().to_vec(),
        2u32.to_le_bytes().to_vec(),
        increment,
        unit,
    ]
    .concat()
}

fn numbers(values: impl IntoIterator<Item = i16>) -> Vec<u8> {
    values.into_iter().flat_map(i16::to_le_bytes).collect()
}

fn two(interleaved: bool) -> Vec<u8> {
    let metadata = [2u32.to_le_bytes().to_vec(), channel("x", 2), channel("y", 2)].concat();
    // Two chunks in the segment, and a third in a segment that repeats nothing.
    let (raw, more) = if interleaved {
        (numbers([1, 10, 2, 20, 3, 30, 4, 40]), numbers([5, 50, 6, 60]))
    } else {
        (numbers([1, 2, 10, 20, 3, 4, 30, 40]), numbers([5, 6, 50, 60]))
    };
    let bit = if interleaved { 1 << 5 } else { 0 };
    [segment_of(0b1110 | bit, &metadata, &raw), segment_of(0b1000 | bit, &[], &more)].concat()
}

#[test]
fn every_chunk_and_every_segment_is_read() {
    for interleaved in [false, true] {
        let content = parse(&two(interleaved)).unwrap();
        let names: Vec<&str> = content.columns.iter().map(|c| c.heading.name.as_str()).collect();
        assert_eq!(names, ["time", "x", "y"]);
        assert_eq!(content.columns[1].values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(content.columns[2].values, [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
        assert_eq!(content.columns[1].heading.unit.as_deref(), Some("mm"));
        assert!((content.columns[0].values[5] - 0.05).abs() < 1e-15);
    }
}

#[test]
fn a_file_that_was_cut_off_gives_its_whole_chunks_and_says_so() {
    let mut bytes = two(false);
    bytes.truncate(bytes.len() - 6);
    let content = parse(&bytes).unwrap();
    assert_eq!(content.columns[1].values, [1.0, 2.0, 3.0, 4.0]);
    assert!(content.notes.iter().any(|n| n.contains("cut off")), "{:?}", content.notes);
    assert!(parse(b"TDSm").unwrap_err().contains("cut off"));
}

/// Sums and first values as npTDMS gives them.
#[test]
fn files_of_others_are_read() {
    for (name, channel, count, first, sum) in [
        ("raw1.tdms", "First  Channel", 2000, -0.184_026_61, 129.416_486_098_819_23),
        ("raw1.tdms", "Sixth Chan", 2000, 4.336_680_2, 8_314.766_991_180_182),
        ("big_endian.tdms", "Amplitude sweep", 3500, 0.0, 92.416_826_306_421_95),
        ("big_endian.tdms", "Phase sweep", 3500, 0.0, 24.607_279_472_921_544),
    ] {
        let Some(path) = crate::recording::tests::data(&format!("files/{name}")) else { return };
        let content = parse(&std::fs::read(path).unwrap()).unwrap();
        let column = content.columns.iter().find(|c| c.heading.name == channel).unwrap();
        assert_eq!(column.values.len(), count, "{name}");
        assert!((column.values[0] - first).abs() < 1e-8, "{name}: {}", column.values[0]);
        assert!((column.values.iter().sum::<f64>() - sum).abs() < 1e-9 * sum, "{name}");
    }
    let Some(path) = crate::recording::tests::data("files/Digital_Input.tdms") else { return };
    let content = parse(&std::fs::read(path).unwrap()).unwrap();
    let sums: Vec<f64> =
        content.columns.iter().filter(|c| !c.heading.name.starts_with("time")).map(|c| c.values.iter().sum()).collect();
    assert_eq!(sums, [10_000.0, 200.0, 4.0]);
}

proptest! {
    #[test]
    fn no_bytes_crash_it(bytes in prop::collection::vec(any::<u8>(), 0..300), at in 0..2000usize, byte in any::<u8>()) {
        let _ = parse(&bytes);
        let _ = parse(&segment_of(0b1110, &bytes, &bytes));
        let mut damaged = two(at % 2 == 0);
        let n = damaged.len();
        damaged[at % n] = byte;
        let _ = parse(&damaged);
        damaged.truncate(at % n);
        let _ = parse(&damaged);
    }
}
