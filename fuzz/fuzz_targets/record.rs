//! A ground-motion record in any format: read or refused; what is read is finite, and what is refused says why.
//! The first byte chooses what the person said of the file.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::fit::read::{Channel, Options, record_from_bytes};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let Some((choice, content)) = bytes.split_first() else { return };
    let options = Options {
        dt: (choice & 1 != 0).then_some(0.01),
        unit: None,
        channel: if choice & 2 != 0 { Channel::Wrapped } else { Channel::First },
        ..Options::default()
    };
    match record_from_bytes(Path::new("fuzz.txt"), content.to_vec(), &options) {
        Ok(record) => assert!(record.acceleration.iter().all(|a| a.is_finite())),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
