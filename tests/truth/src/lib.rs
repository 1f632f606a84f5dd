//! An independent plant that makes concealed cases; shares no code with the diagnosis it examines.
//!
//! [`cases`] deals experiments by seed: each writes a folder with `experiment.toml` and one CSV file a run, and carries a
//! sealed answer that [`Sealed::open_after`] gives only once an examinee's own answer lies on the disk.

pub mod baseline;
pub mod closed_loop;
pub mod excitation;
pub mod noise;
pub mod ode;
pub mod plant;
pub mod refit;
pub mod rng;
