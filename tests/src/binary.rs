//! The `shakedown` binary under test, and the folder of the development data.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// Set where the binary has been built with the tests, as `cargo xtask test` does. A build of it alone has the features of
/// one package instead of the workspace's, for which Cargo compiles the library and much below it once more.
const BUILT: &str = "SHAKEDOWN_BUILT";

/// The binary, built once in the profile of the tests; a dependency's binary is not built by `cargo test`.
///
/// # Panics
/// Where it does not build.
pub fn shakedown() -> Command {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    Command::new(BINARY.get_or_init(binary))
}

#[allow(clippy::expect_used, reason = "tests run only with the binary")]
fn binary() -> PathBuf {
    let here = std::env::current_exe().expect("the test's own path");
    // target/PROFILE/deps/test
    let folder = here.parent().and_then(Path::parent).expect("the profile's folder");
    if std::env::var_os(BUILT).is_none() {
        build(folder.ends_with("release"));
    }
    folder.join(format!("shakedown{}", std::env::consts::EXE_SUFFIX))
}

#[allow(clippy::expect_used, reason = "tests run only with the binary")]
fn build(release: bool) {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--quiet", "--package", "shakedown", "--bin", "shakedown"]);
    if release {
        cargo.arg("--release");
    }
    let status = cargo.current_dir(env!("CARGO_MANIFEST_DIR")).status().expect("cargo runs");
    assert!(status.success(), "the binary does not build");
}

/// A file of the development data, or `None`, said plainly, where it is not at hand.
pub fn data(name: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SHAKEDOWN_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"), PathBuf::from);
    let path = folder.join(name);
    if path.exists() {
        return Some(path);
    }
    crate::skipped::without(&path);
    None
}
