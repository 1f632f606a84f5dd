//! The memory map of QEMU's `mps2-an386`: code from 0, static memory from 0x2000_0000, 4 MiB each.
use std::path::PathBuf;
use std::{env, fs};

const MAP: &str = "MEMORY { FLASH : ORIGIN = 0, LENGTH = 4M  RAM : ORIGIN = 0x20000000, LENGTH = 4M }\n";

fn main() {
    if env::var("CARGO_CFG_TARGET_OS").as_deref() != Ok("none") {
        return;
    }
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let written = fs::write(out.join("memory.x"), MAP);
    assert!(written.is_ok(), "writing memory.x: {written:?}");
    println!("cargo:rustc-link-search={}", out.display());
}
