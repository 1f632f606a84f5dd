//! The benchmark's page: who does best where, at a glance, then table by table.

use super::{HELD, HOW, quartiles, sensed, three};
use crate::closed_loop::bench::figures::Figure;
use crate::closed_loop::bench::{Bench, Row};
use crate::report::{Item, Matrix, Page, Section, Shade};

/// The page; the sections of single tables are folded.
pub(super) fn page(held: &[Figure], benches: &[Bench], rows: &[Row], sections: Vec<Section>) -> Page {
    let (mut lead, mut key) = (Vec::new(), Vec::new());
    if !held.is_empty() {
        let holding = held.iter().filter(|f| f.holds()).count();
        lead.push(format!("{holding} of {} figures hold their bounds.", held.len()));
        key.push(("figures that hold".to_owned(), format!("{holding} of {}", held.len())));
    }
    let best: Vec<&Row> = benches.iter().filter_map(|bench| best(bench, rows)).collect();
    for row in &best {
        key.push((format!("least median E_a on {}: {}", row.table, row.contender.title()), three(median(row))));
    }
    lead.extend(verdict(&best));
    let at_once = (!rows.is_empty())
        .then(|| Section { heading: "At a glance".into(), items: vec![Item::Matrix(glance(benches, rows))] });
    let (first, details): (Vec<Section>, _) = sections.into_iter().partition(|s| s.heading == HELD || s.heading == HOW);
    let sections = at_once.into_iter().chain(first).collect();
    Page { title: "Benchmark".into(), lead: lead.join(" "), key, sections, details, ..Page::default() }
}

fn median(row: &Row) -> f64 {
    quartiles(row, &sensed).median
}

/// Who has the least error on a table.
fn best<'a>(bench: &Bench, rows: &'a [Row]) -> Option<&'a Row> {
    rows.iter().filter(|row| row.table == bench.name).min_by(|a, b| median(a).total_cmp(&median(b)))
}

/// Who is best on most tables, in a sentence.
fn verdict(best: &[&Row]) -> Option<String> {
    let wins = |name: &str| best.iter().filter(|row| row.contender.title() == name).count();
    let most = best.iter().map(|row| row.contender.title()).max_by_key(|name| wins(name))?;
    Some(format!(
        "With the table's sensors {most} has the least median E_a on {} of {} tables, over records fitted to what each can do; \
         every controller is tuned by the margins of its loop, never on a record.",
        wins(&most),
        best.len()
    ))
}

/// Every controller on every table.
fn glance(benches: &[Bench], rows: &[Row]) -> Matrix {
    let mut names: Vec<String> = Vec::new();
    for name in rows.iter().map(|row| row.contender.title()) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let value = |name: &str, bench: &Bench| {
        let row = rows.iter().find(|row| row.table == bench.name && row.contender.title() == name);
        row.map(median).filter(|v| *v < 10.0).unwrap_or(f64::NAN)
    };
    Matrix {
        caption:
            "Median E_a with the table's sensors, both sides low-passed at 15 Hz; empty where the loop is unstable"
                .into(),
        rows_are: "controller".into(),
        columns_are: "table".into(),
        columns: benches.iter().map(|bench| bench.name.to_owned()).collect(),
        rows: names
            .into_iter()
            .map(|name| (name.clone(), benches.iter().map(|bench| value(&name, bench)).collect()))
            .collect(),
        shade: Shade::OfLargest,
    }
}
