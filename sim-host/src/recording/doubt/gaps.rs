//! Gaps too long to be bridged: a run is cut there, and what lies on either side serves as runs of their own.
//!
//! A simulation in closed loop needs the reference all the time. A gap is bridged where bridges over known samples beside it err by
//! no more than twice the noise of the displacement; a longer one would be a guess. A run that is cut starts in motion, with the
//! states and the controller's integral estimated anew.

use super::{Doubt, SetUpFinding};
use crate::recording::bridge::bridging_error;
use crate::recording::channel::Channel;
use crate::recording::check::{BRIDGED, stretches};
use crate::recording::experiment::Experiment;
use crate::recording::noise::differences;
use crate::recording::run::Run;

/// Standard deviations of the displacement's noise that a bridge may be off by.
const ERRS: f64 = 2.0;
/// Shortest piece that is kept, s: its start alone takes parameters of its own.
const SHORTEST: f64 = 4.0;
/// Share of a run that its pieces must hold between them, or nothing is cut.
const KEPT: f64 = 0.5;

/// Cuts every run at its long gaps.
pub(super) fn doubt(experiment: &mut Experiment) -> Vec<SetUpFinding> {
    let mut findings = Vec::new();
    let mut runs = Vec::with_capacity(experiment.runs.len());
    for run in experiment.runs.drain(..) {
        let (pieces, gaps) = pieces(&run);
        if gaps.is_empty() || pieces.iter().map(Run::len).sum::<usize>() < (KEPT * run.len() as f64) as usize {
            runs.push(run);
            continue;
        }
        let longest = gaps.into_iter().max().unwrap_or(0) as f64 * run.dt;
        findings.push(SetUpFinding::new(Doubt::LostRows, longest, "s").of_run(&run.name));
        runs.extend(pieces);
    }
    experiment.runs = runs;
    findings
}

/// What the displacement's noise is said to be, or what its samples say; none where a command drives.
fn displacement_noise(run: &Run) -> Option<f64> {
    if !run.simulates_its_loop() {
        return None;
    }
    let stated = run.noise.get(Channel::Displacement).copied();
    stated.or_else(|| run.channel(Channel::Displacement).and_then(differences)).filter(|noise| *noise > 0.0)
}

/// The pieces between long gaps that are worth keeping, and the gaps' lengths in samples.
fn pieces(run: &Run) -> (Vec<Run>, Vec<usize>) {
    let drive = [Channel::Reference, Channel::Command].into_iter().find_map(|channel| run.channel(channel));
    // Where no reference drives a loop, the recorded displacement is the motion.
    let motion = run.channel(Channel::Displacement).filter(|_| !run.simulates_its_loop());
    let needed: Vec<&[f64]> = drive.into_iter().chain(motion).collect();
    let nothing = |k: usize| run.channels.iter().all(|(_, samples)| !samples[k].is_finite());
    let lost = |k: usize| needed.iter().any(|samples| !samples[k].is_finite());
    let missing: Vec<bool> = (0..run.len()).map(|k| nothing(k) || lost(k)).collect();
    let noise = displacement_noise(run);
    let errs = |gap: (usize, usize)| drive.and_then(|drive| bridging_error(drive, gap, run.dt)).unwrap_or(0.0);
    let long = |&gap: &(usize, usize)| gap.1 as f64 * run.dt > BRIDGED || noise.is_some_and(|n| errs(gap) > ERRS * n);
    let gaps: Vec<(usize, usize)> = stretches(&missing).into_iter().filter(long).collect();
    let starts = std::iter::once(0).chain(gaps.iter().map(|(from, length)| from + length));
    let ends = gaps.iter().map(|(from, _)| *from).chain([run.len()]);
    let enough = |&(from, to): &(usize, usize)| to > from && (to - from) as f64 * run.dt >= SHORTEST;
    let named = |(from, to): (usize, usize)| {
        let piece = run.part(from, to);
        let seconds = |k: usize| run.time.get(k).copied().unwrap_or(0.0);
        Run { name: format!("{}, {:.1} to {:.1} s", run.name, seconds(from), seconds(to - 1)), ..piece }
    };
    let pieces = starts.zip(ends).filter(enough).map(named).collect();
    (pieces, gaps.into_iter().map(|(_, length)| length).collect())
}
