//! Too few samples for a model to be judged by.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::{Run, Use};

/// Fewest samples of all runs fitted together: with fewer, a model of a dozen parameters fits whatever there is.
const LEAST: usize = 100;

/// One finding where the runs fitted hold too few samples.
pub(super) fn check(runs: &[Run]) -> Option<Finding> {
    let fitted: Vec<&Run> = runs.iter().filter(|run| run.purpose == Use::Fit).collect();
    let samples: usize = fitted.iter().map(|run| run.len()).sum();
    let first = fitted.first().filter(|_| samples < LEAST)?;
    let problem = format!("{samples} samples are fitted, which is too short: at least {LEAST} are needed");
    let remedy = "record longer, or at a higher rate, or give more runs";
    Some(Finding::whole(first, Channel::Time, Fault::TooShort, Severity::BadData).saying(problem, remedy))
}
