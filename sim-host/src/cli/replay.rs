//! `shakedown replay`: the firmware image in the loop, by a program of its own.
//!
//! The emulator is most of a minute's compiling to every second of the rest, asks for a newer compiler than the tool
//! does, and is of use to few: so it is not a feature of this binary but a second one, `shakedown-replay`, which takes the same
//! words.

use super::Failure;
use std::path::PathBuf;
use std::process::Command;

/// Runs a firmware image on an emulated processor, in the loop with the plant (needs `shakedown-replay`).
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown replay --elf shakedown.elf --report replay.html
  shakedown replay --elf image.elf --mode guard --json -

The emulator is a separate program: cargo install --path tests/replay --ignore-rust-version")]
pub(crate) struct Args {
    /// What `shakedown-replay` takes; `shakedown-replay --help` lists it.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "WORDS")]
    words: Vec<String>,
}

/// Hands over to the program beside this one, or on the path.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let name = format!("shakedown-replay{}", std::env::consts::EXE_SUFFIX);
    let beside = std::env::current_exe().ok().and_then(|here| Some(here.parent()?.join(&name)));
    let program = beside.filter(|path| path.exists()).unwrap_or_else(|| PathBuf::from(&name));
    match Command::new(&program).args(&args.words).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) if status.code() == Some(2) => Err(Failure::Input("shakedown-replay refused its input".into())),
        Ok(status) => Err(Failure::Work(format!("shakedown-replay ended with {status}"))),
        Err(e) => Err(Failure::Work(format!(
            "{name} did not start ({e}); install it beside this program: cargo install --path tests/replay --ignore-rust-version"
        ))),
    }
}
