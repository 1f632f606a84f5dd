//! A table's model in TOML, effects included: refused with a message, or written as it was read; a table made of it moves by
//! numbers or says that it does not. An odd first byte has the others choose effects and numbers, so that every equation is
//! reached with numbers of any size.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shakedown::blocks::plant as effects;
use shakedown::fit::Motion;
use shakedown::recording::Model;
use shakedown::simulate::{Named, Setup, Twin};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;

/// Numbers as people write them, and as nobody should.
const NUMBERS: [f64; 16] =
    [0.0, -0.0, 1.0, 0.1, 1e-3, 0.242, 50.0, 1e3, 1e6, 1e12, 1e-12, 1e200, 1e-200, f64::MAX, f64::MIN_POSITIVE, -1.0];

/// A table of effects and numbers that the bytes choose, one after the other.
fn chosen(bytes: &[u8]) -> String {
    let mut bytes = bytes.iter().copied();
    let mut number = || NUMBERS[usize::from(bytes.next().unwrap_or(2)) % NUMBERS.len()];
    let [b1, b0, a1, limit] = std::array::from_fn(|_| number());
    let mut text =
        format!("[model]\nkind = \"servo\"\nb1 = {b1:?}\nb0 = {b0:?}\na1 = {a1:?}\nvelocity_limit = {limit:?}\n");
    let (mut names, mut tables) = (Vec::new(), String::new());
    for id in effects::identifiers() {
        if number() < 0.5 {
            continue;
        }
        names.push(format!("{id:?}"));
        let _ = writeln!(tables, "[effects.{id}]");
        for parameter in effects::entry(id).map_or(&[][..], |entry| entry.parameters) {
            let _ = writeln!(tables, "{} = {:?}", parameter.key, number());
        }
    }
    let _ = write!(text, "effects = [{}]\n{tables}", names.join(", "));
    text
}

fuzz_target!(|bytes: &[u8]| {
    let text = match bytes.split_first() {
        Some((first, rest)) if first & 1 == 1 => Cow::from(chosen(rest)),
        Some((_, rest)) => match std::str::from_utf8(rest) {
            Ok(text) => Cow::from(text),
            Err(_) => return,
        },
        None => return,
    };
    let (path, text) = (Path::new("fuzz.toml"), &*text);
    let model = match Model::from_text(path, text) {
        Ok(model) => model,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let written = model.to_toml();
    let again = Model::from_text(path, &written).unwrap_or_else(|error| panic!("{error} of\n{written}"));
    assert_eq!(again.to_toml(), written);
    let table = match Twin::of(&model) {
        Ok(table) => table,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let motion = Motion::from_acceleration(0.001, (0..100).map(|i| f64::from(i % 20) - 9.5).collect());
    match (Setup { table, ..Setup::paper(Named::Strong) }).play(&motion) {
        Ok(trial) => {
            assert!(trial.trace.displacement.iter().chain(&trial.trace.command).all(|value| value.is_finite()))
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
