//! miniSEED 2 and 3, Steim compression included: the one file that knows the library which reads them.
//!
//! Records of one source (`NET.STA.LOC.CHA`) that follow each other become one column; what is missing between them is NaN. Columns
//! begin together, at the earliest record of the file; sources of another rate are named and passed over. Values are counts, or what
//! the writer took them to be: the format states no unit.

use super::bytes::Flaw;
use super::{Column, Content};
use crate::recording::table::MAX_VALUES;
use miniseed_rs::{MseedReader, MseedRecord, NanoTime, Samples};
use std::collections::BTreeMap;

mod order;

/// How far a record's start may lie off the grid of the first, in samples.
const OFF_GRID: f64 = 0.3;
/// Shortest record, bytes: more of them than fit into the file are none.
const SHORTEST: usize = 40;

/// True for the first bytes of a file in this form.
pub(crate) fn is_start(start: &[u8]) -> bool {
    let three = start.starts_with(b"MS\x03");
    let two = start.len() >= 8
        && start[..6].iter().all(u8::is_ascii_digit)
        && matches!(start[6], b'D' | b'R' | b'Q' | b'M')
        && matches!(start[7], b' ' | 0);
    three || two
}

/// One source's records, in the order of the file.
struct Source {
    rate: f64,
    parts: Vec<(f64, Vec<f64>)>,
}

/// Reads a file.
pub(crate) fn parse(bytes: &[u8]) -> Result<Content, Flaw> {
    let turned = order::big_endian(bytes);
    let bytes = turned.as_ref();
    let mut sources: BTreeMap<String, Source> = BTreeMap::new();
    let (mut read, mut kept) = (0usize, 0usize);
    let mut first: Option<NanoTime> = None;
    let mut records = MseedReader::new(bytes);
    for number in 0..=bytes.len() / SHORTEST {
        if !data_within(bytes.get(read..).unwrap_or_default()) {
            return Err(format!(
                "is miniSEED whose record {} places its data beyond its end: export it again",
                number + 1
            ));
        }
        let Some(record) = records.next() else { break };
        let record = record
            .map_err(|e| format!("is miniSEED whose record {} cannot be read ({e}): export it again", number + 1))?;
        read = read.saturating_add(record.record_length as usize);
        kept = kept.saturating_add(record.samples.len());
        if kept > MAX_VALUES {
            return Err(format!("holds more than {MAX_VALUES} values"));
        }
        if record.samples.is_empty() {
            continue;
        }
        let rate = record.sample_rate;
        if !(1e-3..=1e6).contains(&rate) {
            return Err(format!(
                "is miniSEED with {rate} samples a second in record {}: expected 0.001 to 1e6",
                number + 1
            ));
        }
        let start = *first.get_or_insert(record.start_time);
        let since = seconds(&record.start_time) - seconds(&start);
        let source = sources.entry(name(&record)).or_insert_with(|| Source { rate, parts: Vec::new() });
        if (source.rate / rate - 1.0).abs() > 1e-6 {
            return Err(format!(
                "is miniSEED whose {} has {} and {rate} samples a second: export one stretch",
                name(&record),
                source.rate
            ));
        }
        source.parts.push((since, values(record.samples)));
    }
    // The library ends at a record that is not whole, without a word.
    if read < bytes.len() && bytes[read..].iter().any(|b| *b != 0) {
        return Err(format!("is miniSEED cut off: {read} of {} bytes are whole records", bytes.len()));
    }
    content(sources, first)
}

/// Whether a record of version 2 begins its data before it ends, by its blockette 1000; the library takes that for granted. Any other
/// beginning is the library's to judge.
fn data_within(record: &[u8]) -> bool {
    let word = |at: usize| record.get(at..at + 2).map(|b| usize::from(u16::from_be_bytes([b[0], b[1]])));
    let (Some(data), Some(mut blockette)) = (word(44), word(46)) else { return true };
    if record.starts_with(b"MS") {
        return true;
    }
    for _ in 0..MOST_BLOCKETTES {
        let (Some(kind), Some(next)) = (word(blockette), word(blockette + 2)) else { return true };
        if kind == 1000 {
            let power = record.get(blockette + 6).copied().unwrap_or_default();
            return 1usize.checked_shl(u32::from(power)).is_some_and(|length| data <= length.min(record.len()));
        }
        blockette = next;
    }
    true
}

/// Blockettes of a record that are looked through.
const MOST_BLOCKETTES: usize = 64;

fn content(sources: BTreeMap<String, Source>, first: Option<NanoTime>) -> Result<Content, Flaw> {
    let Some(rate) = sources.values().max_by_key(|s| s.parts.len()).map(|s| s.rate) else {
        return Err("is miniSEED without a sample".to_owned());
    };
    let mut notes = vec!["miniSEED: values as they are stored; state their unit".to_owned()];
    notes.extend(first.map(|t| format!("time 0 is {t}")));
    let (same, other): (Vec<_>, Vec<_>) = sources.into_iter().partition(|(_, s)| (s.rate / rate - 1.0).abs() < 1e-6);
    if !other.is_empty() {
        let names: Vec<&str> = other.iter().take(5).map(|(name, _)| name.as_str()).collect();
        notes.push(format!(
            "{} sources of another rate than {rate} Hz were passed over ({})",
            other.len(),
            names.join(", ")
        ));
    }
    let begin = same.iter().flat_map(|(_, s)| &s.parts).map(|p| p.0).fold(f64::INFINITY, f64::min);
    let mut columns = Vec::new();
    for (name, source) in same {
        let (values, gaps) = joined(&name, &source, begin)?;
        if gaps > 0 {
            notes.push(format!("{name}: {gaps} samples are missing between records"));
        }
        columns.push((name, values));
    }
    let length = columns.iter().map(|(_, v)| v.len()).max().unwrap_or(0);
    if length.saturating_mul(columns.len() + 1) > MAX_VALUES {
        return Err(format!("spans more than {MAX_VALUES} values with its gaps: cut out the stretch that is wanted"));
    }
    let time = Column::new("time", "s", (0..length).map(|k| k as f64 / rate).collect());
    let filled = columns.into_iter().map(|(name, mut values)| {
        values.resize(length, f64::NAN);
        Column::new(&name, "", values)
    });
    Ok(Content { columns: std::iter::once(time).chain(filled).collect(), notes })
}

/// A source's records on the grid that begins at `begin` (s), and how many samples are missing between them.
fn joined(name: &str, source: &Source, begin: f64) -> Result<(Vec<f64>, usize), Flaw> {
    let mut parts: Vec<&(f64, Vec<f64>)> = source.parts.iter().collect();
    parts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut values, mut gaps): (Vec<f64>, usize) = (Vec::new(), 0);
    // Times are written to a tenth of a millisecond.
    let rounding = 2e-4 * source.rate;
    for (k, (since, part)) in parts.into_iter().enumerate() {
        let place = (since - begin) * source.rate;
        let at = place.round();
        if at > MAX_VALUES as f64 {
            return Err(format!(
                "spans more than {MAX_VALUES} values with its gaps: cut out the stretch that is wanted"
            ));
        }
        let at = at.max(0.0) as usize;
        if (place - at as f64).abs() > OFF_GRID + rounding {
            return Err(format!(
                "is miniSEED whose {name} shifts by {:.2} samples at {since:.3} s: export one stretch",
                place - at as f64
            ));
        }
        if at + 1 < values.len() || (at < values.len() && rounding < 0.5) {
            return Err(format!(
                "is miniSEED whose {name} has two records for the same time, at {since:.3} s: export it once"
            ));
        }
        if at > values.len() {
            gaps += if k > 0 { at - values.len() } else { 0 };
            values.resize(at, f64::NAN);
        }
        values.truncate(at);
        values.extend_from_slice(part);
    }
    Ok((values, gaps))
}

fn name(record: &MseedRecord) -> String {
    [&record.network, &record.station, &record.location, &record.channel].map(|part| part.trim()).join(".")
}

fn values(samples: Samples) -> Vec<f64> {
    match samples {
        Samples::Int(v) => v.into_iter().map(f64::from).collect(),
        Samples::Float(v) => v.into_iter().map(f64::from).collect(),
        Samples::Double(v) => v,
    }
}

/// Seconds since the year 0, leap days counted; differences are what is used.
fn seconds(t: &NanoTime) -> f64 {
    let year = f64::from(t.year) - 1.0;
    let days = 365.0 * year + (year / 4.0).floor() - (year / 100.0).floor() + (year / 400.0).floor() + f64::from(t.day);
    // Whole seconds first: a double holds them and the fraction to a microsecond.
    days * 86_400.0
        + f64::from(t.hour) * 3600.0
        + f64::from(t.minute) * 60.0
        + f64::from(t.second)
        + 1e-9 * f64::from(t.nanosecond)
}

#[cfg(test)]
mod tests {
    use super::*;
    use miniseed_rs::{EncodingFormat, encode};
    use proptest::prelude::*;

    fn record(channel: &str, second: u8, rate: f64, values: Vec<i32>, encoding: EncodingFormat) -> Vec<u8> {
        let time = NanoTime { second, ..NanoTime::epoch() };
        let record = MseedRecord::new()
            .with_nslc("XX", "TAB", "00", channel)
            .with_start_time(time)
            .with_sample_rate(rate)
            .with_encoding(encoding)
            .with_record_length(4096)
            .with_samples(Samples::Int(values));
        encode(&record).unwrap()
    }

    fn wave(count: i32) -> Vec<i32> {
        (0..count).map(|k| (1000.0 * (f64::from(k) * 0.1).sin()) as i32).collect()
    }

    #[test]
    fn records_join_gaps_show_and_sources_stay_apart() {
        let mut bytes = record("HNE", 0, 100.0, wave(200), EncodingFormat::Steim2);
        bytes.extend(record("HNN", 0, 100.0, wave(400), EncodingFormat::Int32));
        bytes.extend(record("HNE", 3, 100.0, wave(100), EncodingFormat::Steim1));
        assert!(is_start(&bytes));
        let content = parse(&bytes).unwrap();
        let names: Vec<&str> = content.columns.iter().map(|c| c.heading.name.as_str()).collect();
        assert_eq!(names, ["time", "XX.TAB.00.HNE", "XX.TAB.00.HNN"]);
        let east = &content.columns[1].values;
        assert_eq!((east.len(), east[150], east[305]), (400, f64::from(wave(200)[150]), f64::from(wave(100)[5])));
        assert!(east[200..300].iter().all(|v| v.is_nan()));
        assert!(content.notes.iter().any(|n| n.contains("100 samples are missing")), "{:?}", content.notes);
    }

    #[test]
    fn what_contradicts_itself_is_refused() {
        let twice = [
            record("HNE", 0, 100.0, wave(200), EncodingFormat::Int32),
            record("HNE", 1, 100.0, wave(200), EncodingFormat::Int32),
        ];
        assert!(parse(&twice.concat()).unwrap_err().contains("two records for the same time"));
        let rates = [
            record("HNE", 0, 100.0, wave(200), EncodingFormat::Int32),
            record("HNE", 2, 50.0, wave(200), EncodingFormat::Int32),
        ];
        assert!(parse(&rates.concat()).unwrap_err().contains("100 and 50 samples a second"));
        let whole = record("HNE", 0, 100.0, wave(200), EncodingFormat::Int32);
        assert!(parse(&[whole.clone(), whole[..600].to_vec()].concat()).unwrap_err().contains("cut off"));
    }

    proptest! {
        #[test]
        fn data_beyond_the_record_crashes_nothing(high in 2u8..=255) {
            let mut bytes = record("HNE", 0, 100.0, wave(200), EncodingFormat::Steim2);
            bytes[44] = high;
            prop_assert!(parse(&bytes).is_err());
        }

        #[test]
        fn no_bytes_crash_it(at in 0..4096usize, byte in any::<u8>(), length in 0..4096usize) {
            let mut bytes = record("HNE", 0, 100.0, wave(200), EncodingFormat::Steim2);
            bytes[at] = byte;
            let _ = parse(&bytes);
            bytes.truncate(length);
            let _ = parse(&bytes);
        }
    }
}
