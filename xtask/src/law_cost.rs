//! Counts the tracking law's instructions on an emulated Cortex-M4.

use crate::output::say;
use crate::shell::{Problem, command, no_words, read, run, top, works};
use crate::toolchain::{self, TARGET};

/// Most instructions that a tick of the whole law may retire.
const MOST: u64 = 1200;
const IMAGE: &str = "target/thumbv7em-none-eabihf/firmware/shakedown-law-cost";

/// The chore: builds the count, runs it under QEMU, holds the law with every part to its bound.
pub(crate) fn count(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let none = "no compiler for the firmware's target: run `cargo xtask setup`";
    let found = toolchain::find().ok_or_else(|| Problem::Failed(none.into()))?;
    if !works(&["qemu-system-arm", "--version"]) {
        return Err(Problem::Failed("qemu-system-arm is not here: install QEMU for ARM systems".into()));
    }
    let words = ["rustc", "--locked", "--profile", "firmware", "--package", "shakedown-law-cost"];
    let mut cargo = found.cargo(&words)?;
    cargo.env("RUSTFLAGS", "-C link-arg=-Tlink.x").current_dir(top());
    run(&mut cargo)?;
    let board =
        ["qemu-system-arm", "-M", "netduinoplus2", "-nographic", "-semihosting", "-icount", "shift=0", "-kernel"];
    let said = read(command(&[&board[..], &[IMAGE]].concat()).current_dir(top()))?;
    say(&format!("instructions a tick ({TARGET}, QEMU):\n{}", said.trim_end()));
    let whole = said.lines().find_map(|line| line.strip_prefix("law, every part "));
    match whole.and_then(|count| count.trim().parse::<u64>().ok()) {
        Some(count) if count <= MOST => Ok(()),
        Some(count) => Err(Problem::Failed(format!("the law retires {count} instructions a tick, more than {MOST}"))),
        None => Err(Problem::Failed(format!("the count said nothing of the whole law: {said}"))),
    }
}
