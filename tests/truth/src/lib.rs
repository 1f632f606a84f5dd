//! An independent plant that makes concealed cases; shares no code with the diagnosis it examines.
//!
//! [`cases`] deals experiments by seed: each writes a folder with `experiment.toml` and one CSV file a run, and carries a
//! sealed answer that [`answer::Sealed::open_after`] gives only once an examinee's own answer lies on the disk.

pub mod answer;
pub mod baseline;
mod case;
pub mod closed_loop;
pub mod confounded;
pub mod corrupt;
pub mod effect;
pub mod excitation;
pub mod lab;
pub mod noise;
pub mod ode;
pub mod plan;
pub mod plant;
pub mod refit;
pub mod rng;
pub mod scene;
pub mod sheet;
pub mod strength;
pub mod unlisted;

pub use case::{Case, case, cases};
