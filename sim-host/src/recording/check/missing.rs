//! Stretches without samples: rows left out of the file, or NaN in a channel.

use super::{Fault, Finding, Severity};
use crate::recording::channel::Channel;
use crate::recording::run::Run;

/// A gap is bridged, its samples not being judged, up to this length, s: longer than that the reference in between is a guess.
pub(crate) const BRIDGED: f64 = 0.15;
/// A gap of fewer samples is a dropped sample, which a recording may have.
const STRETCH: usize = 10;

/// More dropped samples than this part of a run are too many, however short each gap is.
const MANY: f64 = 0.05;

/// The same of one channel alone: what is missing of it is not judged.
const MANY_OF_ONE: f64 = 0.15;

/// The same of a sensor that neither drives a simulation nor closes its loop, however long its gaps are: nothing is bridged.
const MANY_OF_A_WITNESS: f64 = 0.5;

/// Sensors that are compared and nothing else.
const WITNESSES: [Channel; 4] =
    [Channel::Acceleration, Channel::PressureDifference, Channel::SupplyPressure, Channel::SpecimenAcceleration];

/// Looks for stretches of NaN in every channel; one stretch in all channels is one finding, about time.
pub(super) fn check(run: &Run) -> Vec<Finding> {
    let channels: Vec<Channel> = run.channels.iter().map(|(c, _)| c).collect();
    let everywhere: Vec<bool> =
        (0..run.len()).map(|k| run.channels.iter().all(|(_, samples)| !samples[k].is_finite())).collect();
    let mut findings: Vec<Finding> = finding(run, Channel::Time, &everywhere).into_iter().collect();
    for channel in channels {
        let Some(samples) = run.channel(channel) else { continue };
        let missing: Vec<bool> = samples.iter().zip(&everywhere).map(|(x, all)| !x.is_finite() && !all).collect();
        findings.extend(finding(run, channel, &missing));
    }
    findings
}

fn finding(run: &Run, channel: Channel, missing: &[bool]) -> Option<Finding> {
    let total = missing.iter().filter(|m| **m).count();
    if total == 0 {
        return None;
    }
    let (from, length) = longest(missing);
    let witness = WITNESSES.contains(&channel);
    // What a simulated loop makes itself is compared where it was recorded, and nothing is bridged.
    let made =
        matches!(channel, Channel::Displacement | Channel::Velocity | Channel::Command) && run.simulates_its_loop();
    let many = match channel {
        Channel::Time => MANY,
        _ if witness => MANY_OF_A_WITNESS,
        _ => MANY_OF_ONE,
    };
    let gap = !witness && !made && length as f64 * run.dt > BRIDGED && length >= STRETCH;
    let bad = gap || total as f64 > many * run.len() as f64;
    let severity = if bad { Severity::BadData } else { Severity::Remark };
    let finding = Finding::whole(run, channel, Fault::MissingStretch, severity).between(run, from, from + length);
    let bridged = if witness || made { String::new() } else { format!("stretches up to {BRIDGED} s and ") };
    let problem = format!(
        "{total} of {} samples are missing, the longest stretch {length} samples ({:.3} s); {bridged}{:.0} % of the samples are \
         allowed",
        run.len(),
        length as f64 * run.dt,
        100.0 * many,
    );
    let remedy = if !bad {
        "nothing to do: they are not judged"
    } else if total == run.len() {
        "name the column that holds this channel, or leave the channel out of the experiment"
    } else {
        "record again, or use only the part before or after with `from_s` and `to_s`"
    };
    Some(finding.saying(problem, remedy))
}

/// Start and length of the longest stretch that is true; no length where none is.
pub(crate) fn longest(flags: &[bool]) -> (usize, usize) {
    stretches(flags).into_iter().max_by_key(|s| s.1).unwrap_or((0, 0))
}

/// Start and length of every stretch that is true.
pub(crate) fn stretches(flags: &[bool]) -> Vec<(usize, usize)> {
    let (mut stretches, mut start) = (Vec::new(), None);
    for (k, &flag) in flags.iter().chain([&false]).enumerate() {
        match (flag, start) {
            (true, None) => start = Some(k),
            (false, Some(from)) => {
                stretches.push((from, k - from));
                start = None;
            }
            _ => {}
        }
    }
    stretches
}
