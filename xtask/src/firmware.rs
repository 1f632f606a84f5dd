//! The firmware image: builds it, flashes it, runs it against the plant on an emulated processor.

use std::path::{Path, PathBuf};

use object::read::elf::ElfFile32;
use object::{LittleEndian, Object as _, ObjectSection as _, SectionKind};

use crate::boards::{self, Board};
use crate::output::say;
use crate::setup::{self, QEMU};
use crate::shell::{Problem, command, no_words, run as execute, target, top, works};
use crate::toolchain::{self, TARGET, Toolchain};

/// What the linker is told; the same as in `firmware/.cargo/config.toml`, which only a build from that folder reads.
pub(crate) const LINKER: &str = "-C link-arg=-Tlink.x -C link-arg=-Tdefmt.x -C link-arg=--nmagic";
/// Where RAM begins on all of them.
const RAM: u64 = 0x2000_0000;

impl Board {
    /// The command that builds its image, without its flags.
    pub(crate) fn command(&self) -> Result<std::process::Command, Problem> {
        let (package, image) = (self.package.as_str(), self.image.as_str());
        found()?.cargo(&["build", "--locked", "--profile", "firmware", "--package", package, "--bin", image])
    }

    /// Where it is built, in the target folder `folder`.
    pub(crate) fn built(&self, folder: &Path) -> PathBuf {
        folder.join(TARGET).join("firmware").join(&self.image)
    }
}

/// The C compiler for the target.
pub(crate) const GCC: &str = "arm-none-eabi-gcc";

/// The chore: builds the image and says with what.
pub(crate) fn build(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let found = found()?;
    say(match found {
        Toolchain::Rustup => "compiler: rustup's, with its standard library for the target",
        Toolchain::Debian => "compiler: Debian's rustc-web, compiling core from rust-web-src",
    });
    let folder = target()?;
    for board in boards::all()? {
        execute(board.command()?.env("RUSTFLAGS", LINKER).current_dir(top()))?;
        let path = board.built(&folder);
        let (flash, ram) = size(&path)?;
        say(&format!("{}: {}, {flash} bytes of flash, {ram} of RAM beside the stack", board.title, path.display()));
    }
    Ok(())
}

/// Bytes that an image takes of flash, and of RAM for its variables.
fn size(path: &Path) -> Result<(u64, u64), Problem> {
    let failed = |e: String| Problem::Failed(format!("{}: {e}", path.display()));
    let bytes = std::fs::read(path).map_err(|e| failed(e.to_string()))?;
    let file = ElfFile32::<LittleEndian>::parse(bytes.as_slice()).map_err(|e| failed(e.to_string()))?;
    // What is not there at run time has no address.
    Ok(file.sections().filter(|section| section.address() > 0).fold((0, 0), |(flash, ram), section| {
        let stored = section.kind() != SectionKind::UninitializedData;
        let variable = section.address() >= RAM;
        (flash + if stored { section.size() } else { 0 }, ram + if variable { section.size() } else { 0 })
    }))
}

/// The chore: builds the image and writes it to the board through a debug probe.
pub(crate) fn flash(words: &[String]) -> Result<(), Problem> {
    build(words)?;
    if !works(&["probe-rs", "--version"]) {
        return Err(Problem::Failed("probe-rs is not here: `cargo install probe-rs-tools --locked`".into()));
    }
    let board = boards::default()?;
    let image = board.built(&target()?).display().to_string();
    execute(&mut command(&["probe-rs", "run", "--chip", &board.chip, &image]))
}

/// Builds everything that the tests of the image in the loop run.
pub(crate) fn images() -> Result<(), Problem> {
    build(&[])?;
    no_panic()?;
    bare("shakedown-second-opinion", &[])?;
    image("shakedown-hil")?;
    beside_image()
}

/// The chore: the image in the loop, all tests or those named.
pub(crate) fn replay(words: &[String]) -> Result<(), Problem> {
    // Named, or installed, before anything is built: a test that finds its tool missing says so much later and less plainly.
    setup::need(&[TARGET, QEMU, GCC])?;
    images()?;
    execute(&mut command(&["cargo", "test", "--locked", "--package", "shakedown-firmware", "--lib"]))?;
    execute(&mut command(&["cargo", "build", "--locked", "--package", "shakedown", "--bin", "shakedown"]))?;
    test(words, &[])
}

/// The chore: what the core's laws cost beside the same laws in C and `idsp`'s.
pub(crate) fn beside(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    beside_image()?;
    test(&["beside".into()], &["--nocapture"])
}

/// Where the tests of the image are, a file for each name.
const TESTS: &str = "tests/replay/tests";

/// Runs tests of the image, all or those named.
pub(crate) fn test(names: &[String], more: &[&str]) -> Result<(), Problem> {
    // A file is a module of its binary: a name that none has would match nothing, and pass.
    if let Some(unknown) = names.iter().find(|name| !top().join(TESTS).join(format!("{name}.rs")).exists()) {
        return Err(Problem::Usage(format!("there is no `{unknown}` among the files of {TESTS}")));
    }
    let modules: Vec<String> = names.iter().map(|name| format!("{name}::")).collect();
    // The emulator states a newer compiler than it needs.
    let line = "cargo test --tests --locked --no-fail-fast --ignore-rust-version --package shakedown-replay --";
    let words: Vec<&str> = line.split(' ').collect();
    execute(command(&words).args(modules).args(more))
}

/// The image with the core's laws, `idsp`'s, and where there is a C compiler for the target the same laws in C.
fn beside_image() -> Result<(), Problem> {
    if !works(&[GCC, "--version"]) {
        say(&format!("SKIPPED: the laws in C: no {GCC} here; `cargo xtask setup` installs it"));
        return bare("shakedown-beside", &[]);
    }
    let object = target()?.join("laws.o");
    let to = object.display().to_string();
    let flags = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-O2", "-ffp-contract=off"];
    execute(&mut command(&[&[GCC], flags.as_slice(), &["-c", "tests/beside/src/laws.c", "-o", &to]].concat()))?;
    bare("shakedown-beside", &["--features", "c", "--", "-C", &format!("link-arg={to}")])
}

/// Builds an image without the firmware around it.
fn bare(package: &str, more: &[&str]) -> Result<(), Problem> {
    execute(&mut bare_command(package, more)?)
}

fn bare_command(package: &str, more: &[&str]) -> Result<std::process::Command, Problem> {
    let (features, link) = more.split_at(more.iter().position(|&word| word == "--").unwrap_or(more.len()));
    let words = ["rustc", "--locked", "--profile", "firmware", "--package", package];
    let mut cargo = found()?.cargo(&[&words, features].concat())?;
    cargo.args(link).env("RUSTFLAGS", "-C link-arg=-Tlink.x");
    Ok(cargo)
}

/// Links the core's step alone under a panic handler that calls a function that is nowhere: that it links shows that no
/// panic is left in it. With an index out of range planted, it must not link.
pub(crate) fn no_panic() -> Result<(), Problem> {
    let package = "shakedown-no-panic";
    bare(package, &[])?;
    let planted = bare_command(package, &["--features", "planted"])?.output();
    let planted = planted.map_err(|e| Problem::Failed(e.to_string()))?;
    let said = String::from_utf8_lossy(&planted.stderr);
    if planted.status.success() || !said.contains("a_panic_is_left_in_step") {
        return Err(Problem::Failed(format!("a planted panic was not found by the linker: {said}")));
    }
    say("no panic is left in Controller::step, and a planted one is found");
    Ok(())
}

fn found() -> Result<Toolchain, Problem> {
    let why = "no compiler for the firmware's target: run `cargo xtask setup`";
    toolchain::find().ok_or_else(|| Problem::Failed(why.into()))
}

/// The command that builds an image, without its flags.
pub(crate) fn image_command(package: &str) -> Result<std::process::Command, Problem> {
    found()?.cargo(&["build", "--locked", "--profile", "firmware", "--package", package])
}

/// Where the image `name` of a package without a board's manifest is built.
pub(crate) fn image_path(name: &str) -> Result<PathBuf, Problem> {
    Ok(target()?.join(TARGET).join("firmware").join(name))
}

/// Builds an image that logs.
pub(crate) fn image(package: &str) -> Result<(), Problem> {
    execute(image_command(package)?.env("RUSTFLAGS", LINKER).current_dir(top()))
}
