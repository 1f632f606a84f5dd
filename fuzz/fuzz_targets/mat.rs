//! A MATLAB v5 recording: any bytes are read or refused, within the memory the reader states.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::blocks::recording::mat;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let path = Path::new("fuzz.mat");
    let Ok(headings) = mat::headings(bytes, path) else { return };
    let names: Vec<&str> = headings.iter().map(|heading| heading.name.as_str()).collect();
    let _ = mat::read(bytes, path, &names);
});
