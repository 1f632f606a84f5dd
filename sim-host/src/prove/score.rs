//! One case scored. What counts as what is said here and nowhere else.

use super::record::{Record, Reply, Truth};
use std::collections::BTreeSet;

/// How a case went.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// Something was said to be amiss, and something was; or neither.
    pub detected: bool,
    /// The set of names is the true one; for nulls, unlisted flaws and bad data: no name, and the right verdict.
    pub right: bool,
    /// Names that are neither there nor tolerated.
    pub wrong_names: Vec<String>,
    /// A stated group of indistinguishable effects holds the true one, and the truth is confounded.
    pub group_right: bool,
    /// Plus one for the right set (or group where truth is confounded), a half for a part of a pair or for the right
    /// name without the group that belongs to it, minus one for each wrong name.
    pub points: f64,
    /// Sum over candidate sets of (probability - truth)^2, the true set counting as a candidate where it is none.
    pub brier: Option<f64>,
    /// Probability of the most probable set, and whether it is the true one.
    pub confidence: Option<(f64, bool)>,
    /// For each parameter of a rightly named effect, as `ID.key`: whether the 90 % interval covers the value it should.
    pub covered: Vec<(String, bool)>,
    /// Of the excess of the held-out chi2 over 1, what is left (1); none where there is no chi2.
    pub excess_left: Option<f64>,
    /// Held-out chi2 at most 1.1, or 95 % of the excess removed; none where the library does not hold the flaw.
    pub fits: Option<bool>,
}

fn set<'a>(ids: impl Iterator<Item = &'a str>) -> BTreeSet<&'a str> {
    ids.collect()
}

/// Scores a record.
pub fn score(record: &Record) -> Score {
    let (reply, truth) = (&record.reply, &record.truth);
    let named = set(reply.effects.iter().map(|e| e.id.as_str()).filter(|id| *id != "unlisted"));
    let present = set(truth.effects.iter().map(|e| e.id.as_str()));
    let tolerated = set(truth.tolerated.iter().map(String::as_str));
    let counted: BTreeSet<&str> =
        named.iter().copied().filter(|id| present.contains(id) || !tolerated.contains(id)).collect();
    let wrong_names = wrong(&counted, &present, truth);
    let group_right = stated_group(reply, truth);
    let right = is_right(reply, truth, &counted, &present, group_right);
    let detected = match truth.stratum.as_str() {
        "null" => reply.verdict == "consistent",
        "bad data" => reply.verdict == "bad-data",
        _ => matches!(reply.verdict.as_str(), "mismatch" | "bad-data"),
    };
    let partly = counted.intersection(&present).count() > 0 && wrong_names.is_empty();
    let points = if right {
        1.0
    } else if partly {
        0.5
    } else {
        0.0
    } - wrong_names.len() as f64;
    let (brier, confidence) = probabilities(reply, truth, &present);
    let (excess_left, fits) = fit(reply, truth);
    let covered = covered(record, &present);
    Score {
        detected,
        right,
        wrong_names: wrong_names.into_iter().map(str::to_string).collect(),
        group_right,
        points,
        brier,
        confidence,
        covered,
        excess_left,
        fits,
    }
}

/// In a confounded case any member of the true group is as right a name as another.
fn wrong<'a>(counted: &BTreeSet<&'a str>, present: &BTreeSet<&str>, truth: &Truth) -> Vec<&'a str> {
    let in_group = |id: &str| truth.groups.iter().any(|g| g.iter().any(|m| m == id));
    counted.iter().copied().filter(|id| !present.contains(id) && !in_group(id)).collect()
}

/// Whether a stated group holds every effect that is there and is a part of what truly is confounded.
fn stated_group(reply: &Reply, truth: &Truth) -> bool {
    let Some(group) = truth.groups.first() else { return false };
    let Some(present) = truth.effects.first() else { return false };
    reply
        .indistinguishable
        .iter()
        .any(|stated| stated.contains(&present.id) && stated.iter().filter(|id| group.contains(id)).count() > 1)
}

fn is_right(
    reply: &Reply,
    truth: &Truth,
    counted: &BTreeSet<&str>,
    present: &BTreeSet<&str>,
    group_right: bool,
) -> bool {
    match truth.stratum.as_str() {
        "null" => counted.is_empty() && reply.verdict == "consistent",
        "bad data" => reply.verdict == "bad-data",
        "unlisted" => {
            let verdict = reply.verdict == "mismatch" || (truth.bad_data_accepted && reply.verdict == "bad-data");
            counted.is_empty() && verdict
        }
        // Full marks where the group is stated, whichever member is named, and only one is.
        "confounded" => group_right && counted.len() <= 1 && wrong(counted, present, truth).is_empty(),
        _ => counted == present,
    }
}

fn probabilities(reply: &Reply, truth: &Truth, present: &BTreeSet<&str>) -> (Option<f64>, Option<(f64, bool)>) {
    if reply.candidates.is_empty() || truth.stratum == "bad data" {
        return (None, None);
    }
    let is_true = |ids: &[String]| {
        let ids = set(ids.iter().map(String::as_str));
        if truth.stratum == "unlisted" {
            return ids.contains("unlisted");
        }
        if truth.stratum == "confounded" && ids.len() == 1 {
            return ids.iter().all(|id| truth.groups.iter().any(|g| g.iter().any(|m| m == id)));
        }
        ids == *present
    };
    // Members of one confounded group share one outcome: their probabilities belong together.
    let (mut for_true, mut others) = (0.0, 0.0);
    for candidate in &reply.candidates {
        if is_true(&candidate.ids) {
            for_true += candidate.probability;
        } else {
            others += candidate.probability * candidate.probability;
        }
    }
    let brier = (1.0 - for_true).powi(2) + others;
    let top = reply.candidates.iter().max_by(|a, b| a.probability.total_cmp(&b.probability));
    (Some(brier), top.map(|c| (c.probability, is_true(&c.ids))))
}

fn fit(reply: &Reply, truth: &Truth) -> (Option<f64>, Option<bool>) {
    let (Some(before), Some(after)) = (reply.holdout.before.chi2, reply.holdout.after.chi2) else {
        return (None, None);
    };
    let left = if before > 1.0 { ((after - 1.0) / (before - 1.0)).max(0.0) } else { 0.0 };
    let listed = matches!(truth.stratum.as_str(), "single" | "pair");
    (Some(left), listed.then_some(after <= 1.1 || left <= 0.05))
}

fn covered(record: &Record, present: &BTreeSet<&str>) -> Vec<(String, bool)> {
    let Some(attainable) = &record.attainable else { return Vec::new() };
    let named = record.reply.effects.iter().filter(|e| present.contains(e.id.as_str()));
    named
        .flat_map(|effect| {
            effect.parameters.iter().filter_map(|(key, estimate)| {
                let name = format!("{}.{key}", effect.id);
                let value = attainable.parameters.get(&name)?;
                let (low, high) = estimate.interval()?;
                Some((name, (low..=high).contains(value)))
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::record::{Candidate, Named, Record, Reply, TrueEffect, Truth};
    use super::{Score, score};

    fn graded(stratum: &str, there: &[&str], verdict: &str, names: &[&str], change: impl Fn(&mut Record)) -> Score {
        let reply = Reply {
            verdict: verdict.into(),
            effects: names.iter().map(|id| Named { id: (*id).into(), ..Named::default() }).collect(),
            ..Reply::default()
        };
        let truth = Truth {
            stratum: stratum.into(),
            effects: there.iter().map(|id| TrueEffect { id: (*id).into(), ..TrueEffect::default() }).collect(),
            ..Truth::default()
        };
        let mut record = Record { reply, truth, ..Record::default() };
        change(&mut record);
        score(&record)
    }

    #[test]
    fn a_name_in_a_null_costs_a_point_and_a_tolerated_one_does_not() {
        let bare = graded("null", &[], "mismatch", &["mains_hum"], |_| {});
        assert_eq!((bare.right, bare.points, bare.wrong_names.len()), (false, -1.0, 1));
        let hum = graded("null", &[], "consistent", &["mains_hum"], |r| r.truth.tolerated = vec!["mains_hum".into()]);
        assert_eq!((hum.right, hum.points), (true, 1.0));
    }

    #[test]
    fn a_set_is_right_only_as_a_whole() {
        let pair = ["coulomb_friction", "command_delay"];
        assert_eq!(graded("pair", &pair, "mismatch", &pair, |_| {}).points, 1.0);
        assert_eq!(graded("pair", &pair, "mismatch", &pair[..1], |_| {}).points, 0.5);
        let wrong = graded("pair", &pair, "mismatch", &["coulomb_friction", "leakage"], |_| {});
        assert_eq!((wrong.right, wrong.points), (false, -1.0));
    }

    #[test]
    fn a_stated_group_gets_full_marks_only_where_truth_is_confounded() {
        let group = vec!["command_delay".to_string(), "valve_lag".to_string()];
        let state = |r: &mut Record| r.reply.indistinguishable = vec![group.clone()];
        let confounded = |r: &mut Record| {
            state(r);
            r.truth.groups = vec![group.clone()];
        };
        assert!(graded("confounded", &["command_delay"], "mismatch", &["valve_lag"], confounded).right);
        assert!(!graded("single", &["command_delay"], "mismatch", &["valve_lag"], state).right);
        // The right name without the group claims more than the data hold: half.
        let bold = graded("confounded", &["command_delay"], "mismatch", &["command_delay"], |r| {
            r.truth.groups = vec![group.clone()];
        });
        assert_eq!((bold.right, bold.points), (false, 0.5));
    }

    #[test]
    fn a_listed_name_for_an_unlisted_flaw_is_wrong() {
        assert!(graded("unlisted", &[], "mismatch", &[], |_| {}).right);
        assert_eq!(graded("unlisted", &[], "mismatch", &["viscous_friction"], |_| {}).points, -1.0);
        assert!(!graded("unlisted", &[], "consistent", &[], |_| {}).detected);
        assert!(graded("unlisted", &[], "mismatch", &["unlisted"], |_| {}).right);
    }

    #[test]
    fn probabilities_are_held_to_what_was_there() {
        let candidates = vec![
            Candidate { ids: vec!["leakage".into()], probability: 0.7 },
            Candidate { ids: vec!["unlisted".into()], probability: 0.2 },
            Candidate { ids: vec![], probability: 0.1 },
        ];
        let with = |r: &mut Record| r.reply.candidates.clone_from(&candidates);
        let right = graded("single", &["leakage"], "mismatch", &["leakage"], with);
        assert!((right.brier.unwrap() - (0.09 + 0.04 + 0.01)).abs() < 1e-12);
        assert_eq!(right.confidence, Some((0.7, true)));
        let unlisted = graded("unlisted", &[], "mismatch", &[], with);
        assert!((unlisted.brier.unwrap() - (0.64 + 0.49 + 0.01)).abs() < 1e-12);
        assert_eq!(unlisted.confidence, Some((0.7, false)));
        let null = graded("null", &[], "mismatch", &["leakage"], with);
        assert!((null.brier.unwrap() - (0.81 + 0.49 + 0.04)).abs() < 1e-12);
    }
}
