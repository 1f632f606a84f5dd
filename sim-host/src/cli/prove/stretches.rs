//! Stretches of a recording, each diagnosed by itself: whether the names found in the whole are found in a part of it.

use super::super::Failure;
use super::super::diagnose::failure;
use crate::diagnose::{Diagnosis, Options, Verdict, diagnose};
use crate::digits;
use crate::recording::Experiment;
use crate::recording::run::{Run, Use};
use crate::report::Table;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// How a stretch is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Split {
    /// Fitted in its first half, judged on its second.
    Halves,
    /// Fitted in whole, judged on the stretch before it.
    Before,
}

impl fmt::Display for Split {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Halves => "second half",
            Self::Before => "stretch before",
        })
    }
}

/// One diagnosis of a part of a recording.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Stretch {
    recording: String,
    from_s: f64,
    to_s: f64,
    judged_on: Split,
    verdict: Verdict,
    names: Vec<&'static str>,
    /// True where something beside the names is said to be missing.
    more_missing: bool,
    /// Names of the whole, or of what the whole does not tell from them, that the stretch does not give.
    not_found: Vec<&'static str>,
    /// Names that the whole does not give.
    others: Vec<&'static str>,
    /// The least R2 of a judged channel, with what was found.
    r2: f64,
}

/// Cuts every run of the experiment into stretches of this length (s) and diagnoses each in both ways.
pub(super) fn of(experiment: &Experiment, whole: &Diagnosis, length: f64) -> Result<Vec<Stretch>, Failure> {
    let parts: Vec<(Run, Run, Split)> = experiment.runs.iter().flat_map(|run| splits(run, length)).collect();
    let examined = |(fitted, judge, split): &(Run, Run, Split)| {
        // Every run has a name of its own: what is found of one is corrected in that one.
        let of = |run: &Run, purpose| {
            let name = format!("{} from {:.3} s", run.name, run.time[0]);
            Run { name, purpose, ..run.clone() }
        };
        let runs = vec![of(fitted, Use::Fit), of(judge, Use::HoldOut)];
        let part = Experiment { runs, ..experiment.clone() };
        let found = diagnose(&part, &Options::default()).map_err(failure)?.diagnosis;
        let last = if *split == Split::Halves { judge } else { fitted };
        let ends = [fitted.time[0], last.time[last.len() - 1]];
        Ok(compared(experiment.name.clone(), ends, *split, whole, &found))
    };
    parts.par_iter().map(examined).collect()
}

/// The parts of a run to fit and to judge on.
fn splits(run: &Run, length: f64) -> Vec<(Run, Run, Split)> {
    let rows = (length / run.dt) as usize;
    let cut = |k: usize| (k * rows, (k + 1) * rows);
    let count = run.len() / rows.max(1);
    let halves = (0..count).map(|k| {
        let (from, to) = cut(k);
        let middle = from.midpoint(to);
        (run.part(from, middle), run.part(middle, to), Split::Halves)
    });
    let before = (1..count).map(|k| {
        let ((a, b), (from, to)) = (cut(k - 1), cut(k));
        (run.part(from, to), run.part(a, b), Split::Before)
    });
    halves.chain(before).collect()
}

/// What a part claims beside what the whole claims.
fn compared(
    recording: String,
    [from_s, to_s]: [f64; 2],
    judged_on: Split,
    whole: &Diagnosis,
    part: &Diagnosis,
) -> Stretch {
    let names = |d: &Diagnosis| d.effects.iter().map(|e| e.id).collect::<Vec<_>>();
    let ties = [whole.indistinguishable.as_slice(), part.indistinguishable.as_slice()].concat();
    Stretch {
        recording,
        from_s,
        to_s,
        judged_on,
        verdict: part.verdict,
        names: names(part),
        more_missing: part.more_missing,
        not_found: without(&names(whole), &names(part), &ties),
        others: without(&names(part), &names(whole), &ties),
        r2: part.judged.after.r2.values().copied().fold(f64::INFINITY, f64::min),
    }
}

/// Those names that are not among others, nor tied with one of them.
fn without(these: &[&'static str], others: &[&'static str], ties: &[Vec<&'static str>]) -> Vec<&'static str> {
    let alike = |a: &str, b: &str| a == b || ties.iter().any(|tie| tie.contains(&a) && tie.contains(&b));
    these.iter().copied().filter(|a| !others.iter().any(|b| alike(a, b))).collect()
}

/// Every stretch.
pub(super) fn table(all: &[Stretch]) -> Table {
    let row = |s: &Stretch| {
        let names = if s.names.is_empty() { format!("({})", verdict(s.verdict)) } else { s.names.join(", ") };
        vec![
            s.recording.clone(),
            format!("{:.1} to {:.1}", s.from_s, s.to_s),
            s.judged_on.to_string(),
            digits::r2(s.r2),
            format!("{names}{}", if s.more_missing { "; more" } else { "" }),
            s.not_found.join(", "),
        ]
    };
    Table {
        columns: ["Recording", "Stretch [s]", "Judged on", "R2 [1]", "Found missing", "Not found"]
            .map(Into::into)
            .to_vec(),
        rows: all.iter().map(row).collect(),
        ..Table::default()
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Consistent => "consistent",
        Verdict::Mismatch => "mismatch",
        Verdict::BadData => "bad data",
    }
}

/// How many stretches of each recording give the names of the whole, and how many give others.
pub(super) fn counts(all: &[Stretch]) -> Table {
    let mut recordings: Vec<&str> = all.iter().map(|s| s.recording.as_str()).collect();
    recordings.dedup();
    let row = |recording: &&str| {
        let of = |is: &dyn Fn(&Stretch) -> bool| {
            all.iter().filter(|s| s.recording == *recording && is(s)).count().to_string()
        };
        vec![
            (*recording).to_owned(),
            of(&|_| true),
            of(&|s| s.not_found.is_empty() && s.others.is_empty()),
            of(&|s| !s.not_found.is_empty()),
            of(&|s| !s.others.is_empty()),
        ]
    };
    Table {
        columns: ["Recording", "Stretches [1]", "Names of the whole", "Some not found", "Others beside"]
            .map(Into::into)
            .to_vec(),
        rows: recordings.iter().map(row).collect(),
        ..Table::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Shaping;
    use crate::recording::doubt::tests::experiment;
    use crate::recording::law::RecordedLaw;

    /// A run of three stretches is fitted in three first halves and twice judged on the stretch before; no row judges what it fits.
    #[test]
    fn every_stretch_is_fitted_and_none_judges_what_it_fits() {
        let law = RecordedLaw::ProportionalIntegral { kp: 60.0, ki: 20.0 };
        let run = experiment(&law, Shaping::default(), 3).runs.remove(0);
        let all = splits(&run, run.duration() / 3.0);
        let count = |split| all.iter().filter(|s| s.2 == split).count();
        assert_eq!((count(Split::Halves), count(Split::Before)), (3, 2));
        for (fitted, judge, _) in &all {
            assert!(!fitted.time.iter().any(|t| judge.time.contains(t)));
        }
        assert!(splits(&run, 2.0 * run.duration()).is_empty());
    }

    /// A name stands for those it is tied with; one that is tied with none is missed.
    #[test]
    fn tied_names_are_one() {
        let ties = [vec!["coulomb_friction", "stribeck_friction"]];
        let (whole, part) = (["stribeck_friction", "payload_resonance"], ["coulomb_friction"]);
        assert_eq!(without(&whole, &part, &ties), ["payload_resonance"]);
        assert_eq!(without(&part, &whole, &ties), [""; 0]);
        assert_eq!(without(&part, &whole, &[]), ["coulomb_friction"]);
    }
}
