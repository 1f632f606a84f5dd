//! A campaign of examiner 2 as a page and as tables.

use super::super::page::{GATE_NOTE, coverage, gate_table, key, lead, matrix};
use super::calibration::Bin;
use super::strata::Row;
use super::summary::{Fault, Summary};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};

/// The page of a campaign.
pub fn page(summary: &Summary) -> Page {
    let section = |heading: &str, items: Vec<Item>| Section { heading: heading.into(), items };
    let rows = |rows: &[Row], what: &str| Item::Table(row_table(rows, what));
    let plan = &summary.plan;
    Page {
        title: "Proof on concealed data".into(),
        lead: lead(summary.cases as u64, &summary.gates, summary.failed.len()),
        key: key(summary.cases as u64, &summary.gates),
        sections: vec![
            section("Gates", vec![Item::Table(gate_table(&summary.gates)), Item::Note(GATE_NOTE.into())]),
            section("By stratum", vec![rows(&summary.strata, "Stratum")]),
            section("Confusion matrix", vec![Item::Matrix(matrix(&summary.confusion))]),
            section("Faults of the set-up", vec![Item::Table(fault_table(summary))]),
            section("Probabilities", probabilities(summary)),
            section("Intervals", vec![Item::Table(coverage(&summary.coverage))]),
            section(
                "Single effects",
                vec![rows(&summary.effects, "Effect"), rows(&summary.forms, "Form of the truth")],
            ),
            section("Flaws in no library", vec![rows(&summary.unlisted, "Kind")]),
            section("Every case that was missed", vec![Item::Table(miss_table(summary))]),
        ],
        provenance: vec![
            ("examiner".into(), plan.examiner.to_string()),
            ("seed".into(), plan.seed.to_string()),
            ("lock".into(), plan.lock.to_string()),
            ("cases".into(), summary.cases.to_string()),
            ("engine".into(), plan.engine.clone()),
        ],
        ..Page::default()
    }
}

/// Strata, effects, forms or kinds as a table.
pub fn row_table(rows: &[Row], what: &str) -> Table {
    let figure = |v: Option<f64>, digits: usize| v.map_or_else(|| "\u{2013}".into(), |v| format!("{v:.digits$}"));
    let of = |k: usize, n: usize| if n == 0 { "\u{2013}".into() } else { format!("{k} of {n}") };
    let cells = |row: &Row| {
        let [before, after] = row.chi2.map(|v| figure(v, 2));
        let counts = [row.misnamed, row.consistent, row.more, row.refused].map(|n| n.to_string());
        let mut out = vec![row.name.clone(), of(row.right, row.cases), of(row.named, row.there)];
        out.extend(counts);
        out.extend([
            of(row.block_right, row.placed),
            figure(row.time, 2),
            figure(row.state, 2),
            before,
            after,
            figure(row.left.map(|share| 100.0 * share), 1),
            format!("{:.1}", row.seconds),
            format!("{:.1}", row.seconds_95),
        ]);
        out
    };
    let columns = [
        what,
        "Right",
        "Named",
        "Misnamed",
        "Consistent",
        "More",
        "Refused",
        "Block",
        "F1 time",
        "F1 state",
        "chi2 before",
        "after",
        "Left [%]",
        "Median [s]",
        "95 % [s]",
    ];
    Table {
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(cells).collect(),
        caption: String::new(),
    }
}

/// Faults of the set-up, and claims of faults that are none.
pub fn fault_table(summary: &Summary) -> Table {
    let row = |fault: &Fault| vec![fault.what.clone(), fault.asked.to_string(), fault.reported.to_string()];
    let none =
        |fault: &Fault| vec![format!("claimed, none: {}", fault.what), "\u{2013}".into(), fault.reported.to_string()];
    Table {
        columns: ["Fault of the set-up", "Asked for", "Reported"].map(String::from).to_vec(),
        rows: summary.set_up.iter().map(row).chain(summary.set_up_false.iter().map(none)).collect(),
        caption: String::new(),
    }
}

/// Every miss, one a row.
pub fn miss_table(summary: &Summary) -> Table {
    let rows = summary
        .misses
        .iter()
        .map(|m| vec![m.case.to_string(), m.stratum.clone(), m.truth.clone(), m.set_up.clone(), m.reply.clone()]);
    Table {
        columns: ["Case", "Stratum", "Truth", "Set-up, stated/is", "Reply"].map(String::from).to_vec(),
        rows: rows.collect(),
        caption: "Wrong answers, and `unlisted` where all is listed. Behind a flaw: what it adds to chi2 on the rows \
                  held out, and what it leaves on all rows."
            .into(),
    }
}

fn probabilities(summary: &Summary) -> Vec<Item> {
    let Some(c) = &summary.calibration else { return vec![Item::Text("No probabilities were given.".into())] };
    let of = |f: fn(&Bin) -> f64| c.bins.iter().map(f).collect::<Vec<_>>();
    let bins: Vec<String> =
        c.bins.iter().map(|b| format!("{:.2} stated, {:.2} true ({})", b.stated, b.right, b.statements)).collect();
    let plot = Plot {
        title: "Reliability: how often what is said is true".into(),
        x: Axis { label: "stated probability [1]".into(), log: false },
        y: Axis { label: "share true [1]".into(), log: false },
        series: vec![
            Series { name: "statements".into(), x: of(|b| b.stated), y: of(|b| b.right), style: Style::Points },
            Series { name: "calibrated".into(), x: vec![0.0, 1.0], y: vec![0.0, 1.0], style: Style::Dashed },
        ],
        ..Plot::default()
    };
    let text = format!(
        "{} statements: calibration error {:.3}, of which {:.3} +- {:.3} is expected of perfect ones. {}.",
        c.statements,
        c.error,
        c.expected,
        c.scatter,
        bins.join("; ")
    );
    vec![Item::Plot(plot), Item::Text(text)]
}
