//! `shakedown bench`: records by tables by controllers, and the figures that the tracking law is held to.

mod page;

use super::output::Outputs;
use super::{Failure, present, progress};
use crate::closed_loop::bench::figures::{self, Figure, Records};
use crate::closed_loop::bench::{Bench, Case, Contender, Quartiles, Row, Score, TABLES, rows};
use crate::motion::generate;
use crate::motion::{Record, read};
use crate::plant::sensors::GRAVITY;
use crate::report::{Item, Section, Table};
use clap::builder::PossibleValuesParser;
use serde_json::json;
use std::path::{Path, PathBuf};

/// The public benchmark: records by tables by controllers, quartiles as well as bests, and the tracking law's own figures.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown bench --records DIR --report bench.html
  shakedown bench --records DIR --limits-only           only figures with acceptance limits
  shakedown bench --tables paper,oil                    two tables, generated records

DIR holds the PEER files of El Centro (IELC180), Kobe (KJM000) and Taft (TAF021); what is
missing is left out, and the figures with acceptance limits need the first two. Three generated records are
always there.")]
pub(crate) struct Args {
    /// Folder with records.
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// Only these tables.
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = PossibleValuesParser::new(TABLES))]
    tables: Option<Vec<String>>,
    /// Only figures with acceptance limits.
    #[arg(long, requires = "records")]
    limits_only: bool,
    #[command(flatten)]
    outputs: Outputs,
}

/// Records in files: name, part of the file's name, peak to scale to (m/s2).
const FILES: [(&str, &str, Option<f64>); 3] =
    [("El Centro", "ielc180", None), ("Kobe at 0.74 g", "kjm000", Some(0.74 * GRAVITY)), ("Taft", "taf021", None)];

/// The record whose file's name holds `part`.
fn find(folder: &Path, part: &str) -> Result<Option<(PathBuf, Record)>, Failure> {
    let entries = std::fs::read_dir(folder)
        .map_err(|e| Failure::Input(format!("{}: {e}: --records expects a folder of records", folder.display())))?;
    let holds = |path: &PathBuf| path.file_name().is_some_and(|n| n.to_string_lossy().to_lowercase().contains(part));
    let Some(path) = entries.filter_map(|entry| Some(entry.ok()?.path())).find(holds) else { return Ok(None) };
    let record = read::record(&path, &read::Options::default()).map_err(|e| Failure::Input(e.to_string()))?;
    Ok(Some((path, record)))
}

fn case(name: &str, record: &Record, peak: Option<f64>) -> Result<Case, Failure> {
    Case::new(name, record, peak).map_err(|e| Failure::Input(format!("{name}: {e}")))
}

/// What is played: files first, then the generated ones.
struct Played {
    cases: Vec<Case>,
    inputs: Vec<PathBuf>,
}

fn played(folder: Option<&Path>) -> Result<Played, Failure> {
    let mut played = Played { cases: Vec::new(), inputs: Vec::new() };
    for (name, part, peak) in FILES.iter().filter(|_| folder.is_some()) {
        if let Some((path, record)) = find(folder.unwrap_or(Path::new(".")), part)? {
            played.cases.push(case(name, &record, *peak)?);
            played.inputs.push(path);
        }
    }
    for recipe in generate::RECIPES {
        let record = recipe.generate(1).map_err(|e| Failure::Work(format!("{}: {e}", recipe.name)))?;
        played.cases.push(case(recipe.name, &record, None)?);
    }
    Ok(played)
}

/// Runs the benchmark, prints it, writes `--json` and `--report`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::Work(format!("bench: {e}"));
    let played = played(args.records.as_deref())?;
    let held = held(&played, args)?;
    let names: Vec<&str> = match &args.tables {
        _ if args.limits_only => Vec::new(),
        None => TABLES.to_vec(),
        Some(names) => names.iter().map(String::as_str).collect(),
    };
    let benches: Vec<Bench> = names.iter().filter_map(|name| Bench::named(name)).collect();
    let bar = progress::bar((benches.len() * Contender::all().len()) as u64, "rows");
    let rows = rows(&played.cases, &benches, || bar.inc(1)).map_err(|e| failed(&e))?;
    bar.finish_and_clear();
    let sections = sections(&held, &benches, &rows, &played.cases);
    if !args.outputs.quiet() {
        sections.iter().for_each(present::print_section);
    }
    args.outputs.write_json(json(&held, &rows, &played.cases), &played.inputs)?;
    args.outputs.write_report(&mut page::page(&held, &benches, &rows, sections), &played.inputs)
}

/// The figures with acceptance limits, where their two records are there.
fn held(played: &Played, args: &Args) -> Result<Vec<Figure>, Failure> {
    let find = |name: &str| played.cases.iter().find(|case| case.name == name);
    let (Some(el_centro), Some(kobe)) = (find(FILES[0].0), find(FILES[1].0)) else {
        let Some(folder) = args.records.as_ref().filter(|_| args.limits_only) else { return Ok(Vec::new()) };
        let need = "no file of El Centro and Kobe: --limits-only needs files whose names hold IELC180 and KJM000";
        return Err(Failure::Input(format!("{}: {need}", folder.display())));
    };
    let spinner = progress::spinner("figures with acceptance limits".into());
    let found = figures::all(&Records { el_centro, kobe }).map_err(|e| Failure::Work(format!("bench: {e}")));
    spinner.finish_and_clear();
    found
}

fn sections(held: &[Figure], benches: &[Bench], rows: &[Row], cases: &[Case]) -> Vec<Section> {
    let mut sections = Vec::new();
    if !held.is_empty() {
        sections.push(Section { heading: HELD.into(), items: vec![Item::Table(held_table(held))] });
    }
    for bench in benches {
        let of: Vec<&Row> = rows.iter().filter(|row| row.table == bench.name).collect();
        let about = format!("{}; records fitted to {:.3} m/s. {} records.", bench.about, bench.usable, cases.len());
        let tables = [
            summary("E_a against the commanded record, true motion, ideal sensors, nothing filtered", &of, &ideal),
            summary("The same with the table's sensors, both sides low-passed at 15 Hz", &of, &sensed),
            summary(
                "The same with the table's sensors, nothing filtered: noise shakes a stiff table at any frequency",
                &of,
                &whole,
            ),
            each(&of, cases),
        ];
        let items = [vec![Item::Text(about)], tables.into_iter().map(Item::Table).collect()].concat();
        sections.push(Section { heading: bench.name.into(), items });
    }
    if !rows.is_empty() {
        let items = NOTES.iter().map(|note| Item::Note((*note).into())).collect();
        sections.push(Section { heading: HOW.into(), items });
    }
    sections
}

/// Headings of what is not of one table.
const HELD: &str = "Figures held to bounds";
const HOW: &str = "How to read it";

const NOTES: [&str; 5] = [
    "Every law but the paper's may ask for at most 2.5 times the flow of the velocity limit.",
    "E_a is Eq. 11, unsquared: norm of the acceleration error over norm of the acceleration commanded, the response \
     shifted in time where that helps. 1 is no better than standing still.",
    "The paper's controllers keep the paper's gains on every table. Three-variable control, LQI and ADRC get the widest \
     bandwidth that keeps 6 dB and 30 degrees on the table's linear model and shakes it at rest with no more than 0.05 g of \
     sensor noise; the tracking law must keep them with gain, pole, \
     mass and supply 30 % off as well.",
    "Three-variable control, LQI and ADRC are written here from their textbook forms; a maker's own tuning may be better.",
    "The structure of `payload` and `yielding` is in nobody's model. The soft limit of `soft-orifice` and the droop of \
     `droop` are in the tracking law's model, as identification would find them; linear laws have no use for them.",
];

fn held_table(held: &[Figure]) -> Table {
    let cells = |f: &Figure| {
        let bound = format!("{} {}", if f.at_least { "at least" } else { "at most" }, (1e4 * f.bound).round() / 1e4);
        let verdict = if f.holds() { "holds" } else { "does not hold" };
        vec![f.name.clone(), format!("{:.4}", f.value), bound, verdict.into(), f.note.clone()]
    };
    let columns = ["figure", "value", "bound", "", "beside it"].map(String::from).to_vec();
    Table {
        caption: "The tracking law, designed for 30 % of uncertainty".into(),
        columns,
        rows: held.iter().map(cells).collect(),
    }
}

fn ideal(score: &Score) -> f64 {
    score.ideal.e_a.ratio
}

fn sensed(score: &Score) -> f64 {
    score.sensed.e_a.ratio
}

fn whole(score: &Score) -> f64 {
    score.sensed_whole.e_a.ratio
}

/// Three decimals; a response that is nothing like its reference in one word.
fn three(value: f64) -> String {
    if value < 10.0 { format!("{value:.3}") } else { "unstable".into() }
}

fn quartiles(row: &Row, of: &dyn Fn(&Score) -> f64) -> Quartiles {
    Quartiles::of(row.scores.iter().map(of))
}

fn summary(caption: &str, rows: &[&Row], of: &dyn Fn(&Score) -> f64) -> Table {
    let cells = |row: &&Row| {
        let q = quartiles(row, of);
        let spike = row.scores.iter().map(|s| s.ideal.spike_ratio()).fold(0.0, f64::max);
        let figures = [q.best, q.lower, q.median, q.upper, q.worst, spike].map(three);
        [vec![row.contender.title()], figures.to_vec()].concat()
    };
    let columns =
        ["controller", "best", "lower quartile", "median", "upper quartile", "worst", "highest peak over reference"];
    Table {
        caption: caption.into(),
        columns: columns.map(String::from).to_vec(),
        rows: rows.iter().map(cells).collect(),
    }
}

/// `E_a` record by record.
fn each(rows: &[&Row], cases: &[Case]) -> Table {
    let cells = |row: &&Row| {
        let scores = row.scores.iter().map(|s| format!("{} / {}", three(ideal(s)), three(sensed(s))));
        std::iter::once(row.contender.title()).chain(scores).collect()
    };
    let columns = std::iter::once("controller".into()).chain(cases.iter().map(|case| case.name.clone())).collect();
    let caption = "Record by record: ideal sensors / the table's sensors".into();
    Table { caption, columns, rows: rows.iter().map(cells).collect() }
}

fn json(held: &[Figure], rows: &[Row], cases: &[Case]) -> serde_json::Value {
    let figure = |f: &Figure| {
        json!({"name": f.name, "value": f.value, "bound": f.bound, "at_least": f.at_least, "holds": f.holds(),
               "note": f.note})
    };
    let score = |(case, s): (&Case, &Score)| {
        json!({"record": case.name, "e_a": ideal(s), "e_a_low_passed": s.ideal_low_passed.e_a.ratio,
               "e_a_sensors": sensed(s), "e_a_sensors_unfiltered": whole(s), "e_d": s.ideal.e_d.ratio, "spike_ratio": s.ideal.spike_ratio(),
               "delay_s": s.ideal.e_a.delay})
    };
    let row = |row: &Row| {
        json!({"table": row.table, "controller": row.contender.title(),
               "e_a": quartiles(row, &ideal), "e_a_sensors": quartiles(row, &sensed),
               "records": cases.iter().zip(&row.scores).map(score).collect::<Vec<_>>()})
    };
    json!({"figures": held.iter().map(figure).collect::<Vec<_>>(), "rows": rows.iter().map(row).collect::<Vec<_>>()})
}
