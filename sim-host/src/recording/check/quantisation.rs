//! Steps of a converter that are large against the signal.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use crate::recording::signal::deviation;
use crate::recording::steps::quantisation_step;

/// A step above this part of the signal's RMS is coarse.
const COARSE: f64 = 0.05;

/// Looks at every sensor's step.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    run.channels.iter().filter_map(|(channel, samples)| finding(run, channel, samples)).collect()
}

fn finding(run: &Run, channel: Channel, samples: &[f64]) -> Option<Finding> {
    if matches!(channel, Channel::Reference | Channel::Command | Channel::Disturbance) {
        return None;
    }
    let (step, size) = (quantisation_step(samples)?, deviation(samples));
    if size <= 0.0 || step < COARSE * size {
        return None;
    }
    Some(Finding::whole(run, channel, Fault::CoarseSteps, Severity::Remark).saying(
        format!("{channel} moves in steps of {step:.3e} (SI), {:.0} % of its RMS", 100.0 * step / size),
        format!("use a finer range of {channel}, or a larger motion"),
    ))
}
