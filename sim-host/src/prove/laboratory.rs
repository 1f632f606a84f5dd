//! What the cases of examiner 2 are scored by, and a campaign of them summed up.

pub mod calibrate;
mod calibration;
mod gates;
pub mod independence;
pub mod outcome;
pub mod page;
mod place;
mod set_up;
mod strata;
pub mod summary;
#[cfg(test)]
mod tests;

pub use summary::{Summary, summarise};
