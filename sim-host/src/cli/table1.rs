//! `shakedown table1`: the paper's Table 1, side by side with the paper's figures.

mod fitted;
mod notes;
mod records;

use super::output::Outputs;
use super::{Failure, present, progress};
use crate::closed_loop::published::{Event, Named};
use crate::closed_loop::table1::fitted::{self as fits, FittedRow};
use crate::closed_loop::table1::{Case, Check, Reading, Row, checks, rows};
use crate::closed_loop::trial::Scores;
use crate::plant::sensors::GRAVITY;
use crate::report::{Axis, Band, Item, Page, Plot, Section, Series, Style, Table};
use records::Source;
use serde_json::json;
use std::path::PathBuf;

/// The paper's Table 1: eight controllers, three records, every figure beside the paper's.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown table1                                    with generated stand-ins for the three records
  shakedown table1 --records DIR --report table1.html
  shakedown table1 --records DIR --json -
  shakedown table1 --records DIR --table found.toml   what the same gains do on the table that was diagnosed

DIR holds the PEER files of Kobe (KJM000), El Centro (RSN6 or IELC180) and Taft (TAF021).")]
pub(crate) struct Args {
    /// Folder with the three records; without one, generated motions of the same peaks stand in.
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// The table's model file, as `identify` and `diagnose --model` write it, instead of the paper's table.
    #[arg(long, value_name = "TABLE.toml")]
    table: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Runs the table, prints it, writes `--json` and `--report`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let sources = records::find(args.records.as_deref())?;
    let cases = sources.iter().map(Source::case).collect::<Result<Vec<_>, _>>()?;
    let table = super::table(args.table.as_deref())?;
    let asked: Vec<(Named, Reading)> =
        Named::ALL.iter().flat_map(|&named| Reading::apply_to(named).iter().map(move |&r| (named, r))).collect();
    let bar = progress::bar((cases.len() * (asked.len() + fits::ROWS.len())) as u64, "rows");
    let rows = rows(&cases, &asked, &table, || bar.inc(1)).map_err(|e| Failure::Work(format!("table1: {e}")))?;
    let fitted = fits::rows(&cases, &table, || bar.inc(1)).map_err(|e| Failure::Work(format!("table1: {e}")))?;
    bar.finish_and_clear();
    let real = sources.iter().all(|source| source.path().is_some());
    let held = if real && args.table.is_none() { checks(&rows) } else { Vec::new() };
    let sections = sections(&cases, &rows, &fitted, &held, real);
    if !args.outputs.quiet() {
        sections.iter().for_each(present::print_section);
    }
    let inputs: Vec<PathBuf> =
        sources.iter().filter_map(|s| s.path().map(PathBuf::from)).chain(args.table.clone()).collect();
    args.outputs.write_json(json(&cases, &rows, &fitted, &held), &inputs)?;
    let lead = "Eight controllers on three records: the control core against the paper's plant, sensors off. Each figure \
                stands beside the paper's; none was tuned toward it. Beside them, what Strong does with records fitted to \
                the table.";
    let mut sections = sections;
    // The notes on reading stand last.
    let details = sections.pop().into_iter().collect();
    let mut page = Page { title: "Table 1".into(), lead: lead.into(), sections, details, ..Page::default() };
    args.outputs.write_report(&mut page, &inputs)
}

/// The page, record by record, then what is held to bounds and what the figures mean.
fn sections(cases: &[Case], rows: &[Row], fitted: &[FittedRow], held: &[Check], real: bool) -> Vec<Section> {
    let mut sections: Vec<Section> = cases.iter().map(|case| section(case, rows, fitted)).collect();
    if !held.is_empty() {
        let items = vec![Item::Table(check_table(held))];
        sections.push(Section { heading: "Figures held to bounds".into(), items });
    }
    let items = notes::all(real).into_iter().map(Item::Note).collect();
    sections.push(Section { heading: "How to read it, and what cannot be reached".into(), items });
    sections
}

fn section(case: &Case, rows: &[Row], fitted: &[FittedRow]) -> Section {
    let here: Vec<&Row> = rows.iter().filter(|row| row.event == case.event).collect();
    let (x, v, _) = case.motion.peaks();
    let mut items = vec![
        Item::Text(format!(
            "{}: reference peaks {:.3} g (paper {:.3}), {:.3} m/s, {:.3} m.",
            case.name,
            case.peak_g(),
            case.event.reference_peak_g(),
            v,
            x
        )),
        Item::Table(figures(&here)),
        Item::Table(windows(case, &here)),
        Item::Table(fitted::table(case, fitted)),
    ];
    items.extend([Named::Current, Named::Strong, Named::Modified].iter().filter_map(|&named| {
        let row = here.iter().find(|row| row.named == named)?;
        Some(Item::Plot(history(case, row)))
    }));
    Section { heading: case.event.name().into(), items }
}

/// The name of a row, its reading where there is a choice.
fn name(row: &Row) -> String {
    if Reading::apply_to(row.named).len() == 1 {
        return row.named.title().into();
    }
    format!("{}, {}", row.named.title(), row.reading.name())
}

fn figures(rows: &[&Row]) -> Table {
    let cells = |row: &&Row| {
        let (score, paper) = (&row.whole.against_wanted, row.published());
        vec![
            name(row),
            format!("{:.3}", score.e_a.squared()),
            format!("{:.3}", paper.e_a),
            format!("{:.3}", score.e_a.ratio),
            format!("{:.3}", score.e_d.ratio),
            format!("{:.3}", paper.e_d),
            format!("{:.3}", row.peak_g()),
            format!("{:.3}", paper.peak_g),
            format!("{:.0}", score.e_a.delay * 1e3),
            format!("{:.2}", row.whole.saturated_s),
            notes::cause(row).into(),
        ]
    };
    let columns = [
        "controller",
        "E_a squared [1]",
        "paper E_a",
        "E_a [1]",
        "E_d [1]",
        "paper E_d",
        "peak [g]",
        "paper peak [g]",
        "delay [ms]",
        "at the limit [s]",
        "notes",
    ];
    Table {
        caption: "Over the whole record".into(),
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(cells).collect(),
    }
}

fn windows(case: &Case, rows: &[&Row]) -> Table {
    let cells = |row: &&Row| {
        let of = |s: &Scores| {
            let w = &s.against_wanted;
            [w.e_a.squared(), w.e_a.ratio, w.e_d.ratio, w.response_peak / GRAVITY].map(|x| format!("{x:.3}"))
        };
        let commanded = &row.whole.against_commanded;
        let against = [commanded.e_a.squared(), commanded.e_d.ratio].map(|x| format!("{x:.3}"));
        [vec![name(row)], of(&row.strong).to_vec(), of(&row.weak).to_vec(), against.to_vec()].concat()
    };
    let (strong, weak) = case.windows;
    let columns = [
        "controller",
        "strong: E_a squared [1]",
        "E_a [1]",
        "E_d [1]",
        "peak [g]",
        "weak: E_a squared [1]",
        "E_a [1]",
        "E_d [1]",
        "peak [g]",
        "commanded: E_a squared [1]",
        "E_d [1]",
    ];
    Table {
        caption: format!(
            "Strong stretch {:.1} to {:.1} s, weak stretch {:.1} to {:.1} s, and the whole against the commanded record",
            strong.from_s, strong.to_s, weak.from_s, weak.to_s
        ),
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(cells).collect(),
    }
}

fn check_table(held: &[Check]) -> Table {
    let cells = |c: &Check| {
        vec![
            format!("{} {}", c.event.name(), c.named.title()),
            if c.figure == "E_a" { "E_a squared".into() } else { c.figure.into() },
            format!("{:.3}", c.value),
            format!("{:.3}", c.paper),
            format!("{:+.1}", 100.0 * c.deviation()),
            format!("{:.0}", 100.0 * c.bound),
            if c.holds() { "holds" } else { "does not hold" }.into(),
        ]
    };
    let columns = ["row", "figure", "here", "paper", "deviation [%]", "bound [%]", ""];
    Table {
        caption: "The plain displacement loops, which the paper determines".into(),
        columns: columns.map(String::from).to_vec(),
        rows: held.iter().map(cells).collect(),
    }
}

/// Acceleration over the strong stretch, saturation shaded (Figs. 15 to 21).
fn history(case: &Case, row: &Row) -> Plot {
    let (strong, dt) = (case.windows.0, row.trial.trace.dt);
    let (from, to) = ((strong.from_s - 1.0).max(0.0), strong.to_s + 3.0);
    let range = (from / dt) as usize..((to / dt) as usize).min(row.trial.trace.acceleration.len());
    // A point every 5 ms shows all that a 4.7 Hz record and its spikes hold, at a fifth of the page.
    let series = |name: &str, values: &[f64], style| Series {
        name: name.into(),
        x: range.clone().step_by(5).map(|k| k as f64 * dt).collect(),
        y: range.clone().step_by(5).map(|k| values.get(k).map_or(f64::NAN, |a| a / GRAVITY)).collect(),
        style,
    };
    let label = || String::from("velocity at its limit");
    let bands = row.trial.trace.saturated_stretches(0.02).into_iter();
    Plot {
        title: format!("{}: acceleration, {}", case.event.name(), row.named.title()),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: "acceleration [g]".into(), log: false },
        series: vec![
            series("reference", &row.trial.wanted.acceleration, Style::Dashed),
            series("table", &row.trial.trace.acceleration, Style::Line),
        ],
        bands: bands
            .filter(|&(a, b)| b > from && a < to)
            .map(|(a, b)| Band { from: a.max(from), to: b.min(to), label: label() })
            .collect(),
        group: Some(case.event.name().into()),
        ..Plot::default()
    }
}

fn scores_json(scores: &Scores) -> serde_json::Value {
    let w = &scores.against_wanted;
    json!({"e_a": w.e_a.ratio, "e_a_squared": w.e_a.squared(), "e_d": w.e_d.ratio,
           "peak_g": w.response_peak / GRAVITY, "reference_peak_g": w.reference_peak / GRAVITY,
           "delay_s": w.e_a.delay, "saturated_s": scores.saturated_s})
}

fn row_json(case: &Case, row: &Row) -> serde_json::Value {
    let mut value = scores_json(&row.whole);
    let commanded = &row.whole.against_commanded;
    let rest = json!({
        "record": row.event.name(), "file": case.name, "controller": row.named.title(), "name": row.named.name(),
        "reading": row.reading.name(), "paper": row.published(), "cause": notes::cause(row),
        "commanded": {"e_a": commanded.e_a.ratio, "e_a_squared": commanded.e_a.squared(), "e_d": commanded.e_d.ratio},
        "strong": scores_json(&row.strong), "weak": scores_json(&row.weak),
    });
    if let (Some(value), serde_json::Value::Object(rest)) = (value.as_object_mut(), rest) {
        value.extend(rest);
    }
    value
}

/// `rows` holds the 24 rows of the paper; the other reading of the acceleration loop stands under `other_reading`, Strong
/// on fitted records under `fitted_rows`.
fn json(cases: &[Case], rows: &[Row], fitted: &[FittedRow], held: &[Check]) -> serde_json::Value {
    let of = |reading: Reading| -> Vec<serde_json::Value> {
        let found = |row: &&Row| row.reading == reading;
        let case = |event: Event| cases.iter().find(|case| case.event == event);
        rows.iter().filter(found).filter_map(|row| Some(row_json(case(row.event)?, row))).collect()
    };
    let check = |c: &Check| {
        json!({"record": c.event.name(), "controller": c.named.title(), "figure": c.figure, "value": c.value,
               "paper": c.paper, "deviation": c.deviation(), "bound": c.bound, "holds": c.holds()})
    };
    json!({"rows": of(Reading::Tracking), "other_reading": of(Reading::Damping),
           "fitted_rows": fitted.iter().map(fitted::json).collect::<Vec<_>>(),
           "checks": held.iter().map(check).collect::<Vec<_>>()})
}
