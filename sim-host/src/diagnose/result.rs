//! The diagnosis as other tools read it: schema `shakedown.diagnosis/1`.

pub(crate) use super::planned::NextTest;

mod told;

use super::change::Change;
use super::judged::ScoredModel;
use super::locate::Location;
use super::rejected::{Rejected, rejected};
use super::remainder::ResidualCurve;
use super::term::report::Term;
use super::verdict::{Conclusion, Refusal};
use crate::identify::judge::Score;
use crate::identify::prepare::Prepared;
use crate::identify::quantity::{Quantity, quantities};
use crate::plant::effects::Role;
use crate::plant::effects::regional::is_code;
use crate::recording::SetUpFinding;
use crate::recording::check::Finding;
use serde::Serialize;
use std::collections::BTreeMap;

/// What came out.
#[derive(Debug, Clone, Serialize)]
pub struct Diagnosis {
    /// The schema this object follows.
    pub schema: &'static str,
    /// `consistent`, `mismatch` or `bad-data`.
    pub verdict: Verdict,
    /// Where the model and the recordings part.
    pub location: Location,
    /// The accepted effects.
    pub effects: Vec<NamedEffect>,
    /// Every set of effects in the running.
    pub candidates: Vec<Candidate>,
    /// Sets of effects that the data cannot tell apart.
    pub indistinguishable: Vec<Vec<&'static str>>,
    /// The test that would settle what is open.
    pub next_test: Option<NextTest>,
    /// Why none is proposed, where something is open that no test within the reach of these runs settles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_test: Option<String>,
    /// What it changes for who runs the table; none where nothing was found or measured motion drives the model.
    pub change: Option<Change>,
    /// Fit on the hold-out set; none where no run is held out.
    pub holdout: Option<BeforeAfter>,
    /// The same on the runs that judged: the hold-out set, or the runs fitted where none is held out.
    #[serde(skip)]
    pub judged: BeforeAfter,
    /// Why names that were selected are not given: what they failed on the runs held out.
    pub refusal: Option<Refusal>,
    /// True where effects are named and leave more than noise and the simplicity of their equations.
    pub more_missing: bool,
    /// Every hypothesis that was weighed and not accepted, with the reason.
    pub rejected: Vec<Rejected>,
    /// The refitted model's own parameters.
    pub model: BTreeMap<String, Quantity>,
    /// Where effects of the library explain a part only: which, and how much of the excess.
    pub part_explained: Option<Part>,
    /// A curve that stands for what the library does not hold.
    pub remainder: Option<ResidualCurve>,
    /// The equation found for what the library does not hold.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub term: Option<Term>,
    /// Share of the stated model's excess over the noise floor that the accepted model leaves.
    pub share_left: f64,
    /// True where the runs fitted did not show what is missing: half of the stretches of the hold-out runs were fitted too, and
    /// `holdout` is of the others.
    pub held_out_shared: bool,
    /// What of the stated set-up was found wrong; the diagnosis went on with what was found.
    pub set_up: Vec<SetUpFinding>,
    /// Values of the model, in the place of stated ones that were not to be fitted, which explain the recordings as well as what was found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stated_values_instead: Vec<SetUpFinding>,
    /// What is wrong with the data, or worth knowing about it.
    pub findings: Vec<Finding>,
    /// Wall-clock time, s.
    pub seconds: f64,
}

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The model explains the recordings to within their noise.
    Consistent,
    /// It does not.
    Mismatch,
    /// The recordings cannot be believed.
    BadData,
}

/// An accepted effect.
#[derive(Debug, Clone, Serialize)]
pub struct NamedEffect {
    /// Its identifier.
    pub id: &'static str,
    /// Probability that it is present.
    pub probability: f64,
    /// Its equation.
    pub equation: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, Quantity>,
}

/// A set of effects in the running.
#[derive(Debug, Clone, Serialize)]
pub struct Candidate {
    /// The effects; empty for the stated model.
    pub ids: Vec<&'static str>,
    /// Share of belief.
    pub probability: f64,
    /// chi2 on the stretches that fitted it.
    pub training_chi2: Option<f64>,
    /// chi2 on the stretches of the runs fitted that weighed it.
    pub validation_chi2: Option<f64>,
    /// chi2 on the runs held out, of which the stated model and the selected one alone are asked.
    pub holdout_chi2: Option<f64>,
}

/// Fit before and after.
#[derive(Debug, Clone, Serialize)]
pub struct BeforeAfter {
    /// The stated model.
    pub before: FitQuality,
    /// The accepted one.
    pub after: FitQuality,
}

/// One model's fit.
#[derive(Debug, Clone, Serialize)]
pub struct FitQuality {
    /// Mean of (residual / noise)^2.
    pub chi2: f64,
    /// The same of each judged channel.
    pub channel_chi2: BTreeMap<&'static str, f64>,
    /// RMS residual over RMS of the measurement about its mean, by channel.
    pub nrmse: BTreeMap<&'static str, f64>,
    /// 1 - nrmse^2, by channel.
    pub r2: BTreeMap<&'static str, f64>,
}

/// What effects of the library explain of a mismatch that they do not account for.
#[derive(Debug, Clone, Serialize)]
pub struct Part {
    /// The effects.
    pub ids: Vec<&'static str>,
    /// Share of the excess over the noise floor that they take away on the hold-out runs.
    pub share: f64,
}

impl BeforeAfter {
    fn of(conclusion: &Conclusion) -> Self {
        Self { before: FitQuality::of(&conclusion.stated.hold), after: FitQuality::of(&conclusion.accepted.hold) }
    }
}

impl FitQuality {
    fn of(score: &Score) -> Self {
        let nrmse: BTreeMap<_, _> = score.nrmse.iter().map(|&(channel, value)| (channel.name(), value)).collect();
        let r2 = nrmse.iter().map(|(&name, value)| (name, 1.0 - value * value)).collect();
        let channel_chi2 = score.channels.iter().map(|&(channel, chi2, _)| (channel.name(), chi2)).collect();
        Self { chi2: score.chi2, channel_chi2, nrmse, r2 }
    }
}

/// What stays open beside a decision.
#[derive(Debug, Default)]
pub(super) struct Open {
    /// The curve that stands for what is unlisted.
    pub(super) remainder: Option<ResidualCurve>,
    /// The equation found for it.
    pub(super) term: Option<Term>,
    /// The test that would settle what is open.
    pub(super) next_test: Option<NextTest>,
    /// Why none is proposed though something is open.
    pub(super) no_test: Option<String>,
    /// What it changes for who runs the table.
    pub(super) change: Option<Change>,
    /// Whether half of the stretches of the hold-out runs were fitted too.
    pub(super) held_out_shared: bool,
}

/// Puts a diagnosis together.
pub(super) fn assemble(
    prepared: &Prepared,
    conclusion: &Conclusion,
    location: Location,
    open: Open,
    findings: &[Finding],
) -> Diagnosis {
    let verdict = if conclusion.consistent() { Verdict::Consistent } else { Verdict::Mismatch };
    let quantities = quantities(&conclusion.accepted.fit);
    let own = prepared.model.kind.parameters();
    let model = own.iter().filter_map(|p| Some((p.key.to_owned(), quantities.get(p.key)?.clone()))).collect();
    let share = |part: &ScoredModel| 1.0 - (part.hold.chi2 - 1.0) / (conclusion.stated.hold.chi2 - 1.0).max(1e-9);
    Diagnosis {
        schema: "shakedown.diagnosis/1",
        verdict,
        location,
        effects: named(conclusion, &quantities, open.remainder.as_ref(), open.term.as_ref()),
        candidates: candidates(conclusion),
        indistinguishable: if conclusion.unlisted { Vec::new() } else { conclusion.decision.ties.clone() },
        next_test: open.next_test,
        no_test: open.no_test,
        change: open.change,
        holdout: conclusion.held_out.then(|| BeforeAfter::of(conclusion)),
        judged: BeforeAfter::of(conclusion),
        refusal: conclusion.refusal,
        more_missing: conclusion.more_missing,
        rejected: rejected(conclusion),
        model,
        share_left: conclusion.left(),
        part_explained: conclusion.partial.as_ref().map(|part| Part { ids: part.added.clone(), share: share(part) }),
        remainder: open.remainder,
        term: open.term,
        held_out_shared: open.held_out_shared,
        set_up: Vec::new(),
        stated_values_instead: Vec::new(),
        findings: findings.to_vec(),
        seconds: 0.0,
    }
}

fn named(
    conclusion: &Conclusion,
    quantities: &BTreeMap<String, Quantity>,
    remainder: Option<&ResidualCurve>,
    term: Option<&Term>,
) -> Vec<NamedEffect> {
    let decision = &conclusion.decision;
    if conclusion.unlisted {
        let probability = decision.unlisted_probability;
        if let Some(term) = term {
            let (equation, parameters) = (term.expression.clone(), term.parameters.clone());
            return vec![NamedEffect { id: "unlisted", probability, equation, parameters }];
        }
        let equation = remainder.map_or_else(|| "not in the library".to_owned(), |r| r.equation.clone());
        let of = |r: &ResidualCurve| {
            let prefix = format!("{}.", r.id);
            let own = |(key, q): (&String, &Quantity)| Some((key.strip_prefix(&prefix)?.to_owned(), q.clone()));
            quantities.iter().filter_map(own).collect()
        };
        let parameters = remainder.map(of).unwrap_or_default();
        return vec![NamedEffect { id: "unlisted", probability, equation, parameters }];
    }
    let placed =
        conclusion.accepted.fit.model.effects.iter().filter(|p| conclusion.accepted.added.contains(&p.entry.id));
    placed
        .map(|placed| {
            let id = placed.entry.id;
            let keys =
                placed.entry.parameters.iter().filter(|p| p.role != Role::PerRun && !is_code(p.key)).map(|p| p.key);
            NamedEffect {
                id,
                probability: decision.probability(id),
                equation: placed.entry.equation.to_owned(),
                parameters: keys
                    .filter_map(|key| Some((key.to_owned(), quantities.get(&format!("{id}.{key}"))?.clone())))
                    .collect(),
            }
        })
        .collect()
}

fn candidates(conclusion: &Conclusion) -> Vec<Candidate> {
    let decision = &conclusion.decision;
    // The runs held out were asked of the stated model and the selected one alone.
    let judged = [Some(&conclusion.stated), Some(&conclusion.accepted), conclusion.partial.as_ref()];
    let held_out = |ids: &[&str]| {
        let same = |judged: &&ScoredModel| judged.added == ids;
        judged.into_iter().flatten().find(same).filter(|_| conclusion.held_out).map(|judged| judged.hold.chi2)
    };
    let candidate = |c: &ScoredModel| Candidate {
        ids: c.added.clone(),
        probability: c.probability,
        training_chi2: Some(c.fit.chi2()),
        validation_chi2: Some(c.hold.chi2),
        holdout_chi2: held_out(&c.added),
    };
    let mut all: Vec<Candidate> = decision.candidates.iter().map(candidate).collect();
    let probability = decision.unlisted_probability;
    all.push(Candidate {
        ids: vec!["unlisted"],
        probability,
        training_chi2: None,
        validation_chi2: None,
        holdout_chi2: None,
    });
    all.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    all
}
