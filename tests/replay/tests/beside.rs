//! The core's laws beside the same laws in C and beside `idsp`'s, in instructions a step on the same emulated processor.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use std::collections::BTreeMap;

use crate::common::built;
use shakedown_replay::Mark;

/// Steps between the two marks of a measurement, and the marks (`tests/beside`).
const STEPS: f64 = 256.0;
const BEGIN: u64 = 0x100;
const END: u64 = 0x200;
const DIFFERENT: u64 = 0x300;
/// Largest ratio, from the requirements.
const RATIO: f64 = 1.1;

/// Ours, theirs, and what is compared: the same arithmetic, but for the clamp that `idsp`'s controller has at its output
/// and the displacement loop at its integral.
const PAIRS: [(u64, u64, &str); 6] = [
    (1, 9, "displacement loop, beside C"),
    (2, 10, "three-variable law, beside C"),
    (3, 11, "observer, beside C"),
    (4, 12, "second-order section, beside C"),
    (1, 17, "displacement loop, beside idsp's PI"),
    (5, 18, "direct form of a second-order section, beside idsp's"),
];
/// Not the same arithmetic, so no bound: the core's section is a state-variable form of seven products, which keeps corners
/// below a thousandth of the rate, and `idsp` has none of that kind (its state-variable filter is Chamberlin's, of three).
/// What five products cost in either's hands is the last of the pairs.
const OTHER: (u64, u64, &str) = (4, 18, "second-order section, beside idsp's direct form (other arithmetic)");

/// Steps of the whole core, by number.
const MODES: [(u64, &str); 4] =
    [(32, "guard"), (33, "modifier"), (34, "controller"), (35, "controller, three variables")];
/// Largest median step of the whole core, in every mode, from the requirements.
const STEP: f64 = 1200.0;

fn marks() -> Vec<Mark> {
    shakedown_replay::marks(&built("shakedown-beside")).unwrap()
}

/// Between every mark of a begin and that of its end: number and instructions.
fn spans(marks: &[Mark]) -> impl Iterator<Item = (u64, f64)> + '_ {
    marks.windows(2).filter_map(|pair| {
        let number = pair[0].value.checked_sub(BEGIN)?;
        (pair[1].value == END | number).then(|| (number, (pair[1].instructions - pair[0].instructions) as f64))
    })
}

/// Instructions a step, by number, without the loop around it and without what a call costs in its language.
fn measured() -> BTreeMap<u64, f64> {
    let marks = marks();
    assert!(marks.iter().all(|mark| mark.value != DIFFERENT), "the core's bits differ from those in C");
    let mut steps: BTreeMap<u64, f64> = spans(&marks).map(|(number, cost)| (number, cost / STEPS)).collect();
    let empty = steps[&0];
    let empty_in_c = steps.get(&8).copied().unwrap_or(empty);
    for (number, step) in &mut steps {
        *step -= if (8..16).contains(number) { empty_in_c } else { empty };
    }
    steps
}

#[test]
fn no_law_costs_more_than_a_tenth_above_the_same_in_c() {
    let steps = measured();
    let mut worst: f64 = 0.0;
    for (ours, theirs, what) in PAIRS {
        let ours = steps[&ours];
        let Some(&theirs) = steps.get(&theirs) else {
            println!(
                "SKIPPED: {what}: no C compiler for the target (arm-none-eabi-gcc); `cargo xtask setup` installs it"
            );
            continue;
        };
        println!("{ours:6.1} {theirs:6.1}  ratio {:.3}  {what}", ours / theirs);
        worst = worst.max(ours / theirs);
    }
    let (ours, theirs) = (steps[&OTHER.0], steps[&OTHER.1]);
    println!("{ours:6.1} {theirs:6.1}  ratio {:.3}  {}", ours / theirs, OTHER.2);
    assert!(worst <= RATIO, "the largest ratio is {worst:.3}");
}

/// The whole core by itself, without the board around it (`cost.rs` has that): in the middle of a test that saturates.
#[test]
fn the_cores_step_stays_within_its_bounds() {
    let marks = marks();
    let median = |number: u64| {
        let mut costs: Vec<f64> = spans(&marks).filter(|&(of, _)| of == number).map(|(_, cost)| cost).collect();
        assert_eq!(costs.len(), 2000);
        costs.drain(..1000);
        costs.sort_by(f64::total_cmp);
        (costs[costs.len() / 2], costs[costs.len() - 1])
    };
    for (number, mode) in MODES {
        let (middle, most) = median(number);
        println!("{middle:5.0} median {most:5.0} most  instructions a step of the core, {mode}");
        assert!(middle <= STEP, "{mode}");
    }
}
