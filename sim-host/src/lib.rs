//! Host side of shakedown: plant models, ground motions, recordings, identification and diagnosis of hydraulic shake
//! tables, around the same control core that the firmware runs.
//!
//! | door | from | to |
//! |---|---|---|
//! | [`recording`] | files of an experiment | checked runs in SI beside a stated model |
//! | [`identify`] | an experiment | the model's parameters with intervals |
//! | [`diagnose`] | an experiment | the physics that the model lacks |
//! | [`simulate`] | a table, a controller, a motion | the motion that the table makes of it |
//! | [`fit`] | a ground motion and a table's limits | the nearest motion that the table can follow |
//!
//! ```
//! use shakedown::fit::{Recipe, generate::FAR_FIELD};
//! use shakedown::simulate::{Named, ScoredSignal, Setup};
//!
//! // A record that the paper's table can follow, played by the controller that was in use and by a stronger one.
//! let record = FAR_FIELD.generate(1)?;
//! let motion = Recipe::table1(1000.0).apply(&record)?;
//! let error = |named| Ok::<_, shakedown::simulate::TrialError>(
//!     Setup::paper(named).play(&motion)?.scores(ScoredSignal::Truly, None)?.against_wanted.e_a.ratio,
//! );
//! assert!(error(Named::Strong)? < error(Named::Current)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`blocks`] are the parts one by one, for benchmarks and tools of one's own: the link to a device, the pages, the campaigns that
//! examine guard and diagnosis among them. The rest is private.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports, reason = "the command line alone uses some"))]

pub mod blocks;
#[cfg(feature = "cli")]
pub mod cli;
mod closed_loop;
mod device;
pub mod diagnose;
mod digits;
mod faults;
mod files;
pub mod fit;
pub mod identify;
#[cfg(all(feature = "cli", not(target_family = "wasm")))]
mod live;
mod motion;
mod plant;
#[cfg(feature = "cli")]
mod prove;
pub mod recording;
mod report;
mod scalar;
pub mod simulate;

#[cfg(test)]
#[path = "../tests/support/skipped.rs"]
mod skipped;
