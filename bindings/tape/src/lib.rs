//! The tape: a minute of samples at 1 kHz that takes the controller through every mode and law, with trips, resets, settings
//! exchanged and refused, readings lost, numbers that are none, and subnormal ones.
//!
//! It is written by this crate and kept nowhere: the same code gives the same bytes on every host with IEEE 754 arithmetic.
//! The samples are what a table of four operations shows under the core's own commands; they are then fixed, so that a host
//! that computes otherwise is heard of at the first differing answer. The format is that of [`shakedown_core::host`].
#![cfg_attr(target_os = "none", no_std)]

#[cfg(not(target_os = "none"))]
pub mod passages;
#[cfg(not(target_os = "none"))]
mod table;
#[cfg(not(target_os = "none"))]
mod write;

#[cfg(not(target_os = "none"))]
pub use write::{TICKS, play, records, write};

/// Longest content of a record, byte.
pub const LONGEST: usize = 2048;
