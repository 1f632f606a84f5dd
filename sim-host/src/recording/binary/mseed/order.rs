//! Records of version 2 whose headers are little-endian, turned: the library reads the other order alone. Samples are in the order
//! that blockette 1000 states, which it knows.

use super::MOST_BLOCKETTES;
use std::borrow::Cow;

/// Where a fixed header has numbers of several bytes: place and width.
const NUMBERS: [(usize, usize); 9] = [(20, 2), (22, 2), (28, 2), (30, 2), (32, 2), (34, 2), (40, 4), (44, 2), (46, 2)];
/// Bytes of a fixed header.
const HEADER: usize = 48;
/// Years of a header in the right order.
const YEARS: std::ops::RangeInclusive<u16> = 1900..=2100;

/// The same bytes with every header big-endian.
pub(super) fn big_endian(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut turned = Cow::Borrowed(bytes);
    let mut at = 0;
    while let Some(record) = bytes.get(at..).filter(|r| r.len() >= HEADER && !r.starts_with(b"MS")) {
        let little = is_little(record);
        let Some((length, blockettes)) = blockettes(record, little) else { break };
        if little {
            let record = &mut turned.to_mut()[at..];
            NUMBERS.iter().chain(&blockettes).for_each(|(place, width)| record[*place..place + width].reverse());
        }
        at += length;
    }
    turned
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

/// A record's length by its blockette 1000, and where its blockettes have numbers of several bytes; none where it has no such blockette
/// or a blockette lies beyond it.
fn blockettes(record: &[u8], little: bool) -> Option<(usize, Vec<(usize, usize)>)> {
    let (mut at, mut numbers, mut length) = (usize::from(word(record, 46, little)?), Vec::new(), None);
    for _ in 0..MOST_BLOCKETTES {
        let (kind, next) = (word(record, at, little)?, usize::from(word(record, at + 2, little)?));
        record.get(at..at + 8)?;
        numbers.extend([(at, 2), (at + 2, 2)]);
        match kind {
            // The rate as a float.
            100 => numbers.push((at + 4, 4)),
            1000 => length = 1usize.checked_shl(u32::from(record[at + 6])).filter(|n| *n >= HEADER),
            _ => {}
        }
        if next <= at {
            break;
        }
        at = next;
    }
    length.map(|length| (length, numbers))
}

#[cfg(test)]
mod tests {
    use super::*;

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
