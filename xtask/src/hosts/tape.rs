//! What the chore must know of tapes: where their records are, and how answers are compared.

use crate::shell::Problem;
use std::path::Path;

/// Bytes of an answer.
pub(super) const ANSWER: usize = 16;
/// The tag of a sample.
const SAMPLE: u32 = 4;
/// The sample one bit of which is flipped: the test runs by then.
const FLIPPED: usize = 600;

/// A tape, and its records: tag, and place of the content.
pub(super) struct Tape {
    pub(super) bytes: Vec<u8>,
    records: Vec<(u32, usize)>,
}

impl Tape {
    pub(super) fn of(path: &Path) -> Result<Self, Problem> {
        let bytes = std::fs::read(path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))?;
        let records = records(&bytes).ok_or_else(|| Problem::Failed("the tape is damaged".into()))?;
        Ok(Self { bytes, records })
    }

    pub(super) fn records(&self) -> usize {
        self.records.len()
    }

    /// The same tape but for the lowest bit of one reference.
    pub(super) fn flipped(&self) -> Vec<u8> {
        let mut bytes = self.bytes.clone();
        let at = self.records.iter().filter(|(tag, _)| *tag == SAMPLE).nth(FLIPPED).map(|(_, at)| *at);
        if let Some(byte) = at.and_then(|at| bytes.get_mut(at)) {
            *byte ^= 1;
        }
        bytes
    }

    /// A record as a person would look for it.
    pub(super) fn place(&self, record: usize) -> String {
        let ticks = self.records.iter().take(record).filter(|(tag, _)| *tag == SAMPLE).count();
        let what = match self.records.get(record) {
            Some((SAMPLE, _)) => "tick",
            _ => "what comes before tick",
        };
        format!("{what} {ticks} (record {record})")
    }
}

fn records(bytes: &[u8]) -> Option<Vec<(u32, usize)>> {
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (mut at, mut records) = (0, Vec::new());
    while at < bytes.len() {
        records.push((word(at)?, at + 8));
        at += 8 + word(at + 4)? as usize;
    }
    (at == bytes.len()).then_some(records)
}

/// FNV-1a, 64 bits.
pub(super) fn digest(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// The first record whose answers differ.
pub(super) fn difference(a: &[u8], b: &[u8]) -> Option<usize> {
    let same = a.iter().zip(b).take_while(|(a, b)| a == b).count();
    (a != b).then_some(same / ANSWER)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tape() -> Tape {
        let record =
            |tag: u32, content: &[u8]| [&tag.to_le_bytes(), &(content.len() as u32).to_le_bytes(), content].concat();
        let samples = (0..700_u32).flat_map(|k| record(SAMPLE, &[k.to_le_bytes(); 10].concat()));
        let bytes: Vec<u8> = record(1, b"rate = 1000").into_iter().chain(samples).collect();
        let records = records(&bytes).unwrap();
        Tape { bytes, records }
    }

    #[test]
    fn one_bit_is_flipped_and_its_place_is_named() {
        let tape = tape();
        assert_eq!(tape.records(), 701);
        let flipped = tape.flipped();
        let differing: Vec<usize> = (0..flipped.len()).filter(|&k| flipped[k] != tape.bytes[k]).collect();
        assert_eq!(differing, [tape.records[601].1]);
        assert_eq!(tape.place(601), "tick 600 (record 601)");
        assert_eq!(tape.place(0), "what comes before tick 0 (record 0)");
    }

    #[test]
    fn one_bit_of_difference_in_answers_is_a_difference() {
        let answers = vec![7_u8; 10 * ANSWER];
        let mut other = answers.clone();
        other[5 * ANSWER + 3] ^= 0x10;
        assert_ne!(digest(&answers), digest(&other));
        assert_eq!(difference(&answers, &other), Some(5));
        assert_eq!(difference(&answers, &answers), None);
        assert_eq!(difference(&answers, &answers[..32]), Some(2));
    }

    #[test]
    fn a_damaged_tape_is_refused() {
        let tape = tape();
        assert!(records(&tape.bytes[..tape.bytes.len() - 1]).is_none());
    }
}
