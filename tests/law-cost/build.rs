//! Hands the workspace's one memory map to the linker, and relinks when it changes.
use std::{env, fs, path::PathBuf};

fn main() {
    let map = "../../memory.x";
    println!("cargo:rerun-if-changed={map}");
    println!("cargo:rerun-if-changed=build.rs");
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = fs::copy(map, out.join("memory.x"));
    assert!(written.is_ok(), "copying {map}: {written:?}");
    println!("cargo:rustc-link-search={}", out.display());
}
