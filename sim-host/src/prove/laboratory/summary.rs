//! A campaign of examiner 2 summed up.

use super::super::campaign::Plan;
use super::super::gates::Gate;
use super::super::record::{Record, Truth};
use super::super::summary::{Confusion, Coverage, confusion, coverage};
use super::calibration::{Calibration, calibration};
use super::gates::gates;
use super::outcome::{ScoredModel, judge};
use super::strata::{Row, rows, strata};
use serde::Serialize;
use std::collections::BTreeMap;

/// How often a kind of fault was reported.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fault {
    /// Kind.
    pub what: String,
    /// Faults of it that were asked for; of false claims, zero.
    pub asked: usize,
    /// Of them, reported; of false claims, how many.
    pub reported: usize,
}

/// A case that went wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Miss {
    /// Number of the case.
    pub case: u64,
    /// Stratum.
    pub stratum: String,
    /// What is there, with what each adds to chi2.
    pub truth: String,
    /// What of the set-up is not as stated.
    pub set_up: String,
    /// What was said.
    pub reply: String,
}

/// Everything that a campaign shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The campaign.
    pub plan: Plan,
    /// Cases that it rests on.
    pub cases: usize,
    /// The gates.
    pub gates: Vec<Gate>,
    /// Strata.
    pub strata: Vec<Row>,
    /// Single effects by strength.
    pub effects: Vec<Row>,
    /// Single effects by the form of their truth.
    pub forms: Vec<Row>,
    /// Unlisted kinds.
    pub unlisted: Vec<Row>,
    /// Faults of the set-up by kind.
    pub set_up: Vec<Fault>,
    /// Claims of faults that are none, by kind.
    pub set_up_false: Vec<Fault>,
    /// Confusion matrix.
    pub confusion: Confusion,
    /// Probabilities against truth; none where no probabilities were given.
    pub calibration: Option<Calibration>,
    /// Intervals by parameter.
    pub coverage: Vec<Coverage>,
    /// Cases without a reply, and why.
    pub failed: Vec<String>,
    /// Every case that went wrong.
    pub misses: Vec<Miss>,
}

/// Scores and sums up. The same records give the same summary, however many pieces they came in.
pub fn summarise(plan: &Plan, records: &[Record]) -> Summary {
    let all: Vec<ScoredModel<'_>> = records.iter().map(|record| (record, judge(record))).collect();
    let scored: Vec<_> = all.iter().map(|j| (j.0, j.1.score.clone())).collect();
    let single = |r: &Record| r.truth.effects.first().filter(|_| r.truth.stratum == "single").cloned();
    let strength = |r: &Record| r.truth.strength.clone().unwrap_or_default();
    let statements: Vec<(f64, bool)> = all.iter().flat_map(|j| j.1.statements.clone()).collect();
    Summary {
        plan: plan.clone(),
        cases: records.len(),
        gates: gates(&all),
        strata: rows(&all, strata),
        effects: rows(&all, |r| single(r).map(|e| format!("{}, {}", e.id, strength(r))).into_iter().collect()),
        forms: rows(&all, |r| single(r).map(|e| format!("{}: {}", e.id, e.form)).into_iter().collect()),
        unlisted: rows(&all, |r| {
            r.truth.unlisted.clone().filter(|_| r.truth.stratum == "unlisted").into_iter().collect()
        }),
        set_up: faults(&all),
        set_up_false: false_claims(&all),
        confusion: confusion(&scored),
        calibration: calibration(&statements),
        coverage: coverage(&scored),
        failed: records.iter().filter_map(failed).collect(),
        misses: all.iter().filter(|j| !j.1.right || j.1.false_unlisted).map(miss).collect(),
    }
}

fn faults(all: &[ScoredModel<'_>]) -> Vec<Fault> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (what, found) in all.iter().flat_map(|j| &j.1.faults) {
        let entry = counts.entry(what).or_default();
        *entry = (entry.0 + 1, entry.1 + usize::from(*found));
    }
    counts.into_iter().map(|(what, (asked, reported))| Fault { what: what.into(), asked, reported }).collect()
}

fn false_claims(all: &[ScoredModel<'_>]) -> Vec<Fault> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for what in all.iter().flat_map(|j| &j.1.false_faults) {
        *counts.entry(what).or_default() += 1;
    }
    counts.into_iter().map(|(what, reported)| Fault { what: what.into(), asked: 0, reported }).collect()
}

fn failed(record: &Record) -> Option<String> {
    let why = record.reply.failure.as_deref().unwrap_or("no verdict");
    (record.reply.verdict == "failed").then(|| format!("case {}: {why}", record.case))
}

fn miss((record, outcome): &ScoredModel<'_>) -> Miss {
    let strength = record.truth.strength.as_ref().map_or(String::new(), |s| format!(", {s}"));
    Miss {
        case: record.case,
        stratum: format!("{}{strength}", record.truth.stratum),
        truth: there(&record.truth),
        set_up: set_up(&record.truth),
        reply: said(record, outcome.more),
    }
}

fn there(truth: &Truth) -> String {
    if let Some(fault) = &truth.fault {
        return fault.to_string();
    }
    let each = truth.effects.iter().chain(&truth.unlisted_kinds).map(|p| {
        let form = if p.form == p.id { String::new() } else { format!(" as {}", p.form) };
        let excess = p.excess.map_or(String::new(), |x| format!(" +{x:.3}"));
        let sigma = p.sigma.map_or(String::new(), |x| format!(" {x:.0} s.d."));
        format!("{}{form} at {}{excess}{sigma}", p.id, p.block)
    });
    let all = each.collect::<Vec<_>>().join("; ");
    if all.is_empty() { "nothing".into() } else { all }
}

fn set_up(truth: &Truth) -> String {
    let odd = truth.set_up.iter().filter(|m| m.what != "noise estimated");
    let each = odd.map(|m| {
        let channel = if m.channel.is_empty() { String::new() } else { format!(" {}", m.channel) };
        let stated = m.stated.map_or("not stated".into(), |s| format!("{s:.3e}"));
        format!("{}{channel} {stated}/{:.3e}", m.what, m.is)
    });
    each.collect::<Vec<_>>().join(", ")
}

fn said(record: &Record, more: bool) -> String {
    let reply = &record.reply;
    if let Some(failure) = &reply.failure {
        return format!("failed: {failure}");
    }
    let name = |e: &super::super::record::Named| e.probability.map_or(e.id.clone(), |p| format!("{} p {p:.3}", e.id));
    let mut text = format!("{} {}", reply.verdict, reply.effects.iter().map(name).collect::<Vec<_>>().join(" + "));
    if more && !reply.effects.iter().any(|e| e.id == "unlisted") {
        text += " and more";
    }
    for tie in &reply.indistinguishable {
        text += &format!(" (or {})", tie.join("|"));
    }
    let chi2 = &reply.holdout;
    if let (Some(before), Some(after)) = (chi2.before.chi2, chi2.after.chi2) {
        text += &format!("; chi2 {before:.2} to {after:.2}");
    }
    let claims: Vec<&str> = reply.set_up.iter().map(|f| f.what.as_str()).collect();
    let data: Vec<&str> = reply.findings.iter().map(|f| f.fault.as_str()).collect();
    if claims.len() + data.len() > 0 {
        text += &format!("; set-up {}", [claims, data].concat().join(", "));
    }
    text.trim().to_string()
}
