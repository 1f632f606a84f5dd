//! The tests of the board's own code: on the emulated board, and on a real one where a probe is attached.

use crate::boards;
use crate::firmware::{image, image_path, test};
use crate::output::say;
use crate::setup;
use crate::shell::{Problem, command, no_words, read, run as execute, works};
use crate::toolchain::TARGET;

const IMAGE: &str = "shakedown-hil";

/// What a board with `chip` needs to be tested.
fn needs(chip: &str) -> String {
    format!(
        "on a board this needs:\n  \
         probe-rs (`cargo install probe-rs-tools --locked`)\n  \
         a debug probe (ST-Link, J-Link, CMSIS-DAP) and a board with the {chip} on its SWD, hydraulics off and nothing at its relay's pin\n  \
         a wire from the converter's output to the LVDT's input"
    )
}

/// The chore: the tests on the emulated board, then on the one that is attached.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    setup::need(&[TARGET])?;
    let chip = boards::default()?.chip;
    image(IMAGE)?;
    test(&["hil".into()], &["--nocapture"])?;
    if !works(&["probe-rs", "--version"]) {
        say(&format!("SKIPPED: the board: no probe-rs here; {}", needs(&chip)));
        return Ok(());
    }
    let probes = read(&mut command(&["probe-rs", "list"]))?;
    if !probes.contains("[0]") {
        say(&format!("SKIPPED: the board: no probe is attached; {}", needs(&chip)));
        return Ok(());
    }
    say(probes.trim_end());
    execute(command(&["probe-rs", "run", "--chip", &chip]).arg(image_path(IMAGE)?))
}
