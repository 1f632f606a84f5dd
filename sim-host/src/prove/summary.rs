//! A campaign summed up: gates, strata, confusion, reliability, coverage, and the cases that were missed.

use super::campaign::Plan;
use super::gates::{Gate, Scored, gates};
use super::record::Record;
use super::rival;
use super::score::score;
use serde::Serialize;
use std::collections::BTreeMap;

/// A row of the table of strata.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Stratum, with the strength where it has one.
    pub name: String,
    /// Cases.
    pub cases: usize,
    /// Said to be amiss or sound as they were.
    pub detected: usize,
    /// Right sets (or verdicts).
    pub right: usize,
    /// Cases with at least one wrong name.
    pub misnamed: usize,
    /// Cases in which no name was given.
    pub unnamed: usize,
    /// Mean points.
    pub points: f64,
    /// Mean Brier score; none where no probabilities were given.
    pub brier: Option<f64>,
    /// Median held-out chi2 before, after, and what the true set attains.
    pub chi2: [Option<f64>; 3],
    /// Mean seconds a case.
    pub seconds: f64,
}

/// A bin of the reliability diagram.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bin {
    /// Cases whose most probable set has a probability in this bin.
    pub cases: usize,
    /// Their mean probability.
    pub stated: f64,
    /// Share of them that were right.
    pub right: f64,
}

/// Confusion matrix.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Confusion {
    /// Answers, the columns.
    pub answers: Vec<String>,
    /// Truths, the rows, with a count a column. Nulls, single effects and unlisted flaws; a case counts once for each
    /// name it was given.
    pub rows: Vec<(String, Vec<usize>)>,
}

/// Share of intervals that cover, by parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// `ID.key`.
    pub parameter: String,
    /// Intervals.
    pub intervals: usize,
    /// Of them, covering.
    pub covering: usize,
}

/// A method beside the diagnosis, by the same scores.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beside {
    /// The method.
    pub name: String,
    /// The gates that need no probabilities and no intervals, by its replies.
    pub gates: Vec<Gate>,
}

/// A case that went wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Miss {
    /// Number of the case.
    pub case: u64,
    /// What it was about.
    pub stratum: String,
    /// What was there.
    pub truth: String,
    /// What was said.
    pub reply: String,
    /// The examiner's chi2 of the refitted baseline.
    pub baseline_chi2: f64,
}

/// Everything that a campaign shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// The campaign.
    pub plan: Plan,
    /// The gates.
    pub gates: Vec<Gate>,
    /// Strata.
    pub strata: Vec<Row>,
    /// Single effects by strength.
    pub effects: Vec<Row>,
    /// Confusion matrix.
    pub confusion: Confusion,
    /// Stated probability against share right.
    pub reliability: Vec<Bin>,
    /// Mean Brier score; none where no probabilities were given.
    pub brier: Option<f64>,
    /// Intervals by parameter.
    pub coverage: Vec<Coverage>,
    /// The diagnosis and its rivals, on the cases that all of them could read.
    pub beside: Vec<Beside>,
    /// Cases without a reply, and why.
    pub failed: Vec<String>,
    /// Every case that went wrong.
    pub misses: Vec<Miss>,
}

/// Scores and sums up. The same records give the same summary, however many pieces they came in.
pub fn summarise(plan: &Plan, records: &[Record]) -> Summary {
    let all: Vec<Scored<'_>> = records.iter().map(|record| (record, score(record))).collect();
    let by = |key: &dyn Fn(&Record) -> Option<String>| rows(&all, key);
    let strata =
        by(&|record| {
            Some(record.truth.strength.as_ref().map_or_else(
                || record.truth.stratum.clone(),
                |strength| format!("{}, {strength}", record.truth.stratum),
            ))
        });
    let effects = by(&|record| {
        let strength = record.truth.strength.as_deref()?;
        (record.truth.stratum == "single")
            .then(|| format!("{}, {strength}", record.truth.effects.first().map_or("", |e| e.id.as_str())))
    });
    let briers: Vec<f64> = all.iter().filter_map(|s| s.1.brier).collect();
    Summary {
        plan: plan.clone(),
        gates: gates(&all),
        strata,
        effects,
        confusion: confusion(&all),
        reliability: reliability(&all),
        brier: mean(&briers),
        coverage: coverage(&all),
        beside: beside(records),
        failed: records.iter().filter_map(failed).collect(),
        misses: all.iter().filter(|s| !s.1.right).map(miss).collect(),
    }
}

/// Shares of names and sets only: the first five gates.
const NAMING_GATES: usize = 5;

fn beside(records: &[Record]) -> Vec<Beside> {
    let common: Vec<&Record> = records.iter().filter(|r| r.rivals.len() == rival::NAMES.len()).collect();
    let of = |name: &str, replies: Vec<Record>| {
        let scored: Vec<Scored<'_>> = replies.iter().map(|record| (record, score(record))).collect();
        Beside { name: name.into(), gates: gates(&scored).into_iter().take(NAMING_GATES).collect() }
    };
    let mut out = vec![of("diagnosis", common.iter().map(|r| (*r).clone()).collect())];
    for (i, name) in rival::NAMES.iter().enumerate() {
        out.push(of(name, common.iter().map(|r| rival::in_place(r, &r.rivals[i])).collect()));
    }
    out
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

fn rows(all: &[Scored<'_>], key: &dyn Fn(&Record) -> Option<String>) -> Vec<Row> {
    let mut groups: BTreeMap<String, Vec<&Scored<'_>>> = BTreeMap::new();
    for scored in all {
        if let Some(name) = key(scored.0) {
            groups.entry(name).or_default().push(scored);
        }
    }
    groups.into_iter().map(|(name, group)| row(name, &group)).collect()
}

fn row(name: String, group: &[&Scored<'_>]) -> Row {
    let count = |f: &dyn Fn(&Scored<'_>) -> bool| group.iter().filter(|s| f(s)).count();
    let chi2 = |f: &dyn Fn(&Record) -> Option<f64>| median(group.iter().filter_map(|s| f(s.0)).collect());
    let n = group.len() as f64;
    let briers: Vec<f64> = group.iter().filter_map(|s| s.1.brier).collect();
    Row {
        name,
        cases: group.len(),
        detected: count(&|s| s.1.detected),
        right: count(&|s| s.1.right),
        misnamed: count(&|s| !s.1.wrong_names.is_empty()),
        unnamed: count(&|s| s.0.reply.effects.is_empty()),
        points: group.iter().map(|s| s.1.points).sum::<f64>() / n,
        brier: mean(&briers),
        chi2: [
            chi2(&|r| r.reply.holdout.before.chi2),
            chi2(&|r| r.reply.holdout.after.chi2),
            chi2(&|r| r.attainable.as_ref().and_then(|a| a.floor)),
        ],
        seconds: group.iter().map(|s| s.0.seconds).sum::<f64>() / n,
    }
}

pub(super) fn confusion(all: &[Scored<'_>]) -> Confusion {
    let mut counts: BTreeMap<String, BTreeMap<String, usize>> = BTreeMap::new();
    for (record, _) in all {
        let truth = match record.truth.stratum.as_str() {
            "null" => "(null)".to_string(),
            "unlisted" => "(unlisted)".to_string(),
            "single" => record.truth.effects.first().map_or_else(String::new, |e| e.id.clone()),
            _ => continue,
        };
        let row = counts.entry(truth).or_default();
        let reply = &record.reply;
        let names: Vec<String> = match (reply.verdict.as_str(), reply.effects.is_empty()) {
            ("consistent", true) => vec!["(consistent)".into()],
            ("bad-data", true) => vec!["(bad data)".into()],
            (_, true) => vec!["(unnamed)".into()],
            _ => reply.effects.iter().map(|e| e.id.clone()).collect(),
        };
        for name in names {
            *row.entry(name).or_default() += 1;
        }
    }
    let mut answers: Vec<String> = counts.values().flat_map(|row| row.keys().cloned()).collect();
    answers.extend(counts.keys().filter(|name| !name.starts_with('(')).cloned());
    answers.sort();
    answers.dedup();
    let rows = counts
        .into_iter()
        .map(|(truth, row)| {
            let cells = answers.iter().map(|name| row.get(name).copied().unwrap_or(0)).collect();
            (truth, cells)
        })
        .collect();
    Confusion { answers, rows }
}

/// Ten bins of equal width; empty ones are left out.
fn reliability(all: &[Scored<'_>]) -> Vec<Bin> {
    let mut bins = [(0_usize, 0.0, 0_usize); 10];
    for (_, score) in all {
        if let Some((stated, right)) = score.confidence {
            let bin = &mut bins[((stated * 10.0) as usize).min(9)];
            *bin = (bin.0 + 1, bin.1 + stated, bin.2 + usize::from(right));
        }
    }
    bins.iter()
        .filter(|bin| bin.0 > 0)
        .map(|&(cases, sum, right)| Bin { cases, stated: sum / cases as f64, right: right as f64 / cases as f64 })
        .collect()
}

pub(super) fn coverage(all: &[Scored<'_>]) -> Vec<Coverage> {
    let mut counts: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (parameter, covers) in all.iter().flat_map(|(_, score)| &score.covered) {
        let entry = counts.entry(parameter.clone()).or_default();
        *entry = (entry.0 + 1, entry.1 + usize::from(*covers));
    }
    counts.into_iter().map(|(parameter, (intervals, covering))| Coverage { parameter, intervals, covering }).collect()
}

fn failed(record: &Record) -> Option<String> {
    let why = record.reply.failure.as_deref().unwrap_or("no verdict");
    (record.reply.verdict == "failed").then(|| format!("case {}: {why}", record.case))
}

fn miss((record, _): &Scored<'_>) -> Miss {
    let truth = &record.truth;
    let there = match (&truth.unlisted, &truth.fault) {
        (Some(name), _) => name.clone(),
        (_, Some(fault)) => {
            let part = |key: &str| fault.get(key).and_then(serde_json::Value::as_str).unwrap_or("").to_string();
            format!("{} {}", part("channel"), part("problem"))
        }
        _ => truth.effects.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(" + "),
    };
    let reply = &record.reply;
    let names = reply.effects.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(" + ");
    let said = reply.failure.as_ref().map_or_else(|| format!("{} {names}", reply.verdict), |f| format!("failed: {f}"));
    Miss {
        case: record.case,
        stratum: truth.stratum.clone(),
        truth: there,
        reply: said.trim().to_string(),
        baseline_chi2: truth.baseline_chi2,
    }
}
