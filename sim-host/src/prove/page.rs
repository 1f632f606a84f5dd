//! The campaign as a page: failures as plain as successes.

use super::gates::{Gate, Limit, SECONDS};
use super::summary::{Beside, Confusion, Coverage, Row, Summary};
use crate::report::{Axis, Item, Matrix, Page, Plot, Section, Series, Shade, Style, Table};

/// The page of a campaign.
pub fn page(summary: &Summary) -> Page {
    let lead = lead(summary.plan.cases, &summary.gates, summary.failed.len());
    let section = |heading: &str, items: Vec<Item>| Section { heading: heading.into(), items };
    Page {
        title: "Proof on concealed data".into(),
        lead,
        key: key(summary.plan.cases, &summary.gates),
        sections: vec![
            section("Gates", vec![Item::Table(gate_table(&summary.gates)), Item::Note(GATE_NOTE.into())]),
            section(
                "Beside other methods",
                vec![Item::Table(beside_table(&summary.beside)), Item::Text(BESIDE.into())],
            ),
            section("By stratum", vec![Item::Table(row_table(&summary.strata, "Stratum", "Cases by what they hold."))]),
            section("Confusion matrix", vec![Item::Matrix(matrix(&summary.confusion))]),
            section("Probabilities", vec![Item::Plot(reliability(summary)), Item::Text(brier(summary))]),
            section("Intervals", vec![Item::Table(coverage(&summary.coverage))]),
            section(
                "Fit on the run held out",
                vec![Item::Table(row_table(&summary.effects, "Effect", "Single effects."))],
            ),
            section("Every case that was missed", vec![Item::Table(misses(summary))]),
        ],
        provenance: vec![
            ("seed".into(), summary.plan.seed.to_string()),
            ("cases".into(), summary.plan.cases.to_string()),
            ("engine".into(), summary.plan.engine.clone()),
        ],
        ..Page::default()
    }
}

/// Gates by how they stand.
pub(super) fn key(cases: u64, gates: &[Gate]) -> Vec<(String, String)> {
    let count = |holds| gates.iter().filter(|g| g.holds == holds).count();
    let of = |n: usize| format!("{n} of {}", gates.len());
    vec![
        ("cases".into(), cases.to_string()),
        ("gates that hold".into(), of(count(Some(true)))),
        ("gates missed".into(), of(count(Some(false)))),
        ("gates undecided or without a case".into(), of(count(None))),
    ]
}

/// What came out, misses first.
pub(super) fn lead(cases: u64, gates: &[Gate], failed: usize) -> String {
    let of = |holds| gates.iter().filter(|g| g.holds == holds).map(|g| g.name.as_str()).collect::<Vec<_>>();
    let missed = of(Some(false));
    let mut text =
        format!("{cases} concealed cases: {} of {} gates hold by the far bound", of(Some(true)).len(), gates.len());
    text +=
        &if missed.is_empty() { "; none is missed.".to_string() } else { format!("; missed: {}.", missed.join("; ")) };
    let empty = gates.iter().filter(|g| g.cases == 0).count();
    let few = of(None).len() - empty;
    if few > 0 {
        text += &format!(" For {few} the cases are too few to decide.");
    }
    if empty > 0 {
        text += &format!(" {empty} gates had no cases.");
    }
    if failed > 0 {
        text += &format!(" {failed} cases were not answered.");
    }
    text
}

pub(super) const GATE_NOTE: &str = "A gate holds where the one-sided 95 % bound (Clopper and Pearson) on the far side of its \
                                    estimate meets the limit, is missed where the near side excludes it, and is undecided \
                                    where the cases are too few for either.";

const BESIDE: &str = "Linear refit: the baseline's parameters re-estimated, a mismatch where the held-out chi2 exceeds \
                      1.08, no name ever. White-noise BIC: forward selection of 13 terms along the predicted motion. \
                      Sparse regression: the same terms by thresholded least squares. On the cases that all could read.";

/// The diagnosis and its rivals, a column a method.
pub fn beside_table(beside: &[Beside]) -> Table {
    let mut columns = vec!["Share [%]".to_string()];
    columns.extend(beside.iter().map(|b| b.name.clone()));
    let gates = beside.first().map_or(0, |b| b.gates.len());
    let row = |i: usize| {
        let mut cells = vec![beside[0].gates[i].name.clone()];
        cells.extend(beside.iter().map(|b| percent(b.gates[i].value)));
        cells
    };
    Table { columns, rows: (0..gates).map(row).collect(), caption: String::new() }
}

fn percent(share: f64) -> String {
    if share.is_nan() { "\u{2013}".into() } else { format!("{:.1}", 100.0 * share) }
}

/// The gates as a table.
pub fn gate_table(gates: &[Gate]) -> Table {
    let rows = gates.iter().map(|gate| {
        let is_share = gate.name != SECONDS;
        let show = |value: f64| match (is_share, value.is_nan()) {
            (_, true) => "\u{2013}".to_string(),
            (true, false) => format!("{} %", percent(value)),
            (false, false) => format!("{value:.2} s"),
        };
        let limit = match gate.limit {
            Limit::AtMost(most) => format!("\u{2264} {}", show(most)),
            Limit::AtLeast(least) => format!("\u{2265} {}", show(least)),
            Limit::Within(least, most) => format!("{} to {}", show(least), show(most)),
        };
        let bounds =
            if is_share { format!("{} to {}", percent(gate.low), percent(gate.high)) } else { "\u{2013}".into() };
        let outcome = match gate.holds {
            Some(true) => "holds",
            Some(false) => "MISSED",
            None if gate.cases == 0 => "no cases",
            None => "undecided",
        };
        vec![gate.name.clone(), show(gate.value), limit, bounds, gate.cases.to_string(), outcome.into()]
    });
    Table {
        columns: ["Gate", "Value", "Limit", "95 % bounds [%]", "Cases", "Outcome"].map(String::from).to_vec(),
        rows: rows.collect(),
        caption: String::new(),
    }
}

/// Strata or effects as a table.
pub fn row_table(rows: &[Row], what: &str, caption: &str) -> Table {
    let figure = |v: Option<f64>| {
        v.map_or_else(|| "\u{2013}".into(), |v| if v < 100.0 { format!("{v:.2}") } else { format!("{v:.0}") })
    };
    let columns = [
        what,
        "Cases",
        "Detected",
        "Right",
        "Misnamed",
        "Unnamed",
        "Points",
        "Brier",
        "chi2 before",
        "after",
        "floor",
        "Time [s]",
    ];
    let cells = |row: &Row| {
        let [before, after, floor] = row.chi2.map(figure);
        let counts = [row.cases, row.detected, row.right, row.misnamed, row.unnamed].map(|n| n.to_string());
        let mut out = vec![row.name.clone()];
        out.extend(counts);
        out.extend([
            format!("{:.2}", row.points),
            figure(row.brier),
            before,
            after,
            floor,
            format!("{:.2}", row.seconds),
        ]);
        out
    };
    Table {
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(cells).collect(),
        caption: caption.into(),
    }
}

pub(super) fn matrix(confusion: &Confusion) -> Matrix {
    Matrix {
        caption: "Nulls, single effects and unlisted flaws: how often each was given which name.".into(),
        rows_are: "truth".into(),
        columns_are: "answer".into(),
        columns: confusion.answers.clone(),
        rows: confusion
            .rows
            .iter()
            .map(|(truth, cells)| (truth.clone(), cells.iter().map(|n| *n as f64).collect()))
            .collect(),
        shade: Shade::OfRow,
    }
}

fn reliability(summary: &Summary) -> Plot {
    let of = |f: fn(&super::summary::Bin) -> f64| summary.reliability.iter().map(f).collect::<Vec<_>>();
    Plot {
        title: "Reliability: how often the most probable set is the true one".into(),
        x: Axis { label: "stated probability [1]".into(), log: false },
        y: Axis { label: "share right [1]".into(), log: false },
        series: vec![
            Series { name: "cases".into(), x: of(|b| b.stated), y: of(|b| b.right), style: Style::Points },
            Series { name: "calibrated".into(), x: vec![0.0, 1.0], y: vec![0.0, 1.0], style: Style::Dashed },
        ],
        ..Plot::default()
    }
}

fn brier(summary: &Summary) -> String {
    let bins: Vec<String> = summary
        .reliability
        .iter()
        .map(|b| format!("{:.2} stated, {:.2} right ({} cases)", b.stated, b.right, b.cases))
        .collect();
    let score =
        summary.brier.map_or_else(|| "no probabilities were given".into(), |b| format!("mean Brier score {b:.3}"));
    if bins.is_empty() { format!("{score}.") } else { format!("{score}. {}.", bins.join("; ")) }
}

pub(super) fn coverage(coverage: &[Coverage]) -> Table {
    let rows = coverage.iter().map(|c| {
        let share = percent(c.covering as f64 / c.intervals as f64);
        vec![c.parameter.clone(), c.intervals.to_string(), share]
    });
    Table {
        columns: ["Parameter", "Intervals", "Covering [%]"].map(String::from).to_vec(),
        rows: rows.collect(),
        caption:
            "90 % intervals of rightly named effects against the value that the library's own equation fits best to \
                  the same case without noise."
                .into(),
    }
}

fn misses(summary: &Summary) -> Table {
    let rows = summary.misses.iter().map(|m| {
        vec![m.case.to_string(), m.stratum.clone(), m.truth.clone(), m.reply.clone(), format!("{:.2}", m.baseline_chi2)]
    });
    Table {
        columns: ["Case", "Stratum", "Truth", "Reply", "chi2 of the baseline"].map(String::from).to_vec(),
        rows: rows.collect(),
        caption: "Wrong sets and wrong verdicts. The chi2 is the examiner's own, without noise.".into(),
    }
}
