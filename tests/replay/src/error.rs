//! Why an image did not run, or not to its end.

use std::path::PathBuf;

/// Why an image did not run, or not to its end.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The file is no image of this processor.
    #[error("{}: {reason}; build one with `cargo xtask firmware`", path.display())]
    Image {
        /// The file.
        path: PathBuf,
        /// What the emulator says of it.
        reason: String,
    },
    /// The emulator gave up.
    #[error("the emulator stopped: {0}")]
    Emulator(String),
    /// The firmware never started its sampling timer.
    #[error("the firmware did not start its sampling timer (TIM2) within {0} ms")]
    NoTick(u64),
}
