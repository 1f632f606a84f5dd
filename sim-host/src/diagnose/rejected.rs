//! Why each hypothesis that was weighed was not accepted, as a type with its numbers.

use super::judged::{Decision, ScoredModel};
use super::standing::at_bound;
use super::verdict::{Conclusion, Refusal};
use serde::Serialize;

/// Why a hypothesis was rejected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "reason")]
#[non_exhaustive]
pub enum Reason {
    /// It predicts worse than the accepted model.
    PredictsWorse {
        /// Its chi2 on the runs that judge.
        chi2: f64,
        /// That of the accepted model.
        accepted_chi2: f64,
    },
    /// It fits only at the end of what makes physical sense.
    AtBound {
        /// Its chi2 on the runs that judge.
        chi2: f64,
    },
    /// It adds effects without predicting better.
    NotNeeded {
        /// Its chi2 on the runs that judge.
        chi2: f64,
        /// Effects that it has beyond the accepted model.
        extra: usize,
    },
    /// The data do not distinguish it from the accepted model.
    Confounded {
        /// Its chi2 on the runs that judge.
        chi2: f64,
        /// Its probability.
        probability: f64,
    },
    /// It was selected and failed on the runs held out.
    FailsOnTest {
        /// What it failed.
        #[serde(flatten)]
        check: Refusal,
    },
    /// It leaves too much for its names to be believed.
    TooMuchLeft {
        /// Share of the stated model's misfit that it leaves.
        share_left: f64,
    },
}

/// A hypothesis that was rejected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Rejected {
    /// Its effects; empty for the stated model.
    pub ids: Vec<&'static str>,
    /// Why.
    #[serde(flatten)]
    pub why: Reason,
}

/// Every hypothesis that was weighed but the accepted one.
pub(super) fn rejected(conclusion: &Conclusion) -> Vec<Rejected> {
    let decision = &conclusion.decision;
    let accepted = &conclusion.accepted;
    let others = decision.candidates.iter().filter(|c| c.added != accepted.added);
    let why = |c: &ScoredModel| match conclusion.refusal {
        Some(check) if c.added == decision.accepted.added => Reason::FailsOnTest { check },
        _ => why(decision, c),
    };
    others.map(|c| Rejected { ids: c.added.clone(), why: why(c) }).collect()
}

fn why(decision: &Decision, candidate: &ScoredModel) -> Reason {
    let accepted = &decision.accepted;
    let (chi2, accepted_chi2) = (candidate.hold.chi2, accepted.hold.chi2);
    let extra = candidate.added.len().saturating_sub(accepted.added.len());
    if decision.partial.as_ref().is_some_and(|partial| partial.added == candidate.added) {
        let excess = (decision.stated.hold.chi2 - 1.0).max(1e-9);
        return Reason::TooMuchLeft { share_left: (chi2 - 1.0).max(0.0) / excess };
    }
    let tied = decision.ties.iter().any(|tie| candidate.added.iter().any(|id| tie.contains(id)));
    if tied && candidate.added.len() == accepted.added.len() {
        return Reason::Confounded { chi2, probability: candidate.probability };
    }
    if at_bound(candidate) {
        return Reason::AtBound { chi2 };
    }
    if extra > 0 {
        return Reason::NotNeeded { chi2, extra };
    }
    Reason::PredictsWorse { chi2, accepted_chi2 }
}
