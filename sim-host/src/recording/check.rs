//! Doubt the data first: what is wrong with the recordings themselves, before any physics is looked for.
//!
//! Each check is one file and looks for one kind of fault; all take whole runs in SI. A finding that makes the data
//! unfit to judge a model is [`Severity::BadData`]; one that a user should know of, but that a model of the sensors
//! could also explain (a lag, a gain of some ten per cent, hum), is a [`Severity::Remark`]: that is physics for the
//! diagnosis to name, never a reason to send the data back.

use super::Baseline;
use super::channel::{Channel, PerChannel};
use super::experiment::{ChannelSource, Experiment};
use super::run::Run;
use serde::Serialize;

mod clipped;
mod consistency;
mod hum;
mod missing;
mod quantisation;
mod replay;
mod short;
mod skew;
mod still;
mod stuck;
mod ticks;
mod timing;

pub(crate) use clipped::stretches as clipped_stretches;
pub(crate) use consistency::relation;
pub(in crate::recording) use consistency::{Bin, delay_over, spectra_of};
pub(crate) use hum::{fold, mains_line, mains_lines};
pub(crate) use missing::{BRIDGED, longest as longest_stretch, stretches};
pub(crate) use replay::fitted_gains;
pub use skew::Skew;
pub(crate) use ticks::Ticks;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Worth knowing; the verdict is not touched.
    Remark,
    /// The data cannot judge a model until this is put right.
    BadData,
}

/// What kind of fault it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Fault {
    /// The stated unit is not the recorded one.
    WrongUnit,
    /// The sign is turned round.
    Inverted,
    /// Two columns have changed places.
    Swapped,
    /// Channels that must belong together do not.
    Unrelated,
    /// Too few samples to fit anything to.
    TooShort,
    /// Nothing moves in any channel.
    Still,
    /// One value is repeated while the table moves.
    Stuck,
    /// The signal is cut at the end of a range.
    Clipped,
    /// Time stamps repeat or run backwards.
    RepeatedTime,
    /// Time stamps scatter.
    JitteringTime,
    /// A stretch has no samples.
    MissingStretch,
    /// Mains hum, or its alias.
    Hum,
    /// The steps of the converter are large against the signal.
    CoarseSteps,
    /// The stated controller does not produce the recorded command.
    WrongController,
    /// The recorded command holds something that the controller did not send.
    MissingInput,
    /// The command is at a limit that the stated controller does not have.
    LimitedCommand,
    /// One channel comes later than another.
    Skew,
}

/// One thing that is wrong, or worth knowing, in the recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The run's name.
    pub run: String,
    /// The channel's name in the experiment.
    pub channel: &'static str,
    /// What kind of fault it is.
    pub fault: Fault,
    /// What is wrong, in words, with the figures it rests on.
    pub problem: String,
    /// Where it starts, s by the file's clock.
    pub from_s: f64,
    /// Where it ends, s.
    pub to_s: f64,
    /// What to do.
    pub remedy: String,
    /// How much it matters.
    pub severity: Severity,
}

impl Finding {
    /// A finding over the whole run.
    fn whole(run: &Run, channel: Channel, fault: Fault, severity: Severity) -> Self {
        let from_s = run.time.first().copied().unwrap_or(0.0);
        let to_s = run.time.last().copied().unwrap_or(0.0);
        let (problem, remedy) = (String::new(), String::new());
        Self { run: run.name.clone(), channel: channel.name(), fault, problem, from_s, to_s, remedy, severity }
    }

    /// The same finding, between two samples.
    fn between(self, run: &Run, from: usize, to: usize) -> Self {
        let at = |k: usize| run.time.get(k.min(run.len().saturating_sub(1))).copied().unwrap_or(0.0);
        Self { from_s: at(from), to_s: at(to), ..self }
    }

    fn saying(self, problem: String, remedy: impl Into<String>) -> Self {
        Self { problem, remedy: remedy.into(), ..self }
    }
}

/// Checks every run of an experiment; the gravest findings come first.
pub fn check(experiment: &Experiment) -> Vec<Finding> {
    let mut findings: Vec<Finding> = experiment
        .runs
        .iter()
        .flat_map(|run| check_run(run, &experiment.sources, &experiment.model.baseline))
        .collect();
    findings.extend(short::check(&experiment.runs));
    findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    findings
}

/// True where a finding makes the data unfit to judge a model.
pub fn is_bad_data(findings: &[Finding]) -> bool {
    findings.iter().any(|f| f.severity == Severity::BadData)
}

fn check_run(run: &Run, sources: &PerChannel<ChannelSource>, baseline: &Baseline) -> Vec<Finding> {
    let mut findings = timing::check(run);
    let missing = missing::check(run);
    let gaps = missing.iter().any(|f| f.severity == Severity::BadData);
    findings.extend(missing);
    if let Some(still) = still::check(run) {
        findings.push(still);
        return findings;
    }
    let clipped = clipped::check(run);
    let mut stuck = stuck::check(run);
    // A signal cut off repeats its extreme, which is the same fault seen twice.
    stuck.retain(|s| clipped.iter().all(|c| c.channel != s.channel));
    // A dead or cut channel agrees with nothing; what it disagrees with says no more. Nor does one with holes.
    if !gaps && !stuck.iter().chain(&clipped).any(|f| f.severity == Severity::BadData) {
        let consistency = consistency::check(run, sources, baseline);
        if consistency.is_empty() {
            findings.extend(replay::check(run));
            findings.extend(skew::check(run));
        }
        findings.extend(consistency);
    }
    findings.extend(stuck);
    findings.extend(clipped);
    findings.extend(hum::check(run));
    findings.extend(quantisation::check(run));
    findings
}

#[cfg(test)]
mod tests;
