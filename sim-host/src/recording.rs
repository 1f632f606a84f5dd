//! Experiments and the recordings they name: reading, channels, quality checks.
//!
//! [`Experiment::load`] reads the TOML of docs/formats.md and every file it names, and gives typed runs in SI on an even
//! time grid. Nothing is guessed: what is not as stated is an error that names the file, the place and the remedy.

pub mod binary;
pub(crate) mod bridge;
pub mod channel;
pub mod check;
pub mod clock;
mod copies;
pub mod csv;
pub mod described;
mod document;
pub mod doubt;
pub mod error;
pub mod excerpt;
pub mod experiment;
pub mod file;
pub mod holdout;
pub mod inner_loop;
pub mod law;
pub mod mat;
pub mod model;
pub mod noise;
pub mod own_effect;
pub mod propose;
pub mod run;
pub mod signal;
pub mod steps;
pub mod table;
pub mod unit;

pub use channel::{Channel, PerChannel};
pub use check::{Fault, Finding, Severity, Skew, check, is_bad_data};
pub use described::Described;
pub(crate) use doubt::without_clipped;
pub use doubt::{Doubt, SetUp, SetUpFinding, doubt};
pub use error::{Place, Problem, RecordingError};
pub use excerpt::excerpt;
pub use experiment::Experiment;
pub use law::{Law, Shaping};
pub use model::{Accuracy, Baseline, ForceBalance, Model, RigidMass, Servo, StatedEffect};
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
