//! Does a motion satisfy a standard for seismic qualification? Required and test response spectra, zero-period acceleration,
//! duration and strong motion, stationarity, independence of axes.
//!
//! No standard's text was at hand: the rules are data with their edition and status ([`Standard`]), and every verdict says
//! which of them were not checked against the text. A verdict is an analysis and no certificate.

pub mod attain;
mod judge;
mod measures;
mod required;
mod rigid;
mod standard;
mod synthesise;

pub use judge::{Ordinate, QualifyError, Rule, ScoredModel, judge};
pub use required::{Required, Requirement};
pub use standard::{Code, Direction, STANDARDS, Site, Standard, StandardError};
pub use synthesise::{Shape, synthesise};

#[cfg(test)]
mod tests;
