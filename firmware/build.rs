//! Hands the workspace's one memory map to the linker, and relinks when it changes. Every image uses this file: the linker
//! looks at the top of the workspace first, so no image could bring a map of its own.
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let package = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let map = package.ancestors().map(|folder| folder.join("memory.x")).find(|map| map.exists());
    let map = map.unwrap_or_else(|| Path::new("memory.x").to_owned());
    println!("cargo:rerun-if-changed={}", map.display());
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = fs::copy(&map, out.join("memory.x"));
    assert!(written.is_ok(), "copying {}: {written:?}", map.display());
    println!("cargo:rustc-link-search={}", out.display());
}
