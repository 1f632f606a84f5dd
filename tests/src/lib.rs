//! What the tests share: the data folder, the binary under test, small helpers.

pub mod binary;
pub mod browser;
pub mod sample;
#[path = "../../sim-host/tests/support/skipped.rs"]
mod skipped;
