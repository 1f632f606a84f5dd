//! From recordings to a model with error bars.
//!
//! ```
//! use shakedown::blocks::closed_loop::sweep_recording::write;
//! use shakedown::identify::identify;
//! use shakedown::blocks::plant::paper::Paper;
//! use shakedown::recording::Experiment;
//!
//! // Sweeps of the simulated table, with the noise of a laboratory's sensors and starting values that are off.
//! let folder = tempfile::tempdir()?;
//! let found = identify(&Experiment::load(&write(folder.path(), Paper::default(), 1)?)?)?;
//! let limit = &found.quantities["velocity_limit"];
//! assert!((limit.value / 0.242 - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `data` holds runs as a fit sees them, `model` a model with the effects it has, `evaluate` the residuals and
//! their sensitivities to every free parameter, `fit` bounded Levenberg-Marquardt on them, `starts` from several
//! places, `interval` how far each parameter can be moved; `judge` scores the outcome on hold-out runs; `spectra`
//! compares both sides by frequency; `frequency` estimates frequency responses and fits transfer functions to them; `transfer`
//! does so from command to motion, its order chosen by what was held out.

pub(crate) mod answer;
pub(crate) mod change;
mod covariance;
pub(crate) mod data;
pub(crate) mod evaluate;
pub(crate) mod fit;
mod floor;
pub(crate) mod frequency;
pub(crate) mod interval;
pub(crate) mod judge;
pub(crate) mod model;
mod normal;
pub(crate) mod outcome;
pub(crate) mod prepare;
pub(crate) mod quantity;
pub(crate) mod signal_scales;
pub(crate) mod spectra;
pub(crate) mod starts;
pub(crate) mod stated;
pub(crate) mod transfer;

pub use answer::value as answer;
pub use change::{Change, CompareError, compare};
pub use outcome::{Identified, IdentifyError, identify};
pub use prepare::PrepareError;
pub use quantity::Quantity;
