//! The firmware image in the loop: the very ELF that is flashed runs on an emulated STM32F4, and a world of the caller's
//! is at its converters, its pins and its serial line.
//!
//! The world owns time. At every update of the firmware's sampling timer the machine stops, asks the [`World`] what the
//! inputs are, tells it what the output has been since the last update, and lets the processor run to the next. So the
//! loop is in lock step whatever either side costs, and a run repeats to the last instruction.

pub mod bench;
mod error;
pub mod f4;
pub mod seen;
pub mod size;
pub mod world;

pub use error::ReplayError;
pub use f4::{Mark, Ran, Stack, follow, marks, run, run_logged, run_with};
pub use world::{Fitted, Line, Oscillator, Tick, World};
