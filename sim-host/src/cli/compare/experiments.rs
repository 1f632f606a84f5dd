//! Two experiments: what changed on a table between two dates.

use super::super::output::{print, print_table};
use super::super::{Failure, failure, progress};
use super::Args;
use crate::identify::change::{Change, CompareError, compare};
use crate::identify::outcome::IdentifyError;
use crate::recording::Experiment;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;
use std::path::PathBuf;

/// Fits both, compares and shows.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let load = |path: &PathBuf| Experiment::load(path).map_err(|e| failure::refused(path, e, failure::EXPERIMENT));
    let (before, after) = (load(&args.first)?, load(&args.second)?);
    let spinner = progress::spinner("fitting both".into());
    let changes = compare(&before, &after);
    spinner.finish_and_clear();
    let changes = changes.map_err(|e| match e {
        CompareError::Fit { problem: IdentifyError::Simulate(_), .. } => Failure::Work(e.to_string()),
        other => Failure::Input(format!("{} and {}: {other}", args.first.display(), args.second.display())),
    })?;
    let inputs: Vec<PathBuf> = before.inputs.iter().chain(&after.inputs).cloned().collect();
    args.outputs.write_json(json!({ "changes": changes, "changed": changed(&changes) }), &inputs)?;
    let (lead, table) = (lead(&changes), table(&changes));
    if !args.outputs.quiet() {
        print_table(&table);
        print(&format!("\n{lead}\n"));
    }
    let sections = vec![Section { heading: "Number by number".into(), items: vec![Item::Table(table)] }];
    let title = format!("{} and {}", before.name, after.name);
    args.outputs.write_report(&mut Page { title, lead, sections, ..Page::default() }, &inputs)
}

fn changed(changes: &[Change]) -> Vec<&str> {
    changes.iter().filter(|c| c.changed == Some(true)).map(|c| c.name.as_str()).collect()
}

fn lead(changes: &[Change]) -> String {
    let told = |c: &Change| match c.share {
        Some(share) => format!("{} by {:+.1} %", c.name, 100.0 * share),
        None => format!("{} by {:+.4} {}", c.name, c.difference, c.unit),
    };
    let certain: Vec<String> = changes.iter().filter(|c| c.changed == Some(true)).map(told).collect();
    let open: Vec<&str> = changes.iter().filter(|c| c.changed.is_none()).map(|c| c.name.as_str()).collect();
    let mut text = if certain.is_empty() {
        "Nothing changed by more than chance allows.".to_owned()
    } else {
        format!("Changed: {}.", certain.join(", "))
    };
    if !open.is_empty() {
        text += &format!(" Not determined by these runs: {}.", open.join(", "));
    }
    text
}

fn table(changes: &[Change]) -> Table {
    let number = |v: Option<f64>| v.map_or_else(|| "open".to_owned(), |v| format!("{v:.5}"));
    let row = |c: &Change| {
        let verdict = match c.changed {
            Some(true) => "changed",
            Some(false) => "the same",
            None => "not determined",
        };
        let values = [Some(c.before), Some(c.after), Some(c.difference), c.low, c.high].map(number);
        std::iter::once(c.name.clone()).chain(values).chain([c.unit.to_owned(), verdict.to_owned()]).collect()
    };
    let columns = ["parameter", "before", "after", "difference", "90 % from", "90 % to", "unit", "verdict"];
    Table {
        columns: columns.map(String::from).into(),
        rows: changes.iter().map(row).collect(),
        caption: "One model fitted to both dates".into(),
    }
}
