//! What is on the tape, and that a host that read one bit of it otherwise would be found.

use std::collections::BTreeSet;

use shakedown_core::Settings;
use shakedown_core::host::{self, code};
use shakedown_tape::passages::passages;
use shakedown_tape::{LONGEST, TICKS, play, records, write};

#[test]
fn a_minute_with_everything_in_it() {
    let tape = write();
    assert_eq!(tape, write());
    let (answers, _) = play(&tape).unwrap();
    let of = |tag: u32| -> BTreeSet<u32> {
        records(&tape).zip(&answers).filter(|((t, _), _)| *t == tag).map(|(_, answer)| answer[0]).collect()
    };
    assert_eq!(records(&tape).filter(|(tag, _)| *tag == 4).count(), TICKS as usize);
    assert!(records(&tape).all(|(_, content)| content.len() <= LONGEST));
    assert_eq!(of(1), BTreeSet::from([code::OK as u32]));
    let refused = [code::OK, code::OUT_OF_RANGE, code::CONTRADICTION, code::UNKNOWN_NAME, code::WRONG_VALUE];
    assert_eq!(of(2), refused.iter().map(|&code| code as u32).collect());
    assert!(of(3).len() >= 4, "requests were answered by {:?} alone", of(3));

    let samples = records(&tape).zip(&answers).filter(|((tag, _), _)| *tag == 4);
    let statuses: Vec<u32> = samples.map(|(_, answer)| answer[3]).collect();
    let seen = |of: fn(u32) -> u32| -> BTreeSet<u32> { statuses.iter().map(|&status| of(status)).collect() };
    assert_eq!(seen(|s| s >> 4 & 7).len(), 6, "states");
    let trips = seen(|s| s >> 8 & 31);
    assert!(trips.len() >= 12, "trips: {trips:?}");
    for bit in 0..4 {
        let on = statuses.iter().filter(|&&status| status >> bit & 1 == 1).count();
        assert!((50..TICKS as usize - 50).contains(&on), "bit {bit} of the status is set in {on} ticks");
    }
    let missing = seen(|s| s >> 16 & 255);
    assert!((0..8).all(|channel| missing.iter().any(|set| set >> channel & 1 == 1)), "missing: {missing:?}");
    // No number that is none comes out, so that none whose bits a host may choose.
    assert!(answers.iter().flat_map(|answer| &answer[..3]).all(|&bits| f32::from_bits(bits).is_finite()));
    let numbers =
        records(&tape).filter(|(tag, _)| *tag == 4).flat_map(|(_, content)| content.as_chunks().0[..9].iter());
    let numbers: Vec<f32> = numbers.map(|bytes| f32::from_le_bytes(*bytes)).collect();
    assert!(numbers.iter().filter(|x| x.is_subnormal()).count() > 1000);
    assert!(numbers.iter().filter(|x| x.is_nan()).count() > 300);
}

#[test]
fn settings_read_by_name_are_those_of_the_settings_file() {
    for passage in passages() {
        let file: Settings = toml::from_str(&passage.settings).unwrap();
        assert_eq!(host::settings(&passage.settings), Ok(file), "{}", passage.name);
        file.validate().unwrap();
    }
}

#[test]
fn one_flipped_bit_changes_the_digest() {
    let tape = write();
    let (_, digest) = play(&tape).unwrap();
    let mut flipped = tape.clone();
    // The lowest bit of the reference in a sample of the first passage, where the test runs.
    let (_, sample) = records(&tape).filter(|(tag, _)| *tag == 4).nth(600).unwrap();
    let at = sample.as_ptr().addr() - tape.as_ptr().addr();
    flipped[at] ^= 1;
    assert_ne!(play(&flipped).unwrap().1, digest);
    // Answers that differ in one bit have another digest.
    let (answers, _) = play(&tape).unwrap();
    let mut other = host::Digest::new();
    for (place, answer) in answers.iter().enumerate() {
        let mut answer = *answer;
        answer[0] ^= u32::from(place == 31_234);
        other.answer(answer);
    }
    assert_ne!(other, digest);
}

#[test]
fn a_damaged_tape_is_refused() {
    let begin = records(&write()).next().map(|(_, content)| content.len() + 8).unwrap();
    assert!(play(&write()[..begin]).is_ok());
    let mut strange = write()[..begin].to_vec();
    strange.extend([9, 0, 0, 0, 0, 0, 0, 0]);
    assert!(play(&strange).is_err());
}
