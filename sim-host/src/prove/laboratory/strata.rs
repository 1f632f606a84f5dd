//! Tables of a campaign: cases by what they hold.

use super::super::record::Record;
use super::outcome::{ScoredModel, left};
use serde::Serialize;
use std::collections::BTreeMap;

/// A row of the table of strata. A case may stand in several rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What its cases hold.
    pub name: String,
    /// Cases.
    pub cases: usize,
    /// Right in whole.
    pub right: usize,
    /// With at least one wrong name.
    pub misnamed: usize,
    /// Listed effects that are there.
    pub there: usize,
    /// Of them, named.
    pub named: usize,
    /// Cases said to be consistent.
    pub consistent: usize,
    /// Cases said to lack something that has no name.
    pub more: usize,
    /// Cases refused as bad data.
    pub refused: usize,
    /// Cases with a block to be found.
    pub placed: usize,
    /// Of them, with the right block.
    pub block_right: usize,
    /// Mean F1 over time; none where no flaw is switched.
    pub time: Option<f64>,
    /// Mean F1 over the state region; none where no flaw is bound to one.
    pub state: Option<f64>,
    /// Median of the held-out chi2 before and after.
    pub chi2: [Option<f64>; 2],
    /// Median share of the excess that the library's best fit leaves without noise; none where it was not asked for.
    pub left: Option<f64>,
    /// Median processor time a case (s).
    pub seconds: f64,
    /// Processor time that 95 % of the cases stay below (s).
    pub seconds_95: f64,
}

/// Strata by which a case is counted.
pub(super) fn strata(record: &Record) -> Vec<String> {
    let truth = &record.truth;
    let mut out = vec![truth.stratum.clone()];
    let strength = truth.strength.as_deref().unwrap_or("");
    match truth.stratum.as_str() {
        "null" if truth.perfect_set_up => out.push("null, set-up as stated".into()),
        "null" => out.push("null, faults in the set-up".into()),
        "single" => out.push(format!("single, {strength}")),
        "pair" => {
            let blocks: Vec<&str> = truth.effects.iter().map(|e| e.block.as_str()).collect();
            if blocks.windows(2).any(|b| b[0] == b[1]) {
                out.push("pair, one place".into());
            }
            if truth.one_family {
                out.push("pair, one family".into());
            }
            if !close(record) {
                out.push("pair, neither".into());
            }
            let faint = |e: &super::super::record::TrueEffect| e.excess.is_some_and(|x| x < 5.0);
            if truth.effects.iter().any(faint) && !truth.effects.iter().all(faint) {
                out.push("pair, faint beside clear".into());
            }
        }
        "located" if truth.location.time.is_empty() => out.push("located, in a region of state".into()),
        "located" => out.push("located, in a part of the run".into()),
        _ => {}
    }
    out
}

/// Whether two of the flaws act at one place or are of one family.
pub(super) fn close(record: &Record) -> bool {
    let effects = &record.truth.effects;
    record.truth.one_family || effects.iter().enumerate().any(|(i, a)| effects[..i].iter().any(|b| a.block == b.block))
}

/// Rows by the keys of each case, in their order.
pub(super) fn rows(all: &[ScoredModel<'_>], keys: impl Fn(&Record) -> Vec<String>) -> Vec<Row> {
    let mut groups: BTreeMap<String, Vec<&ScoredModel<'_>>> = BTreeMap::new();
    for judged in all {
        for key in keys(judged.0) {
            groups.entry(key).or_default().push(judged);
        }
    }
    groups.into_iter().map(|(name, group)| row(name, &group)).collect()
}

fn row(name: String, group: &[&ScoredModel<'_>]) -> Row {
    let count = |f: &dyn Fn(&ScoredModel<'_>) -> bool| group.iter().filter(|j| f(j)).count();
    let chi2 = |f: &dyn Fn(&Record) -> Option<f64>| quantile(group.iter().filter_map(|j| f(j.0)).collect(), 0.5);
    let seconds = |share: f64| quantile(group.iter().map(|j| j.0.seconds).collect(), share).unwrap_or(0.0);
    Row {
        name,
        cases: group.len(),
        right: count(&|j| j.1.right),
        misnamed: count(&|j| !j.1.score.wrong_names.is_empty()),
        there: group.iter().map(|j| j.0.truth.effects.len()).sum(),
        named: group.iter().map(|j| j.1.found).sum(),
        consistent: count(&|j| j.0.reply.verdict == "consistent"),
        more: count(&|j| j.1.more),
        refused: count(&|j| j.1.refused),
        placed: count(&|j| j.1.block.is_some()),
        block_right: count(&|j| j.1.block == Some(true)),
        time: mean(group.iter().filter_map(|j| j.1.time)),
        state: mean(group.iter().filter_map(|j| j.1.state)),
        chi2: [chi2(&|r| r.reply.holdout.before.chi2), chi2(&|r| r.reply.holdout.after.chi2)],
        left: quantile(group.iter().filter_map(|j| left(j.0)).collect(), 0.5),
        seconds: seconds(0.5),
        seconds_95: seconds(0.95),
    }
}

/// Mean of values; none of none.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (n, sum) = values.fold((0_usize, 0.0), |(n, sum), v| (n + 1, sum + v));
    (n > 0).then(|| sum / n as f64)
}

/// The value below which `share` of the values lie.
pub(super) fn quantile(mut values: Vec<f64>, share: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let at = share * values.len().saturating_sub(1) as f64;
    let (below, above) = (at.floor() as usize, at.ceil() as usize);
    let part = at - at.floor();
    Some((1.0 - part) * values.get(below)? + part * values.get(above)?)
}
