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

/// What a header says of its record.
struct Header {
    /// Bytes of the record.
    length: usize,
    /// Where its blockettes have numbers of several bytes: place and width.
    numbers: Vec<(usize, usize)>,
    /// Where the encoding of its samples is stated; their order is behind it.
    encoding: usize,
}

/// The same bytes with every header and every compressed sample big-endian.
pub(super) fn big_endian(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut turned = Cow::Borrowed(bytes);
    let mut at = 0;
    while let Some(record) = bytes.get(at..).filter(|r| r.len() >= HEADER && !r.starts_with(b"MS")) {
        let little = is_little(record);
        let Some(Header { length, numbers, encoding }) = header(record, little) else { break };
        if little {
            let record = &mut turned.to_mut()[at..];
            NUMBERS.iter().chain(&numbers).for_each(|(place, width)| record[*place..place + width].reverse());
        }
        if STEIM.contains(&record[encoding]) && record[encoding + 1] == 0 {
            let first = record[encoding] == STEIM[0];
            let data = word(record, 44, little).map_or(length, usize::from)..length.min(record.len());
            let record = &mut turned.to_mut()[at..];
            record[encoding + 1] = 1;
            for frame in record.get_mut(data).unwrap_or_default().chunks_exact_mut(FRAME) {
                turn(frame, first);
            }
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

/// What a record's header says; none where it has no blockette 1000 or a blockette lies beyond it.
fn header(record: &[u8], little: bool) -> Option<Header> {
    let (mut at, mut numbers, mut stated) = (usize::from(word(record, 46, little)?), Vec::new(), None);
    for _ in 0..MOST_BLOCKETTES {
        let (kind, next) = (word(record, at, little)?, usize::from(word(record, at + 2, little)?));
        record.get(at..at + 8)?;
        numbers.extend([(at, 2), (at + 2, 2)]);
        match kind {
            // The rate as a float.
            100 => numbers.push((at + 4, 4)),
            1000 => {
                let length = 1usize.checked_shl(u32::from(record[at + 6])).filter(|n| *n >= HEADER);
                stated = length.map(|length| (length, at + 4));
            }
            _ => {}
        }
        if next <= at {
            break;
        }
        at = next;
    }
    stated.map(|(length, encoding)| Header { length, numbers, encoding })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame: its first and last value, a pair of bytes twice, four numbers of one byte, one of four.
    fn frame(pairs: [u8; 4]) -> Vec<u8> {
        let control: u32 = (2 << 24) | (1 << 22) | (3 << 20);
        let words = [control.to_be_bytes(), [0, 0, 1, 2], [0, 0, 3, 4], pairs, [9, 8, 7, 6], [5, 4, 3, 2]];
        let mut frame = words.concat();
        frame.resize(FRAME, 0);
        frame
    }

    /// The same little-endian, in the first version of the compression or the second.
    fn little_frame(first: bool) -> Vec<u8> {
        let mut frame = frame(if first { [2, 1, 4, 3] } else { [4, 3, 2, 1] });
        for at in [0, 4, 8, 20] {
            frame[at..at + 4].reverse();
        }
        frame
    }

    #[test]
    fn a_frame_is_turned_number_by_number() {
        for first in [true, false] {
            let mut little = little_frame(first);
            turn(&mut little, first);
            assert_eq!(little, frame([1, 2, 3, 4]), "{first}");
        }
    }

    /// Two records of a big-endian header and little-endian samples, of either version: each says afterwards what it holds.
    #[test]
    fn compressed_samples_are_turned_once() {
        let record = |encoding: u8, order: u8, frame: Vec<u8>| {
            let mut header = vec![b'0'; 64];
            header[20..24].copy_from_slice(&[0x07, 0xb2, 0, 1]);
            header[44..56].copy_from_slice(&[0, 64, 0, 48, 0x03, 0xe8, 0, 0, encoding, order, 7, 0]);
            [header, frame].concat()
        };
        let little = [record(10, 0, little_frame(true)), record(11, 0, little_frame(false))].concat();
        let big = [record(10, 1, frame([1, 2, 3, 4])), record(11, 1, frame([1, 2, 3, 4]))].concat();
        assert_eq!(big_endian(&little).as_ref(), big);
        assert!(matches!(big_endian(&big), Cow::Borrowed(_)));
        let plain = record(3, 0, little_frame(true));
        assert!(matches!(big_endian(&plain), Cow::Borrowed(_)), "the library knows the order of plain numbers");
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
