//! Constants fitted on stored evidence and judged on kinds of flaws that they were not fitted on.
//!
//! A statement's probability p becomes the one whose log-odds are `slope` times those of p plus `offset`: two constants, by
//! maximum likelihood (Platt 1999). They are worth what they do for a kind that was left out of their fit.

use super::super::record::Record;
use super::calibration::{Calibration, calibration};
use super::outcome::judge;
use crate::report::Table;
use serde::Serialize;
use std::collections::BTreeMap;

/// The constants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Constants {
    /// Factor on the log-odds as stated (1).
    pub slope: f64,
    /// Added to them (1).
    pub offset: f64,
}

/// Calibration as stated, by constants fitted on everything, and by constants that never saw the kind they judge.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Calibrated {
    /// Fitted on all kinds.
    pub constants: Constants,
    /// Kinds.
    pub kinds: usize,
    /// As stated.
    pub stated: Option<Calibration>,
    /// By the constants fitted on all kinds, on the same kinds.
    pub fitted: Option<Calibration>,
    /// Each kind by constants fitted on all others.
    pub left_out: Option<Calibration>,
    /// The constants of each fold, by the kind left out.
    pub folds: BTreeMap<String, Constants>,
}

/// Closest to certainty that a probability is taken to be.
const CERTAIN: f64 = 1e-6;

fn odds(p: f64) -> f64 {
    let p = p.clamp(CERTAIN, 1.0 - CERTAIN);
    libm::log(p / (1.0 - p))
}

impl Constants {
    /// The calibrated probability of what was said with `p`.
    pub fn apply(self, p: f64) -> f64 {
        1.0 / (1.0 + libm::exp(-(self.slope * odds(p) + self.offset)))
    }

    /// By maximum likelihood, with a prior as heavy as one statement that nothing need change.
    fn fit(statements: &[(f64, bool)]) -> Self {
        let mut at = Self { slope: 1.0, offset: 0.0 };
        for _ in 0..40 {
            let (mut g, mut h) = ([-(at.slope - 1.0), -at.offset], [1.0, 0.0, 1.0]);
            for (p, right) in statements {
                let (x, q) = (odds(*p), at.apply(*p));
                let (off, weight) = (f64::from(*right) - q, q * (1.0 - q));
                g = [g[0] + off * x, g[1] + off];
                h = [h[0] + weight * x * x, h[1] + weight * x, h[2] + weight];
            }
            let det = h[0] * h[2] - h[1] * h[1];
            let step = [(h[2] * g[0] - h[1] * g[1]) / det, (h[0] * g[1] - h[1] * g[0]) / det];
            at.slope += step[0].clamp(-0.5, 0.5);
            at.offset += step[1].clamp(-1.0, 1.0);
            if step[0].abs() + step[1].abs() < 1e-9 {
                break;
            }
        }
        at
    }
}

/// The kind that a case is left out with: its flaws.
fn kind(record: &Record) -> String {
    let truth = &record.truth;
    let mut ids: Vec<&str> = truth.effects.iter().chain(&truth.unlisted_kinds).map(|p| p.id.as_str()).collect();
    ids.sort_unstable();
    if ids.is_empty() { truth.stratum.clone() } else { ids.join(" + ") }
}

/// Calibrates on the records, and leaves each kind out in turn: with a kind go all cases that hold any flaw of it.
pub fn calibrate(records: &[Record]) -> Calibrated {
    let mut by_kind: BTreeMap<String, Vec<(f64, bool)>> = BTreeMap::new();
    for record in records {
        by_kind.entry(kind(record)).or_default().extend(judge(record).statements);
    }
    by_kind.retain(|_, statements| !statements.is_empty());
    let all: Vec<(f64, bool)> = by_kind.values().flatten().copied().collect();
    let constants = Constants::fit(&all);
    let share = |a: &str, b: &str| a.split(" + ").any(|one| b.split(" + ").any(|other| one == other));
    let mut folds = BTreeMap::new();
    let mut left_out = Vec::new();
    for (name, own) in &by_kind {
        let others = by_kind.iter().filter(|(other, _)| !share(name, other)).flat_map(|(_, s)| s.iter().copied());
        let fold = Constants::fit(&others.collect::<Vec<_>>());
        left_out.extend(own.iter().map(|(p, right)| (fold.apply(*p), *right)));
        folds.insert(name.clone(), fold);
    }
    let fitted: Vec<_> = all.iter().map(|(p, right)| (constants.apply(*p), *right)).collect();
    Calibrated {
        constants,
        kinds: by_kind.len(),
        stated: calibration(&all),
        fitted: calibration(&fitted),
        left_out: calibration(&left_out),
        folds,
    }
}

/// The three as a table.
pub fn table(calibrated: &Calibrated) -> Table {
    let row = |name: &str, c: &Option<Calibration>| {
        let figures = c.as_ref().map_or_else(
            || vec!["\u{2013}".to_string(); 4],
            |c| {
                let beyond = format!("{:.3}", c.error - c.expected);
                vec![c.statements.to_string(), format!("{:.3}", c.error), format!("{:.3}", c.expected), beyond]
            },
        );
        std::iter::once(name.to_string()).chain(figures).collect()
    };
    let constants = calibrated.constants;
    Table {
        columns: ["Probabilities", "Statements", "Error", "Expected", "Beyond"].map(String::from).to_vec(),
        rows: vec![
            row("as stated", &calibrated.stated),
            row("calibrated, on the kinds fitted", &calibrated.fitted),
            row("calibrated, each kind left out", &calibrated.left_out),
        ],
        caption: format!(
            "Log-odds times {:.3} plus {:.3}, fitted on {} kinds. With a kind are left out all cases that hold it.",
            constants.slope, constants.offset, calibrated.kinds
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::record::{Named, Record, Reply, TrueEffect, Truth};
    use super::{Constants, calibrate};

    /// Cases of an effect that is named with `stated`, and rightly so in `right` of a hundred.
    fn cases(id: &str, stated: f64, right: u64) -> Vec<Record> {
        let of = |case: u64| {
            let name = if case % 100 < right { id } else { "another" };
            let named = Named { id: name.into(), probability: Some(stated), ..Named::default() };
            let effects = vec![TrueEffect { id: id.into(), ..TrueEffect::default() }];
            Record {
                case,
                reply: Reply { verdict: "mismatch".into(), effects: vec![named], ..Reply::default() },
                truth: Truth { stratum: "single".into(), effects, ..Truth::default() },
                ..Record::default()
            }
        };
        (0..100).map(of).collect()
    }

    #[test]
    fn what_is_too_bold_is_taken_back_on_kinds_that_were_not_seen() {
        let bold: Vec<Record> =
            ["a", "b", "c", "d"].iter().flat_map(|id| [cases(id, 0.99, 80), cases(id, 0.6, 55)].concat()).collect();
        let calibrated = calibrate(&bold);
        let beyond = |c: &Option<super::Calibration>| c.as_ref().map(|c| c.error - c.expected).unwrap();
        assert!(beyond(&calibrated.stated) > 0.08, "{calibrated:?}");
        assert!(beyond(&calibrated.left_out) < 0.03, "{calibrated:?}");
        assert!(calibrated.constants.slope < 0.5 && calibrated.folds.len() == 4);
    }

    #[test]
    fn a_kind_unlike_all_others_shows_when_it_is_left_out() {
        let odd = [cases("a", 0.9, 90), cases("b", 0.9, 90), cases("c", 0.9, 20)].concat();
        let calibrated = calibrate(&odd);
        let error = |c: &Option<super::Calibration>| c.as_ref().unwrap().error;
        assert!(error(&calibrated.left_out) > error(&calibrated.fitted) + 0.1, "{calibrated:?}");
    }

    #[test]
    fn nothing_to_fit_changes_nothing() {
        assert_eq!(Constants::fit(&[]), Constants { slope: 1.0, offset: 0.0 });
        assert!(calibrate(&[]).stated.is_none());
    }
}
