//! The compiler for the firmware's target: rustup's where it can be had, else Debian's with its own standard library.

use crate::setup::apt;
use crate::shell::{Problem, command, read, run, works};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The firmware's target: Cortex-M4 with its floating-point unit.
pub(crate) const TARGET: &str = "thumbv7em-none-eabihf";
/// Debian's compiler, recent enough for this workspace.
const DEBIAN: &str = "/usr/bin/rustc";

/// How the firmware is compiled on this machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Toolchain {
    /// The target's standard library came by rustup.
    Rustup,
    /// Debian's `rustc-web` compiles `core` from `rust-web-src`.
    Debian,
}

/// What this machine has, if anything.
pub(crate) fn find() -> Option<Toolchain> {
    let libraries = read(&mut command(&["rustc", "--print", "target-libdir", "--target", TARGET]));
    if libraries.is_ok_and(|folder| Path::new(folder.trim()).is_dir()) {
        return Some(Toolchain::Rustup);
    }
    (works(&["dpkg", "-s", "rustc-web"]) && works(&["dpkg", "-s", "rust-web-src"])).then_some(Toolchain::Debian)
}

/// Gets the target from rustup, or else Debian's compiler.
pub(crate) fn install() -> Result<(), Problem> {
    run(&mut command(&["rustup", "target", "add", TARGET])).or_else(|_| apt(&["rustc-web", "rust-web-src"]))
}

impl Toolchain {
    /// `cargo` with `words`, compiling for the firmware's target.
    pub(crate) fn cargo(self, words: &[&str]) -> Result<Command, Problem> {
        let mut cargo = command(&[&["cargo"], words, &["--target", TARGET]].concat());
        if self == Self::Debian {
            let root = PathBuf::from(read(&mut command(&["rustc", "--print", "sysroot"]))?.trim());
            let linker = root.join("lib/rustlib/x86_64-unknown-linux-gnu/bin");
            let path = std::env::var_os("PATH").unwrap_or_default();
            let paths = std::iter::once(linker).chain(std::env::split_paths(&path));
            let path = std::env::join_paths(paths).map_err(|e| Problem::Failed(e.to_string()))?;
            cargo.args(["-Z", "build-std=core"]);
            cargo.env("RUSTC_BOOTSTRAP", "1").env("RUSTC", DEBIAN).env("PATH", path);
        }
        Ok(cargo)
    }
}
