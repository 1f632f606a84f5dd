//! Experiments and the recordings they name: reading, channels, quality checks.
//!
//! [`Experiment::load`] reads the TOML of docs/formats.md and every file it names, and gives typed runs in SI on an even
//! time grid. Nothing is guessed: what is not as stated is an error that names the file, the place and the remedy.
//!
//! ```
//! use shakedown::blocks::closed_loop::sweep_recording::write;
//! use shakedown::blocks::plant::paper::Paper;
//! use shakedown::recording::{Experiment, check, is_bad_data};
//!
//! let folder = tempfile::tempdir()?;
//! let experiment = Experiment::load(&write(folder.path(), Paper::default(), 1)?)?;
//! assert_eq!(experiment.runs.len(), 4);
//! assert!((experiment.runs[0].dt - 0.002).abs() < 1e-12);
//! assert!(!is_bad_data(&check(&experiment)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod binary;
pub(crate) mod bridge;
pub(crate) mod channel;
pub(crate) mod check;
pub(crate) mod clock;
mod copies;
pub(crate) mod csv;
pub(crate) mod described;
mod document;
pub(crate) mod doubt;
pub(crate) mod error;
pub(crate) mod excerpt;
pub(crate) mod experiment;
pub mod file;
pub(crate) mod holdout;
pub(crate) mod inner_loop;
pub(crate) mod lag;
pub(crate) mod law;
pub(crate) mod mat;
pub(crate) mod model;
pub(crate) mod noise;
pub(crate) mod own_effect;
pub(crate) mod propose;
pub(crate) mod run;
pub(crate) mod signal;
pub(crate) mod steps;
pub(crate) mod table;
pub(crate) mod unit;

pub use channel::{Channel, PerChannel};
pub use check::{Fault, Finding, Severity, Skew, check, is_bad_data};
pub use described::Described;
pub(crate) use doubt::without_clipped;
pub use doubt::{Doubt, SetUp, SetUpFinding, doubt};
pub use error::{Place, Problem, RecordingError};
pub use excerpt::excerpt;
pub use experiment::Experiment;
pub(crate) use law::GainFactors;
pub use law::{RecordedLaw, Shaping};
pub use model::{Accuracy, Baseline, ForceBalance, Model, RigidMass, Servo, StatedEffect};
pub use propose::{Choice, Facts, Loop, Proposal, ProposeError, propose};
pub use run::{Run, Use};

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    /// A file of the development data, or `None`, said plainly, where it is not at hand.
    pub(crate) fn data(name: &str) -> Option<PathBuf> {
        let folder = std::env::var("SHAKEDOWN_DATA").unwrap_or_else(|_| "../../shared/data".into());
        let path = Path::new(&folder).join(name);
        if path.exists() {
            return Some(path);
        }
        crate::skipped::without(&path);
        None
    }
}
