//! Which runs are held out to judge by, where the experiment does not say.
//!
//! The rule: a run's own `use` always counts. Where some runs say and others do not, the silent ones take the other
//! part: if any says `holdout`, they are fitted, else they are held out. Where none says and there are several, the
//! last quarter of them, at least one, is held out; a single run is cut, its first two thirds fitted and its last
//! third held out. Where the table has come to rest by then, the thirds are those of the way that the reference goes.

use super::channel::Channel;
use super::run::{Run, Use};
use std::fmt;

/// Least share of the reference's way that the last third must hold to judge by.
const LEAST_WAY: f64 = 0.1;

/// How it was decided which runs judge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeldBack {
    /// The experiment says so for every run.
    Stated,
    /// Some runs say; the silent ones took the other part.
    Completed,
    /// None says: the last quarter of the runs.
    LastRuns(usize),
    /// None says and there is one run: its last third.
    LastThird,
}

impl fmt::Display for HeldBack {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stated => f.write_str("held out as the experiment says"),
            Self::Completed => f.write_str("runs without `use` took the part that no other run has"),
            Self::LastRuns(1) => f.write_str("no run says `use`: the last one is held out"),
            Self::LastRuns(n) => write!(f, "no run says `use`: the last {n} are held out"),
            Self::LastThird => f.write_str("no run says `use`: the last third of the only run is held out"),
        }
    }
}

/// Gives every run its use, cutting a single run in two.
pub(crate) fn assign(runs: Vec<(Run, Option<Use>)>) -> (Vec<Run>, HeldBack) {
    let said: Vec<Use> = runs.iter().filter_map(|(_, stated)| *stated).collect();
    let count = runs.len();
    if said.len() == count {
        return (give(runs, |_| Use::Fit), HeldBack::Stated);
    }
    if !said.is_empty() {
        let silent = if said.contains(&Use::HoldOut) { Use::Fit } else { Use::HoldOut };
        return (give(runs, |_| silent), HeldBack::Completed);
    }
    if count == 1 {
        let runs = runs.iter().flat_map(|(run, _)| in_two(run)).collect();
        return (runs, HeldBack::LastThird);
    }
    let back = (count / 4).max(1);
    (give(runs, |i| if i + back >= count { Use::HoldOut } else { Use::Fit }), HeldBack::LastRuns(back))
}

fn give(runs: Vec<(Run, Option<Use>)>, silent: impl Fn(usize) -> Use) -> Vec<Run> {
    runs.into_iter()
        .enumerate()
        .map(|(i, (run, stated))| Run { purpose: stated.unwrap_or_else(|| silent(i)), ..run })
        .collect()
}

fn in_two(run: &Run) -> [Run; 2] {
    let third = run.len() * 2 / 3;
    let (cut, of) = before_rest(run, third).map_or((third, ""), |cut| (cut, " of the motion"));
    let name = |part: &str| format!("{} ({part}{of})", run.name);
    [
        Run { purpose: Use::Fit, name: name("first two thirds"), ..run.part(0, cut) },
        Run { purpose: Use::HoldOut, name: name("last third"), ..run.part(cut, run.len()) },
    ]
}

/// Where two thirds of the reference's way are done; none where enough of it is left after the sample given.
fn before_rest(run: &Run, third: usize) -> Option<usize> {
    let reference = run.channel(Channel::Reference)?;
    let (mut way, mut sum) = (Vec::with_capacity(reference.len()), 0.0);
    for pair in reference.windows(2) {
        let step = (pair[1] - pair[0]).abs();
        sum += if step.is_finite() { step } else { 0.0 };
        way.push(sum);
    }
    let (total, before) = (sum, *way.get(third)?);
    (total > 0.0 && total - before < LEAST_WAY * total).then(|| way.partition_point(|w| *w < 2.0 / 3.0 * total) + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::clock::Clock;
    use crate::recording::{PerChannel, RecordedLaw};
    use Use::{Fit, HoldOut};

    fn run(n: usize) -> Run {
        Run {
            name: "a.csv".into(),
            path: "a.csv".into(),
            dt: 1.0,
            time: (0..n).map(|k| k as f64).collect(),
            channels: PerChannel::default(),
            noise: PerChannel::default(),
            loop_noise: None,
            law: RecordedLaw::Open,
            shaping: crate::recording::Shaping::default(),
            controller_rate_hz: None,
            purpose: Fit,
            cut: false,
            error_before: 0.0,
            sent_before: Vec::new(),
            elapsed: 0.0,
            clock: Clock::default(),
        }
    }

    fn uses(stated: &[Option<Use>]) -> Vec<Use> {
        assign(stated.iter().map(|s| (run(90), *s)).collect()).0.iter().map(|r| r.purpose).collect()
    }

    #[test]
    fn the_rule_as_stated() {
        assert_eq!(uses(&[Some(Fit), Some(HoldOut)]), [Fit, HoldOut]);
        assert_eq!(uses(&[Some(Fit), None]), [Fit, HoldOut]);
        assert_eq!(uses(&[None, Some(HoldOut), None]), [Fit, HoldOut, Fit]);
        assert_eq!(uses(&[None, None]), [Fit, HoldOut]);
        assert_eq!(uses(&[None; 8])[5..], [Fit, HoldOut, HoldOut]);
    }

    #[test]
    fn a_single_run_is_cut_in_two() {
        let (runs, rule) = assign(vec![(run(90), None)]);
        assert_eq!(rule, HeldBack::LastThird);
        assert_eq!((runs[0].len(), runs[1].len(), runs[1].time[0]), (60, 30, 60.0));
        assert!(!runs[0].cut && runs[1].cut);
        // Oil that warmed in the first part is warm in the second.
        assert_eq!((runs[0].elapsed, runs[1].elapsed), (0.0, 60.0 * runs[0].dt));
    }

    /// A pulse at the start and a long rest: the rest judges nothing.
    #[test]
    fn a_run_that_ends_at_rest_is_cut_within_its_motion() {
        let mut pulse = run(90);
        pulse.channels.set(Channel::Reference, (0..90).map(|k| f64::from(k.min(30))).collect());
        let (runs, _) = assign(vec![(pulse, None)]);
        assert_eq!((runs[0].len(), runs[1].len()), (20, 70));
        assert!(runs[1].name.ends_with("(last third of the motion)"), "{}", runs[1].name);
    }
}
