//! The gates of examiner 2.

use super::super::gates::{Gate, Limit};
use super::super::record::Record;
use super::outcome::{Outcome, ScoredModel};
use super::{calibration, strata};
use crate::plant::effects::{ENTRIES, Family};
use std::collections::BTreeMap;

/// Longest processor time that 95 % of the cases may take (s).
const SECONDS: f64 = 30.0;

struct Table<'a> {
    all: &'a [ScoredModel<'a>],
    gates: Vec<Gate>,
}

impl Table<'_> {
    /// A gate on the share of those that meet `yes` among those that meet `who`.
    fn share(
        &mut self,
        name: &str,
        limit: Limit,
        who: impl Fn(&Record, &Outcome) -> bool,
        yes: impl Fn(&Record, &Outcome) -> bool,
    ) {
        let those = self.all.iter().filter(|j| who(j.0, &j.1));
        let (n, k) = those.fold((0, 0), |(n, k), j| (n + 1, k + usize::from(yes(j.0, &j.1))));
        self.gates.push(Gate::share(name, k, n, limit));
    }

    /// A gate on a mean of values between 0 and 1, its bounds from their scatter.
    fn mean(&mut self, name: &str, least: f64, value: impl Fn(&Outcome) -> Option<f64>) {
        let values: Vec<f64> = self.all.iter().filter_map(|j| value(&j.1)).collect();
        let n = values.len() as f64;
        let mean = strata::mean(values.iter().copied()).unwrap_or(f64::NAN);
        let scatter = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0)).sqrt();
        // A few values say little of their own scatter.
        let half = if values.len() < 10 { 1.0 } else { 1.7 * scatter / n.sqrt() };
        let bounds = ((mean - half).max(0.0), (mean + half).min(1.0));
        self.gates.push(Gate::bounded(name, mean, bounds, values.len(), Limit::AtLeast(least)));
    }
}

fn of(stratum: &'static str) -> impl Fn(&Record, &Outcome) -> bool {
    move |record, _| record.truth.stratum == stratum
}

fn single(strength: &'static str) -> impl Fn(&Record, &Outcome) -> bool {
    move |r, _| r.truth.stratum == "single" && r.truth.strength.as_deref() == Some(strength)
}

fn visible(record: &Record) -> bool {
    matches!(record.truth.strength.as_deref(), Some("clear" | "gross"))
}

fn misnamed(_: &Record, outcome: &Outcome) -> bool {
    !outcome.score.wrong_names.is_empty()
}

fn right(_: &Record, outcome: &Outcome) -> bool {
    outcome.right
}

/// All gates; an empty one says that its cases were not dealt.
pub(super) fn gates(all: &[ScoredModel<'_>]) -> Vec<Gate> {
    use Limit::{AtLeast, AtMost};
    let mut t = Table { all, gates: Vec::new() };
    let null =
        |perfect: bool| move |r: &Record, _: &Outcome| r.truth.stratum == "null" && r.truth.perfect_set_up == perfect;
    t.share("nulls, set-up as stated: falsely named", AtMost(0.01), null(true), misnamed);
    t.share("nulls, faults in the set-up: falsely named", AtMost(0.01), null(false), misnamed);
    t.share("nulls not called consistent", AtMost(0.05), of("null"), |r, _| r.reply.verdict != "consistent");
    t.share("right names, gross effect", AtLeast(0.95), single("gross"), right);
    t.share("right names, clear effect", AtLeast(0.85), single("clear"), right);
    let faulty = |r: &Record, _: &Outcome| r.truth.stratum == "single" && visible(r) && !r.truth.perfect_set_up;
    t.share("right names, clear or gross, faults in the set-up", AtLeast(0.85), faulty, right);
    t.share("wrong names, clear or gross, faults in the set-up", AtMost(0.03), faulty, misnamed);
    t.share("right names, any pair", AtLeast(0.80), of("pair"), right);
    t.share(
        "right names, pair at one place or of one family",
        AtLeast(0.85),
        |r, _| r.truth.stratum == "pair" && strata::close(r),
        right,
    );
    t.share("right names, triple", AtLeast(0.80), of("triple"), right);
    t.share("listed named and more said to be missing", AtLeast(0.80), of("listed with unlisted"), right);
    t.share(
        "wrong name for an unlisted flaw",
        AtMost(0.05),
        |r, _| r.truth.stratum.ends_with("unlisted") && r.truth.effects.is_empty(),
        misnamed,
    );
    t.share(
        "unlisted said where all is listed",
        AtMost(0.05),
        |r, _| r.truth.unlisted.is_none() && r.truth.fault.is_none(),
        |_, o| o.false_unlisted,
    );
    t.share("tie stated where the data do not tell apart", AtLeast(0.80), of("confounded"), right);
    faults(&mut t);
    t.share("good recordings refused", AtMost(0.005), |r, _| r.truth.fault.is_none(), |_, o| o.refused);
    t.share("bad recordings recognised", AtLeast(0.95), |r, _| r.truth.fault.is_some(), |_, o| o.refused);
    located(&mut t);
    t.share(
        "unlisted flaw modelled: 90 % of the excess removed",
        AtLeast(0.60),
        |_, o| o.modelled.is_some(),
        |_, o| o.modelled.is_some_and(|share| share >= 0.9),
    );
    let statements: Vec<(f64, bool)> = all.iter().flat_map(|j| j.1.statements.clone()).collect();
    t.gates.extend(calibration::gates(&statements));
    t.gates.extend(families(all));
    t.share("seconds a case at most 30", AtLeast(0.95), |_, _| true, |r, _| r.seconds <= SECONDS);
    t.gates
}

fn faults(t: &mut Table<'_>) {
    let each: Vec<bool> = t.all.iter().flat_map(|j| j.1.faults.iter().map(|f| f.1)).collect();
    let found = each.iter().filter(|found| **found).count();
    t.gates.push(Gate::share("faults of the set-up reported", found, each.len(), Limit::AtLeast(0.90)));
    t.share(
        "faults of the set-up claimed that are none",
        Limit::AtMost(0.05),
        |r, _| r.truth.fault.is_none(),
        |_, o| !o.false_faults.is_empty(),
    );
}

fn located(t: &mut Table<'_>) {
    let one = |r: &Record, _: &Outcome| visible(r) && matches!(r.truth.stratum.as_str(), "single" | "located");
    t.share("block right, clear or gross effect", Limit::AtLeast(0.95), one, |_, o| o.block == Some(true));
    t.share("block right, unlisted flaw", Limit::AtLeast(0.80), of("unlisted"), |_, o| o.block == Some(true));
    t.mean("F1 over time, flaw in a part of the run", 0.85, |o| o.time);
    t.mean("F1 over state, flaw in a region", 0.80, |o| o.state);
}

/// Coverage of the 90 % intervals by family of effects.
fn families(all: &[ScoredModel<'_>]) -> Vec<Gate> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for (parameter, covers) in all.iter().flat_map(|j| &j.1.score.covered) {
        let entry = counts.entry(family(parameter)).or_default();
        *entry = (entry.0 + usize::from(*covers), entry.1 + 1);
    }
    let gate = |(name, (k, n)): (&str, (usize, usize))| {
        Gate::share(format!("90 % intervals cover: {name}"), k, n, Limit::Within(0.85, 0.95))
    };
    counts.into_iter().map(gate).collect()
}

/// Family of an effect's parameter `ID.key`; what is no effect of the library is a sensor's.
fn family(parameter: &str) -> &'static str {
    let id = parameter.split('.').next().unwrap_or_default();
    ENTRIES.iter().find(|entry| entry.id == id).map_or(Family::Sensors, |entry| entry.family).name()
}
