//! A CSV recording: any bytes are read or refused, never worse; what is read is as long as its columns say.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::blocks::recording::{Stated, csv};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("fuzz.csv");
    let Ok(headings) = csv::headings(bytes, path, &Stated::default()) else { return };
    let names: Vec<&str> = headings.iter().map(|heading| heading.name.as_str()).collect();
    let _ = csv::read(bytes, path, &names, &Stated::default());
});
