//! The tests of the board's own code: on the emulated board, and on a real one where a probe is attached.

use crate::firmware::{BOARDS, image, test};
use crate::output::say;
use crate::shell::{Problem, command, no_words, read, run as execute, works};

const IMAGE: &str = "target/thumbv7em-none-eabihf/firmware/shakedown-hil";
const NEEDS: &str = "on a board this needs:\n  \
    probe-rs (`cargo install probe-rs-tools --locked`)\n  \
    a debug probe (ST-Link, J-Link, CMSIS-DAP) and an STM32F407 on its SWD, hydraulics off and nothing at PB0\n  \
    a wire from PA4 to PA1";

/// The chore: the tests on the emulated board, then on the one that is attached.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    image("shakedown-hil")?;
    test(&["hil".into()], &["--nocapture"])?;
    if !works(&["probe-rs", "--version"]) {
        say(&format!("SKIPPED: the board: no probe-rs here; {NEEDS}"));
        return Ok(());
    }
    let probes = read(&mut command(&["probe-rs", "list"]))?;
    if !probes.contains("[0]") {
        say(&format!("SKIPPED: the board: no probe is attached; {NEEDS}"));
        return Ok(());
    }
    say(probes.trim_end());
    execute(&mut command(&["probe-rs", "run", "--chip", BOARDS[0].chip, IMAGE]))
}
