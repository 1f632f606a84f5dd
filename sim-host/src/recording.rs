//! Experiments and the recordings they name: reading, channels, quality checks.
//!
//! [`Experiment::load`] reads the TOML of docs/formats.md and every file it names, and gives typed runs in SI on an even
//! time grid. Nothing is guessed: what is not as stated is an error that names the file, the place and the remedy.

pub mod channel;
pub mod check;
pub mod clock;
pub mod csv;
mod document;
pub mod doubt;
pub mod error;
pub mod experiment;
pub mod file;
pub mod holdout;
pub mod law;
pub mod mat;
pub mod model;
pub mod noise;
pub mod propose;
pub mod run;
pub mod signal;
pub mod steps;
pub mod table;
pub mod unit;

pub use channel::{Channel, PerChannel};
pub use check::{Fault, Finding, Severity, Skew, check, is_bad_data};
pub use doubt::{Doubt, SetUp, SetUpFinding, doubt};
pub use error::{Place, Problem, RecordingError};
pub use experiment::Experiment;
pub use law::Law;
pub use model::{Accuracy, Baseline, ForceBalance, Model, RigidMass, Servo, StatedEffect};
pub use run::{Run, Use};
