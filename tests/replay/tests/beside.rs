//! The core's laws beside the same laws in C and beside `idsp`'s, in instructions a step on the same emulated processor.

use std::collections::BTreeMap;
use std::path::PathBuf;

/// Steps between the two marks of a measurement, and the marks (`tests/beside`).
const STEPS: f64 = 256.0;
const BEGIN: u64 = 0x100;
const END: u64 = 0x200;
const DIFFERENT: u64 = 0x300;
/// Largest ratio, from the requirements.
const RATIO: f64 = 1.1;

/// Ours, theirs, and what is compared.
const PAIRS: [(u64, u64, &str); 6] = [
    (1, 9, "displacement loop, beside C"),
    (2, 10, "three-variable law, beside C"),
    (3, 11, "observer, beside C"),
    (4, 12, "second-order section, beside C"),
    (1, 17, "displacement loop, beside idsp's PI"),
    (4, 18, "second-order section, beside idsp's biquad"),
];

/// Instructions a step, by number, without the loop around it and its call.
fn measured() -> BTreeMap<u64, f64> {
    let image = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../target/thumbv7em-none-eabihf/firmware/shakedown-beside");
    assert!(image.exists(), "{} is missing: run `cargo xtask beside`", image.display());
    let marks = shakedown_replay::marks(&image).unwrap();
    assert!(marks.iter().all(|mark| mark.value != DIFFERENT), "the core's bits differ from those in C");
    let spans = marks.windows(2).filter_map(|pair| {
        let number = pair[0].value.checked_sub(BEGIN)?;
        (pair[1].value == END | number).then(|| (number, (pair[1].instructions - pair[0].instructions) as f64 / STEPS))
    });
    let mut steps: BTreeMap<u64, f64> = spans.collect();
    let empty = steps.remove(&0).unwrap();
    steps.values_mut().for_each(|step| *step -= empty);
    steps
}

#[test]
fn no_law_costs_more_than_a_tenth_above_the_same_in_c() {
    let steps = measured();
    let mut worst: f64 = 0.0;
    for (ours, theirs, what) in PAIRS {
        let ours = steps[&ours];
        let Some(&theirs) = steps.get(&theirs) else {
            println!("SKIPPED: {what}: no C compiler for the target (arm-none-eabi-gcc); `cargo xtask setup` installs it");
            continue;
        };
        println!("{ours:6.1} {theirs:6.1}  ratio {:.3}  {what}", ours / theirs);
        worst = worst.max(ours / theirs);
    }
    assert!(worst <= RATIO, "the largest ratio is {worst:.3}");
}
