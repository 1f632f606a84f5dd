//! Follows one tick of the image, in the middle of a run, and prints the address of each instruction it retires:
//! `arm-none-eabi-addr2line -i` says which block each belongs to. Arguments: image, mode, and on standard input the
//! addresses of all instructions, one a line, hexadecimal.
#![allow(clippy::unwrap_used, clippy::large_types_passed_by_value, reason = "shares the tests' helpers")]

#[path = "../tests/common/mod.rs"]
mod common;

use std::io::{BufRead as _, Write as _};
use std::path::Path;

use common::{near_field, seen::Seen, setup};
use shakedown_core::Mode;

/// A tick in the middle of the run, not one in which the desk is woken.
const TICK: u64 = 2504;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let image = arguments.get(1).ok_or("which image?")?;
    let mode = match arguments.get(2).map(String::as_str) {
        Some("guard") => Mode::Guard,
        Some("modifier") => Mode::Modifier,
        _ => Mode::Controller,
    };
    let mut setup = setup(mode);
    setup.telemetry_every = 0;
    if arguments.get(3).is_some() {
        setup.control.modification = shakedown_core::Modification::Clip;
    }
    let addresses: Vec<u64> =
        std::io::stdin().lock().lines().filter_map(|line| u64::from_str_radix(line.ok()?.trim(), 16).ok()).collect();
    let mut seen = Seen::new(setup, near_field(4));
    seen.limit = TICK as usize + 10;
    let ran = shakedown_replay::follow(Path::new(image), seen, TICK, &addresses)?;
    let costs: Vec<u64> = ran.world.instructions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    eprintln!("{:?}", costs.get(2470..));
    let mut out = std::io::stdout().lock();
    for address in &ran.followed {
        writeln!(out, "{address:#x}")?;
    }
    Ok(())
}
