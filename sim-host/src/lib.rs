//! Host side of shakedown: plant models, ground motions, recordings, identification and diagnosis of hydraulic shake
//! tables, around the same control core that the firmware runs.

pub mod closed_loop;
pub mod device;
pub mod diagnose;
pub mod digits;
pub mod faults;
pub mod files;
pub mod identify;
#[cfg(all(feature = "cli", not(target_family = "wasm")))]
pub mod live;
pub mod motion;
pub mod plant;
#[cfg(feature = "cli")]
pub mod prove;
pub mod recording;
pub mod report;
pub mod scalar;

#[cfg(test)]
#[path = "../tests/support/skipped.rs"]
mod skipped;
