//! Counts the instructions of the tracking law and of the preview modifier on an emulated Cortex-M4, and checks that the
//! law computes there what it does here.

use crate::firmware::image_path;
use crate::output::say;
use crate::setup::{self, QEMU};
use crate::shell::{Problem, command, no_words, read, run, top};
use crate::toolchain::{self, TARGET};

/// What is held to a bound: most instructions that a tick of it may retire.
const MOST: &[(&str, u64)] = &[
    ("law, every part", 1200),
    ("preview, quiet record, most", 1500),
    ("preview, record at three times the limit, most", 1500),
];
/// The emulator: an STM32F405, one instruction a nanosecond, what the program says on standard output.
const EMULATOR: &[&str] = &[
    "qemu-system-arm",
    "-M",
    "netduinoplus2",
    "-display",
    "none",
    "-serial",
    "none",
    "-monitor",
    "none",
    "-chardev",
    "stdio,id=out",
    "-semihosting-config",
    "enable=on,target=native,chardev=out",
    "-icount",
    "shift=0",
    "-kernel",
];
const IMAGE: &str = "shakedown-law-cost";

/// The chore: builds the count, runs it under QEMU, holds what has a bound to it.
pub(crate) fn count(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    setup::need(&[TARGET, QEMU])?;
    let none = "no compiler for the firmware's target: run `cargo xtask setup`";
    let found = toolchain::find().ok_or_else(|| Problem::Failed(none.into()))?;
    let words = ["rustc", "--locked", "--profile", "firmware", "--package", IMAGE];
    let mut cargo = found.cargo(&words)?;
    cargo.env("RUSTFLAGS", "-C link-arg=-Tlink.x").current_dir(top());
    run(&mut cargo)?;
    let said = read(command(EMULATOR).arg(image_path(IMAGE)?).current_dir(top()))?;
    say(&format!("instructions a tick ({TARGET}, QEMU):\n{}", said.trim_end()));
    let here = read(
        command(&["cargo", "run", "--locked", "--release", "--package", "shakedown-law-cost"]).current_dir(top()),
    )?;
    alike(&said, &here)?;
    MOST.iter().try_for_each(|&(name, most)| bounded(&said, name, most))
}

/// Holds the count of this name to its bound.
fn bounded(said: &str, name: &str, most: u64) -> Result<(), Problem> {
    let count = said.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
    match count {
        Some(count) if count <= most => Ok(()),
        Some(count) => Err(Problem::Failed(format!("{name}: {count} instructions a tick, more than {most}"))),
        None => Err(Problem::Failed(format!("the count said nothing of {name}: {said}"))),
    }
}

/// Holds the hashes over every command's bits, on target and host, against each other.
fn alike(there: &str, here: &str) -> Result<(), Problem> {
    let words = |text: &str| -> Vec<String> {
        let hashes = text.lines().filter(|line| line.starts_with("hash"));
        hashes.map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
    };
    let (there, here) = (words(there), words(here));
    if there.is_empty() || there != here {
        return Err(Problem::Failed(format!("target and host differ: {there:?}, {here:?}")));
    }
    say("every command has the same bits on target and host");
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{alike, bounded};

    #[test]
    fn a_count_beyond_its_bound_or_missing_is_refused() {
        let said = "law, paper's table   312\nlaw, every part    484\n";
        assert!(bounded(said, "law, every part", 484).is_ok());
        assert!(bounded(said, "law, every part", 483).is_err());
        assert!(bounded(said, "preview", 1500).is_err());
    }

    #[test]
    fn one_bit_of_difference_is_a_difference() {
        assert!(alike("law 3\nhash, a   12\n", "hash, a 12\n").is_ok());
        assert!(alike("hash, a 12\n", "hash, a 13\n").is_err());
        assert!(alike("law 3\n", "law 3\n").is_err());
    }
}
