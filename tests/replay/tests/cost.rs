//! What the image costs, against golden figures: more than 3 % above any of them fails, and so does any bound.
//!
//! `UPDATE_GOLDEN=1 cargo xtask replay cost` writes the figures anew; the difference belongs into the change that made it.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::large_types_passed_by_value,
    reason = "tests and their helpers"
)]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::common::{g474_image, image, near_field, outboard, seen::Seen, setup, setup_outboard};
use shakedown::blocks::device::Progress;
use shakedown_core::Mode;
use shakedown_core::link::Setup;
use shakedown_replay::{Ran, Stack};

/// Hard limits, byte: 1.2 of what the first image that ran took.
const FLASH: u64 = 103_400;
const RAM: u64 = 29_200;
/// The same, in instructions of a whole tick in any mode, the board's part included: below a hundredth of 1 ms.
const MEDIAN: u64 = 1200;
/// Instructions of the dearest tick alone with the relay closed, in any mode.
const MOST: u64 = 6000;
/// Share of the stack that may have been used.
const STACK: f64 = 0.75;
/// Growth that fails, as a share.
const GROWTH: f64 = 0.03;

/// Instructions retired from one update of the timer to the next in the middle of a run: median and most. No telemetry,
/// so that nothing but the tick runs; `most` is a tick in which the desk reads a frame of the reference as well.
fn instructions(image: &Path, setup: Setup) -> (u64, u64, Ran<Seen>) {
    let setup = Setup { telemetry_every: 0, ..setup };
    let ran = shakedown_replay::run(image, Seen::new(setup, near_field(4))).unwrap();
    assert_eq!(ran.world.progress, Progress::Done);
    let counts = &ran.world.instructions[1500..3500];
    let mut costs: Vec<u64> = counts.windows(2).map(|pair| pair[1] - pair[0]).collect();
    costs.sort_unstable();
    (costs[costs.len() / 2], costs[costs.len() - 1], ran)
}

fn measured() -> (BTreeMap<String, u64>, Stack) {
    let size = shakedown_replay::size::size(&image()).unwrap();
    let mut figures = BTreeMap::from([("flash, byte".into(), size.flash), ("variables, byte".into(), size.ram)]);
    let mut deepest = Stack::default();
    for (name, mode) in [("guard", Mode::Guard), ("modifier", Mode::Modifier), ("controller", Mode::Controller)] {
        let (median, most, Ran { stack, dearest_tick, dearest_closed, .. }) = instructions(&image(), setup(mode));
        figures.insert(format!("{name}, instructions a tick, median"), median);
        figures.insert(format!("{name}, instructions a tick, most"), most);
        figures.insert(format!("{name}, instructions of the dearest tick alone"), dearest_tick);
        figures.insert(format!("{name}, instructions of the dearest tick alone, relay closed"), dearest_closed);
        deepest = Stack { deepest: deepest.deepest.max(stack.deepest), ..stack };
    }
    figures.insert("stack, byte".into(), deepest.deepest);
    figures.insert("stack and variables, byte".into(), deepest.size + size.ram);
    let (median, most, Ran { stack, .. }) = instructions(&outboard(), setup_outboard(Mode::Controller));
    figures.insert("outboard: controller, instructions a tick, median".into(), median);
    figures.insert("outboard: controller, instructions a tick, most".into(), most);
    figures.insert("outboard: stack, byte".into(), stack.deepest);
    for (name, image) in [("outboard", outboard()), ("STM32G474", g474_image())] {
        let size = shakedown_replay::size::size(&image).unwrap();
        figures.insert(format!("{name}: flash, byte"), size.flash);
        figures.insert(format!("{name}: stack and variables, byte"), deepest.size + size.ram);
    }
    (figures, deepest)
}

fn golden() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden/cost.txt")
}

#[test]
fn the_image_costs_no_more_than_it_did() {
    let (measured, stack) = measured();
    let text = measured.iter().fold(String::new(), |mut text, (name, value)| {
        let _ = writeln!(text, "{value:>6}  {name}");
        text
    });
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(golden(), &text).unwrap();
    }
    let golden = std::fs::read_to_string(golden()).unwrap();
    for line in golden.lines() {
        let (value, name) = line.trim().split_once("  ").unwrap();
        let (was, is): (f64, f64) = (value.parse().unwrap(), measured[name] as f64);
        assert!(is <= was * (1.0 + GROWTH), "{name}: {is}, was {was}\nmeasured:\n{text}");
    }
    assert_eq!(golden.lines().count(), measured.len());
    // With outboard converters the instructions that wait for the bus are counted too: it is held to its golden figure alone.
    let medians = measured.iter().filter(|(name, _)| name.ends_with("median") && !name.starts_with("outboard"));
    assert!(medians.into_iter().all(|(_, &instructions)| instructions <= MEDIAN), "{measured:?}");
    let dearest = measured.iter().filter(|(name, _)| name.ends_with("relay closed"));
    assert!(dearest.into_iter().all(|(_, &instructions)| (500..=MOST).contains(&instructions)), "{measured:?}");
    assert!(
        measured.iter().filter(|(name, _)| name.contains("flash")).all(|(_, &flash)| flash <= FLASH),
        "{measured:?}"
    );
    assert!(stack.deepest as f64 <= STACK * stack.size as f64, "{stack:?}");
    assert!(
        measured
            .iter()
            .filter(|(name, _)| name.contains("variables") && name.contains("stack"))
            .all(|(_, &ram)| ram <= RAM),
        "{measured:?}"
    );
}
