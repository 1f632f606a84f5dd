//! Samples of a sensor cut off at the end of its range.
//!
//! Peaks that a range cuts off are dropped and the rest of the recording serves: the sensor closes no loop, so the samples between
//! are as good as any. Where most is cut off, the recording is bad, which the quality checks say. The displacement is left to them:
//! a loop closed over a sensor at its end is another.

use super::{Doubt, SetUpFinding};
use crate::recording::channel::Channel;
use crate::recording::check::clipped_stretches;
use crate::recording::experiment::Experiment;
use crate::recording::noise::differences;

/// Largest share of a run's samples that may be cut off.
const MOST: f64 = 0.4;

/// Share of the range from which a noise is cut off where the motion is not.
const WIDE: f64 = 0.25;

/// Drops what is cut off.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    for run in &mut experiment.runs {
        for (channel, unit) in [
            (Channel::Acceleration, "m/s2"),
            (Channel::Velocity, "m/s"),
            (Channel::PressureDifference, "unit of p"),
            (Channel::SpecimenAcceleration, "m/s2"),
        ] {
            let Some(samples) = run.channel(channel) else { continue };
            let cut = clipped_stretches(samples);
            let count: usize = cut.iter().map(|(from, to)| to - from + 1).sum();
            if cut.is_empty() || count as f64 > MOST * samples.len() as f64 {
                continue;
            }
            let range = cut.iter().map(|&(from, _)| samples[from].abs()).fold(0.0, f64::max);
            let mut kept = samples.to_vec();
            // Single samples at the extreme are cut off too.
            kept.iter_mut().filter(|x| x.abs() >= range).for_each(|x| *x = f64::NAN);
            for (from, to) in cut {
                kept[from..=to].fill(f64::NAN);
            }
            // Of a noise as wide as the range the samples that stay within are the smaller ones: what is left is no longer the motion.
            if differences(&kept).is_some_and(|noise| noise > WIDE * range) {
                run.channels.remove(channel);
            } else {
                run.channels.set(channel, kept);
            }
            findings.push(SetUpFinding::new(Doubt::Clipped, range, unit).of_run(&run.name).of_channel(channel));
        }
    }
    findings
}
