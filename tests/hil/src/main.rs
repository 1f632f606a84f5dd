//! Tests of the firmware's board code on the board itself, through a debug probe, and unchanged on the emulated one.
//!
//! Each prints a line with what it measured and its bound by semihosting; the program's exit status says whether all held. A wire from PA4
//! to PA1 loops the output back. The last three end in a reset by the watchdog: starved, after a panic and after a clock that failed; their results are printed after it.
//!
//! `embedded-test` asks the debugger for its command line, which the emulator does not serve: hence this plain list.
#![cfg_attr(target_os = "none", no_std, no_main)]
#![allow(unsafe_code, reason = "semihosting, and what survives a reset")]

#[cfg(target_os = "none")]
mod console;
#[cfg(target_os = "none")]
mod suite;

/// The tests run on their target only.
#[cfg(not(target_os = "none"))]
fn main() {}
