//! Ground motions: reading, conditioning, fitting to a table's limits, spectra and metrics.
//!
//! A file becomes a [`Record`] (acceleration in m/s², as the file states it, contradictions refused), conditioning makes
//! of it a [`Motion`] (displacement, velocity and acceleration that belong together), and a motion is what a table is
//! asked to follow. Units are SI throughout; conversion happens where a file or a person is read or written.

pub(crate) mod condition;
pub(crate) mod drive;
pub(crate) mod filter;
pub(crate) mod fit;
pub(crate) mod fit_area;
pub mod generate;
pub(crate) mod metrics;
pub mod qualify;
pub mod read;
mod record;
pub(crate) mod resample;
pub mod spectrum;
mod unit;
pub(crate) mod write;

pub(crate) use record::central_difference;
pub use record::{Fact, Format, Motion, Record};
pub(crate) use unit::STANDARD_GRAVITY;
pub use unit::{AccelerationUnit, UnknownUnit};

/// The largest magnitude of a signal, 0 where it is empty.
pub fn peak(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |p, x| x.abs().max(p))
}

#[cfg(test)]
mod tests;
