//! What the tests of the image share: a bench around the board, a host at its line, and the same firmware on the host.
#![allow(dead_code, reason = "each test uses its part")]
#![allow(clippy::unwrap_used, clippy::large_types_passed_by_value, reason = "tests and their helpers")]

pub(crate) mod twin;

#[allow(unused_imports, reason = "each test uses its part")]
pub(crate) use shakedown_replay::{bench, bench::near_field, seen};

use std::path::PathBuf;

use shakedown_core::Mode;
use shakedown_core::link::Setup;
use shakedown_firmware::defaults;
use shakedown_firmware::limits::Limits;

/// The image under test; `cargo xtask firmware` builds it.
pub(crate) fn image() -> PathBuf {
    built("shakedown-stm32f407")
}

/// The same board's image with converters of 16 bits outboard.
pub(crate) fn outboard() -> PathBuf {
    built("shakedown-stm32f407-outboard")
}

/// The image of the board of another family, which no emulator here runs.
pub(crate) fn g474_image() -> PathBuf {
    built("shakedown-stm32g474")
}

/// The image `name`.
pub(crate) fn built(name: &str) -> PathBuf {
    let path = target().join("thumbv7em-none-eabihf/firmware").join(name);
    assert!(path.exists(), "{} is missing: `cargo xtask replay` builds every image", path.display());
    path
}

/// The host tool.
pub(crate) fn tool() -> PathBuf {
    let path = target().join("debug/shakedown");
    assert!(path.exists(), "{} is missing: run `cargo build -p shakedown`", path.display());
    path
}

/// Where cargo puts what it builds: beside the sources, or wherever its configuration says.
fn target() -> PathBuf {
    // target/PROFILE/deps/test, or target/PROFILE/examples/example
    let here = std::env::current_exe().unwrap();
    here.ancestors().nth(3).unwrap().to_owned()
}

/// The setup for a mode: the paper's gains, every part of the core at work.
pub(crate) fn setup(mode: Mode) -> Setup {
    let mut setup = defaults::setup();
    setup.control.mode = mode;
    setup
}

/// The same for converters of 16 bits.
pub(crate) fn setup_outboard(mode: Mode) -> Setup {
    let mut setup = defaults::setup_of(Limits { full_scale: u16::MAX, highest_rate: 4000 });
    setup.control.mode = mode;
    setup
}
