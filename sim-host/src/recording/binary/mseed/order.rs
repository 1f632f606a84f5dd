//! Records of version 2 whose headers or compressed samples are little-endian, turned: the library reads the other order alone. Plain
//! samples are in the order that blockette 1000 states, which it knows; of little-endian Steim frames it reads wrong values.
//!
//! Source of the frames: FDSN, "SEED Reference Manual", version 2.4, appendix B.

use super::MOST_BLOCKETTES;
use std::borrow::Cow;

/// Where a fixed header has numbers of several bytes: place and width.
const NUMBERS: [(usize, usize); 9] = [(20, 2), (22, 2), (28, 2), (30, 2), (32, 2), (34, 2), (40, 4), (44, 2), (46, 2)];
/// Bytes of a fixed header.
const HEADER: usize = 48;
/// Years of a header in the right order.
const YEARS: std::ops::RangeInclusive<u16> = 1900..=2100;

/// Encodings of blockette 1000 whose samples come in frames of so many bytes, of words of four.
const STEIM: [u8; 2] = [10, 11];
const FRAME: usize = 64;

/// The same bytes with every header big-endian, and every compressed sample.
pub(super) fn big_endian(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut turned = Cow::Borrowed(bytes);
    let mut at = 0;
    while let Some(record) = bytes.get(at..).filter(|r| r.len() >= HEADER && !r.starts_with(b"MS")) {
        let little = is_little(record);
        let Some((length, blockettes, samples)) = blockettes(record, little) else { break };
        let data = word(record, 44, little).map_or(length, usize::from);
        let frames = samples.is_some_and(|at| record[at + 1] == 0 && STEIM.contains(&record[at]));
        if little {
            let record = &mut turned.to_mut()[at..];
            NUMBERS.iter().chain(&blockettes).for_each(|(place, width)| record[*place..place + width].reverse());
        }
        if let Some(samples) = samples.filter(|_| frames) {
            let record = &mut turned.to_mut()[at..];
            let end = length.min(record.len());
            let first = record[samples] == STEIM[0];
            record
                .get_mut(data..end)
                .into_iter()
                .flat_map(|data| data.chunks_exact_mut(FRAME))
                .for_each(|f| turn(f, first));
            record[samples + 1] = 1;
        }
        at += length;
    }
    turned
}

/// Turns a frame: its first word says of each of the others what numbers it holds. In the first version of the compression pairs of
/// two bytes are numbers, in the second they are parts of a word.
fn turn(frame: &mut [u8], first: bool) {
    frame[..4].reverse();
    let control = u32::from_be_bytes([frame[0], frame[1], frame[2], frame[3]]);
    for (k, word) in frame.chunks_exact_mut(4).enumerate().skip(1) {
        match (control >> (30 - 2 * k)) & 3 {
            // Four numbers of one byte.
            1 => {}
            2 if first => word.chunks_exact_mut(2).for_each(<[u8]>::reverse),
            _ => word.reverse(),
        }
    }
}

fn word(record: &[u8], at: usize, little: bool) -> Option<u16> {
    let pair = record.get(at..at + 2)?;
    let pair = [pair[0], pair[1]];
    Some(if little { u16::from_le_bytes(pair) } else { u16::from_be_bytes(pair) })
}

fn is_little(record: &[u8]) -> bool {
    let year = |little| word(record, 20, little).is_some_and(|year| YEARS.contains(&year));
    !year(false) && year(true)
}

/// A record's length by its blockette 1000, where its blockettes have numbers of several bytes, and where the encoding of its samples is
/// stated, their order behind it; none where it has no such blockette or a blockette lies beyond it.
fn blockettes(record: &[u8], little: bool) -> Option<(usize, Vec<(usize, usize)>, Option<usize>)> {
    let (mut at, mut numbers, mut length) = (usize::from(word(record, 46, little)?), Vec::new(), None);
    let mut samples = None;
    for _ in 0..MOST_BLOCKETTES {
        let (kind, next) = (word(record, at, little)?, usize::from(word(record, at + 2, little)?));
        record.get(at..at + 8)?;
        numbers.extend([(at, 2), (at + 2, 2)]);
        match kind {
            // The rate as a float.
            100 => numbers.push((at + 4, 4)),
            1000 => {
                length = 1usize.checked_shl(u32::from(record[at + 6])).filter(|n| *n >= HEADER);
                samples = Some(at + 4);
            }
            _ => {}
        }
        if next <= at {
            break;
        }
        at = next;
    }
    length.map(|length| (length, numbers, samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame of the first version: its first and last value, two numbers of two bytes, four of one, one of four.
    #[test]
    fn a_frame_is_turned_number_by_number() {
        let words = |control: u32, pair: [u8; 4]| {
            let mut frame = vec![0; FRAME];
            for (k, word) in
                [control.to_be_bytes(), [0, 0, 1, 2], [0, 0, 3, 4], pair, [9, 8, 7, 6], [5, 4, 3, 2]].iter().enumerate()
            {
                frame[4 * k..4 * k + 4].copy_from_slice(word);
            }
            frame
        };
        let control = (2 << 24) | (1 << 22) | (3 << 20);
        for (first, pair) in [(true, [2, 1, 4, 3]), (false, [4, 3, 2, 1])] {
            let mut little = words(control, pair);
            for at in [0, 4, 8, 20] {
                little[at..at + 4].reverse();
            }
            turn(&mut little, first);
            assert_eq!(little, words(control, [1, 2, 3, 4]), "{first}");
        }
    }

    #[test]
    fn a_header_is_turned_once() {
        let mut record = vec![b'0'; 64];
        record[20..24].copy_from_slice(&[0x07, 0xb2, 0, 1]);
        record[44..64].copy_from_slice(&[0, 64, 0, 48, 0x03, 0xe8, 0, 56, 11, 1, 6, 0, 0, 100, 0, 0, 0x43, 0x48, 0, 0]);
        record[54] = 6;
        assert!(matches!(big_endian(&record), Cow::Borrowed(_)));
        let mut little = record.clone();
        let places = NUMBERS.iter().copied().chain([(48, 2), (50, 2), (56, 2), (58, 2), (60, 4)]);
        places.for_each(|(place, width)| little[place..place + width].reverse());
        // Two records, one of each kind.
        let both = [little.clone(), record.clone()].concat();
        assert_eq!(big_endian(&both).as_ref(), [record.clone(), record.clone()].concat());
        little.truncate(50);
        assert_eq!(big_endian(&little).as_ref(), little);
    }
}
