//! Rust on this machine, and on an emulated Cortex-M4F.

use super::Work;
use crate::shell::{Problem, command, read, run as execute, top, works};
use crate::toolchain::{self, TARGET};
use std::path::Path;

const IMAGE: &str = "shakedown-tape";

pub(super) fn play(work: &Work, folder: &Path) -> Result<(), Problem> {
    let program = work.release("shakedown-tape").display().to_string();
    read(command(&[&program, "play", "tape", "answers"]).current_dir(folder)).map(drop)
}

/// What plays a tape here, and tells what a sample costs.
pub(super) fn build() -> Result<(), Problem> {
    execute(&mut command(&["cargo", "build", "--locked", "--release", "--package", IMAGE]))
}

/// What a sample of a run costs in Rust, ns.
pub(super) fn cost(work: &Work) -> Result<f64, Problem> {
    let said = read(&mut command(&[&work.release(IMAGE).display().to_string(), "cost"]))?;
    said.trim().parse().map_err(|_| Problem::Failed(format!("the cost in Rust is no number: {said}")))
}

/// The image that plays a tape by semihosting.
pub(super) fn build_image(_: &Work) -> Result<(), Problem> {
    let none = format!("no compiler for {TARGET}: run `cargo xtask setup`");
    let found = toolchain::find().ok_or(Problem::Failed(none))?;
    let words = ["rustc", "--locked", "--profile", "firmware", "--package", IMAGE, "--bin", IMAGE];
    execute(found.cargo(&words)?.env("RUSTFLAGS", "-C link-arg=-Tlink.x"))
}

/// Other firmware in Rust: the loops run on this machine, the image of Embassy's built.
pub(super) fn examples(work: &Work) -> Result<(), Problem> {
    let at = |name: &str, words: &[&str]| {
        let mut cargo = command(&[&["cargo"], words].concat());
        // In its own folder, whose configuration links the image.
        cargo.current_dir(top().join("examples").join(name)).env("CARGO_TARGET_DIR", work.folder.join("examples"));
        execute(&mut cargo)
    };
    at("stepper-table", &["test", "--locked"])?;
    at("embassy", &["test", "--locked", "--lib"])?;
    at("embassy", &["build", "--locked", "--release", "--target", TARGET])
}

pub(super) fn play_image(work: &Work, folder: &Path) -> Result<(), Problem> {
    if !works(&["qemu-system-arm", "--version"]) {
        return Err(Problem::Failed("qemu-system-arm is not here: run `cargo xtask setup`".into()));
    }
    let machine = ["qemu-system-arm", "-machine", "netduinoplus2", "-nographic", "-monitor", "none", "-serial", "none"];
    let mut qemu = command(&machine);
    qemu.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    let image = work.target.join(TARGET).join("firmware").join(IMAGE);
    read(qemu.arg(image).stdin(std::process::Stdio::null()).current_dir(folder)).map(drop)
}
