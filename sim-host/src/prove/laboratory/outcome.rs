//! One case of examiner 2 scored. What counts as what is said here, in `place` and in `set_up`.

use super::super::record::{Record, Reply, Truth};
use super::super::score::{Score, score};
use super::{place, set_up};
use std::collections::BTreeSet;

/// A record with how it went.
pub type ScoredModel<'a> = (&'a Record, Outcome);

/// How a case went.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// As examiner 1 would score it: wrong names, coverage, points.
    pub score: Score,
    /// The whole answer is right: the exact set of names; beside unlisted flaws, that more is missing; without listed
    /// ones, no name and a mismatch; where nothing is missing, `consistent`; where the data are bad, `bad-data`.
    pub right: bool,
    /// Of the listed effects that are there, those that were named.
    pub found: usize,
    /// It says that something is missing that it has no name for.
    pub more: bool,
    /// It says so, and all that is missing is listed; but not where it names all of it and the library's best fit, the truth
    /// given, leaves more than a twentieth: then more is missing indeed.
    pub false_unlisted: bool,
    /// It refuses the recordings.
    pub refused: bool,
    /// Each statement with its probability, and whether it is true.
    pub statements: Vec<(f64, bool)>,
    /// Faults of the set-up that are asked for, and whether each was reported.
    pub faults: Vec<(String, bool)>,
    /// Faults of the set-up that are none.
    pub false_faults: Vec<String>,
    /// Block: whether it is one at which a flaw acts; none where nothing is missing.
    pub block: Option<bool>,
    /// F1 over time; none where the flaw acts always.
    pub time: Option<f64>,
    /// F1 over the state region; none where the flaw acts everywhere.
    pub state: Option<f64>,
    /// Share of the excess on the runs held out that the curve or equation for an unlisted flaw removes.
    pub modelled: Option<f64>,
}

/// Share that the library's best fit may leave of a listed effect for nothing more to be missing.
const LEFT: f64 = 0.05;

/// Scores a case.
pub fn judge(record: &Record) -> Outcome {
    let (reply, truth) = (&record.reply, &record.truth);
    let score = score(record);
    let (faults, false_faults) = set_up::reported(reply, truth);
    let more = says_more(reply);
    let unlisted = truth.unlisted.is_some();
    let missing = !truth.effects.is_empty() || unlisted;
    let right = is_right(reply, truth, &score, more);
    Outcome {
        right,
        found: truth.effects.iter().filter(|p| reply.effects.iter().any(|e| e.id == p.id)).count(),
        more,
        false_unlisted: more && !unlisted && !(right && missing && left(record).is_some_and(|share| share > LEFT)),
        refused: reply.verdict == "bad-data",
        statements: statements(reply, truth),
        faults,
        false_faults,
        block: missing.then(|| place::block(reply, truth)),
        time: place::over_time(reply, truth),
        state: place::over_state(reply, truth),
        modelled: (unlisted && truth.effects.is_empty()).then(|| removed(reply)),
        score,
    }
}

/// Whether it says that something without a name is missing.
fn says_more(reply: &Reply) -> bool {
    let nameless = reply.verdict == "mismatch" && reply.effects.is_empty();
    reply.more_missing || nameless || reply.effects.iter().any(|e| e.id == "unlisted")
}

fn is_right(reply: &Reply, truth: &Truth, score: &Score, more: bool) -> bool {
    let named: BTreeSet<&str> = reply.effects.iter().map(|e| e.id.as_str()).filter(|id| *id != "unlisted").collect();
    let there: BTreeSet<&str> = truth.effects.iter().map(|e| e.id.as_str()).collect();
    let nothing_wrong = score.wrong_names.is_empty();
    if truth.fault.is_some() {
        return reply.verdict == "bad-data";
    }
    if truth.stratum == "confounded" {
        return nothing_wrong && there.iter().all(|id| tied(id, reply, truth));
    }
    match (there.is_empty(), truth.unlisted.is_some()) {
        (true, false) => reply.verdict == "consistent" && nothing_wrong,
        (true, true) => {
            nothing_wrong && (reply.verdict == "mismatch" || (truth.bad_data_accepted && reply.verdict == "bad-data"))
        }
        (false, unlisted) => {
            let all = there.iter().all(|id| named.contains(id) || stands_for(id, &named, reply, truth));
            all && nothing_wrong && (more || !unlisted)
        }
    }
}

/// Whether the effect is stated to be one of several that the data do not tell apart, another of its true group among them.
fn tied(id: &str, reply: &Reply, truth: &Truth) -> bool {
    let rivals = |group: &&Vec<String>| group.iter().any(|m| m == id);
    let true_ones: Vec<&String> = truth.groups.iter().filter(rivals).flatten().filter(|m| *m != id).collect();
    reply.indistinguishable.iter().filter(rivals).any(|group| group.iter().any(|m| true_ones.contains(&m)))
}

/// Whether a member of the effect's true group was named in its place, and the two were said not to be told apart.
fn stands_for(id: &str, named: &BTreeSet<&str>, reply: &Reply, truth: &Truth) -> bool {
    let both = |group: &Vec<String>, other: &str| group.iter().any(|m| m == id) && group.iter().any(|m| m == other);
    let tied = |other: &str| reply.indistinguishable.iter().any(|group| both(group, other));
    named.iter().any(|other| truth.groups.iter().any(|group| both(group, other)) && tied(other))
}

/// Every name with its probability, that something unlisted is missing, and that nothing is.
fn statements(reply: &Reply, truth: &Truth) -> Vec<(f64, bool)> {
    let there = |id: &str| {
        let group = truth.groups.iter().any(|g| g.iter().any(|m| m == id));
        let tolerated = truth.tolerated.iter().any(|t| t == id);
        let unlisted = id == "unlisted" && truth.unlisted.is_some();
        truth.effects.iter().any(|e| e.id == id) || group || tolerated || unlisted
    };
    if reply.verdict == "consistent" {
        let none = reply.candidates.iter().find(|c| c.ids.is_empty());
        let nothing = truth.effects.is_empty() && truth.unlisted.is_none();
        return none.map(|c| (c.probability, nothing)).into_iter().collect();
    }
    reply.effects.iter().filter_map(|e| Some((e.probability?, there(&e.id)))).collect()
}

/// Share of the excess that is gone on the runs held out.
fn removed(reply: &Reply) -> f64 {
    let curve = reply.remainder.as_ref().and_then(|r| r.share).unwrap_or(0.0);
    let model = match (reply.holdout.before.chi2, reply.holdout.after.chi2) {
        (Some(before), Some(after)) if before > 1.0 => ((before - after.max(1.0)) / (before - 1.0)).max(0.0),
        _ => 0.0,
    };
    // A consistent verdict models nothing.
    if reply.verdict == "mismatch" { curve.max(model) } else { 0.0 }
}

/// Share of the flaw's excess that the library's best fit, given the true effects, leaves without noise on the run held out.
pub(super) fn left(record: &Record) -> Option<f64> {
    let floor = record.attainable.as_ref()?.floor?;
    let excess = record.truth.baseline_chi2 - 1.0;
    (record.truth.unlisted.is_none() && excess > 0.0).then(|| (floor - 1.0) / excess)
}

#[cfg(test)]
mod tests {
    use super::super::super::record::{Attainable, Candidate, Named, Record, Reply, TrueEffect, Truth};
    use super::{Outcome, judge};

    fn judged(
        there: &[&str],
        unlisted: Option<&str>,
        verdict: &str,
        names: &[&str],
        change: impl Fn(&mut Record),
    ) -> Outcome {
        let named = |id: &&str| Named { id: (*id).into(), probability: Some(0.9), ..Named::default() };
        let present = |id: &&str| TrueEffect { id: (*id).into(), ..TrueEffect::default() };
        let mut record = Record {
            reply: Reply { verdict: verdict.into(), effects: names.iter().map(named).collect(), ..Reply::default() },
            truth: Truth {
                stratum: "single".into(),
                effects: there.iter().map(present).collect(),
                unlisted: unlisted.map(Into::into),
                ..Truth::default()
            },
            ..Record::default()
        };
        change(&mut record);
        judge(&record)
    }

    #[test]
    fn listed_beside_unlisted_is_right_only_with_the_name_and_that_more_is_missing() {
        let more = |r: &mut Record| r.reply.more_missing = true;
        let there: &[&str] = &["leakage"];
        assert!(judged(there, Some("x"), "mismatch", there, more).right);
        assert!(!judged(there, Some("x"), "mismatch", there, |_| {}).right);
        assert!(!judged(there, Some("x"), "mismatch", &["unlisted"], |_| {}).right);
        assert!(!judged(there, Some("x"), "mismatch", &["leakage", "spring"], more).right);
    }

    #[test]
    fn to_say_unlisted_where_all_is_listed_is_false() {
        assert!(judged(&["leakage"], None, "mismatch", &["unlisted"], |_| {}).false_unlisted);
        assert!(judged(&["leakage"], None, "mismatch", &["leakage"], |r| r.reply.more_missing = true).false_unlisted);
        assert!(judged(&[], None, "mismatch", &[], |_| {}).false_unlisted);
        assert!(!judged(&[], Some("x"), "mismatch", &["unlisted"], |_| {}).false_unlisted);
    }

    #[test]
    fn a_null_is_right_where_nothing_is_said_to_be_missing() {
        assert!(judged(&[], None, "consistent", &[], |_| {}).right);
        assert!(!judged(&[], None, "bad-data", &[], |_| {}).right);
        assert!(!judged(&[], None, "mismatch", &["leakage"], |_| {}).right);
        assert!(judged(&[], None, "bad-data", &[], |r| r.truth.fault = Some("stuck".into())).right);
    }

    #[test]
    fn every_name_is_a_statement_and_so_is_that_nothing_is_missing() {
        let pair = judged(&["leakage"], None, "mismatch", &["leakage", "spring"], |_| {});
        assert_eq!(pair.statements, [(0.9, true), (0.9, false)]);
        let nothing = |r: &mut Record| r.reply.candidates = vec![Candidate { ids: vec![], probability: 0.97 }];
        assert_eq!(judged(&["leakage"], None, "consistent", &[], nothing).statements, [(0.97, false)]);
        assert_eq!(judged(&[], Some("x"), "mismatch", &["unlisted"], |_| {}).statements, [(0.9, true)]);
    }

    #[test]
    fn where_truth_is_confounded_the_tie_is_what_is_asked_for() {
        let group = vec!["command_delay".to_string(), "valve_lag".to_string()];
        let confounded = |r: &mut Record| {
            r.truth.stratum = "confounded".into();
            r.truth.groups = vec![group.clone()];
        };
        let tie = |r: &mut Record| {
            confounded(r);
            r.reply.indistinguishable = vec![group.clone()];
        };
        assert!(judged(&["command_delay"], None, "mismatch", &["valve_lag"], tie).right);
        assert!(!judged(&["command_delay"], None, "mismatch", &["command_delay"], confounded).right);
    }

    #[test]
    fn more_is_missing_indeed_where_the_library_leaves_much_of_the_true_effect() {
        let leaves = |floor: f64| {
            move |r: &mut Record| {
                r.reply.more_missing = true;
                r.truth.baseline_chi2 = 101.0;
                r.attainable = Some(Attainable { floor: Some(floor), ..Attainable::default() });
            }
        };
        assert!(!judged(&["leakage"], None, "mismatch", &["leakage"], leaves(11.0)).false_unlisted);
        assert!(judged(&["leakage"], None, "mismatch", &["leakage"], leaves(3.0)).false_unlisted);
        assert!(judged(&["leakage"], None, "mismatch", &["unlisted"], leaves(11.0)).false_unlisted);
    }

    #[test]
    fn a_member_of_the_true_group_stands_for_another_only_where_the_tie_is_stated() {
        let group = || vec!["command_delay".to_string(), "valve_lag".to_string()];
        let there: &[&str] = &["command_delay"];
        let tie = |r: &mut Record| {
            r.truth.groups = vec![group()];
            r.reply.indistinguishable = vec![group()];
        };
        assert!(judged(there, None, "mismatch", &["valve_lag"], tie).right);
        assert!(!judged(there, None, "mismatch", &["valve_lag"], |r| r.truth.groups = vec![group()]).right);
        assert!(!judged(there, None, "mismatch", &["valve_lag"], |r| r.reply.indistinguishable = vec![group()]).right);
    }
}
