//! Ground motions: reading, conditioning, fitting to a table's limits, spectra and metrics.
//!
//! A file becomes a [`Record`] (acceleration in m/s², as the file states it, contradictions refused), conditioning makes
//! of it a [`Motion`] (displacement, velocity and acceleration that belong together), and a motion is what a table is
//! asked to follow. Units are SI throughout; conversion happens where a file or a person is read or written.

pub mod condition;
pub mod drive;
pub mod filter;
pub mod fit;
pub mod fit_area;
pub mod generate;
pub mod metrics;
pub mod qualify;
pub mod read;
mod record;
pub mod resample;
pub mod spectrum;
mod unit;
pub mod write;

pub use record::{Fact, Format, Motion, Record, central_difference};
pub use unit::{AccelerationUnit, STANDARD_GRAVITY, UnknownUnit};

/// The largest magnitude of a signal, 0 where it is empty.
pub fn peak(signal: &[f64]) -> f64 {
    signal.iter().fold(0.0, |p, x| x.abs().max(p))
}

#[cfg(test)]
mod tests;
