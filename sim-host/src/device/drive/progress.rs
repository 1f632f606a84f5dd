//! How far a run is, and why it ended early.

use shakedown_core::link::{RefusedBecause, StopCause, VERSION};

/// Why a run ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// Nothing answers.
    #[error("the device does not answer {0}; check port, cable and power")]
    Silent(&'static str),
    /// The device speaks another version.
    #[error("the device speaks version {theirs} of the link, this tool version {VERSION}; flash the matching firmware")]
    Version {
        /// The device's version.
        theirs: u8,
    },
    /// The device refused a request.
    #[error("the device refuses {request}: {because:?}")]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Why not.
        because: RefusedBecause,
    },
    /// The device tripped, stopped by itself, or does not arm.
    #[error("the device stopped the run at tick {tick}: {cause:?}")]
    Stopped {
        /// Why.
        cause: StopCause,
        /// When.
        tick: u32,
    },
}

/// How far a run is.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// Under way; so many points sent, or so many ms of a test that is attended.
    Going(u32),
    /// Over, at rest.
    Done,
    /// Ended early.
    Failed(DriveError),
}
