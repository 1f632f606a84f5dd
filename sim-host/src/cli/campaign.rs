//! `shakedown campaign`: records by scales by controllers from one file, resumable, in shards, on one page.

use super::output::{Outputs, print, print_table, sha256, tell, write_whole};
use super::shard::Shard;
use super::{Failure, failure, progress, run};
use crate::closed_loop::scenario::Scenario;
use crate::files::bounded;
use crate::motion::condition::peak_acceleration;
use crate::report::{Item, Matrix, Page, Section, Shade, Table};
use rayon::prelude::*;
use serde_json::{Value, json};
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Runs a list of records, scales and controllers that one file names: what is there already is not run again, and everything that is
/// there is on one page.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown campaign autumn.toml --out results --report autumn.html
  shakedown campaign autumn.toml --out results --shard 2/8     one piece of eight; the last to finish, or a run without --shard, shows all

The file:
  records = [\"kobe.AT2\", \"taft.AT2\"]      # relative to it
  scales = [0.5, 1.0, \"0.74g\"]            # factors, or peaks; left out: as recorded
  controllers = [\"current\", \"tracking\"]   # left out: the table's
  fit = \"nearest\"                         # and everything else that a scenario of `run` states
  table = \"table.toml\"")]
pub(crate) struct Args {
    /// The campaign.
    #[arg(value_name = "CAMPAIGN.toml")]
    campaign: PathBuf,
    /// Folder of the results, one file a test.
    #[arg(long, value_name = "DIR", value_parser = super::places::folder())]
    out: PathBuf,
    /// One piece of several.
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    outputs: Outputs,
}

/// One test of a campaign.
struct Cell {
    record: String,
    scale: String,
    controller: String,
    scenario: Scenario,
    /// Fingerprint of everything that its result follows from.
    key: String,
    place: PathBuf,
}

/// Most tests of a campaign.
const MOST: usize = 100_000;
/// Largest result that is read, bytes.
const LARGEST: u64 = 1 << 22;
/// Figures of a result that the page shows: name, where it is in the result, digits.
const FIGURES: [(&str, &str, usize); 7] = [
    ("E_a", "/metrics/e_a", 3),
    ("E_d", "/metrics/e_d", 3),
    ("peak [g]", "/metrics/peak_g", 3),
    ("delay [s]", "/indices/delay_s", 4),
    ("gain", "/indices/gain", 3),
    ("coherence", "/indices/coherence", 3),
    ("saturated [s]", "/metrics/saturated_s", 2),
];

/// Runs what is missing, then shows all that is there.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let (cells, mut inputs) = cells(args)?;
    let mine = |i: usize| args.shard.is_none_or(|s| i as u64 % s.of == s.number - 1);
    let missing: Vec<&Cell> =
        cells.iter().enumerate().filter(|(i, cell)| mine(*i) && stored(cell).is_none()).map(|(_, cell)| cell).collect();
    let there = cells.iter().filter(|cell| stored(cell).is_some()).count();
    tell(&format!("{} tests: {there} done before, {} to run", cells.len(), missing.len()));
    let bar = progress::bar(missing.len() as u64, "tests");
    let failed: Vec<String> = missing
        .par_iter()
        .filter_map(|cell| {
            let outcome = done(cell);
            bar.inc(1);
            outcome.err().map(|e| format!("{} at {} by {}: {e}", cell.record, cell.scale, cell.controller))
        })
        .collect();
    bar.finish_and_clear();
    let results: Vec<(&Cell, Value)> = cells.iter().filter_map(|cell| Some((cell, stored(cell)?))).collect();
    let open = cells.len() - results.len();
    let table = table(&results);
    let lead = lead(cells.len(), open, &failed);
    if !args.outputs.quiet() {
        print_table(&table);
        print(&format!("\n{lead}\n"));
    }
    for line in &failed {
        tell(&format!("failed: {line}"));
    }
    let values: Vec<Value> = results.iter().map(|(_, value)| value.clone()).collect();
    inputs.insert(0, args.campaign.clone());
    args.outputs
        .write_json(json!({ "tests": cells.len(), "open": open, "failed": failed, "results": values }), &inputs)?;
    args.outputs.write_report(&mut page(&args.campaign, lead, &results, table), &inputs)?;
    if failed.is_empty() { Ok(()) } else { Err(Failure::Work(format!("campaign: {} tests failed", failed.len()))) }
}

/// What a failure says.
fn words(failure: Failure) -> String {
    match failure {
        Failure::Input(text) | Failure::Work(text) => text,
        Failure::Cut => "cut".into(),
    }
}

/// Runs a test and stores its result.
fn done(cell: &Cell) -> Result<(), String> {
    let mut value = run::result(cell.scenario.clone()).map_err(words)?;
    if let Some(object) = value.as_object_mut() {
        // A speed is no result: the same test gives the same file.
        object.remove("times_real_time");
        object.insert("campaign".into(), json!({ "key": cell.key, "record": cell.record, "scale": cell.scale }));
        object.insert("version".into(), env!("CARGO_PKG_VERSION").into());
    }
    let text = serde_json::to_string_pretty(&value).map_err(|e| e.to_string())? + "\n";
    write_whole(&cell.place, text.as_bytes()).map_err(words)
}

/// The result of a test, where it was run with the same inputs.
fn stored(cell: &Cell) -> Option<Value> {
    let value: Value = serde_json::from_str(&bounded::text(&cell.place, LARGEST).ok()?).ok()?;
    (value.pointer("/campaign/key")?.as_str()? == cell.key).then_some(value)
}

/// The tests that a campaign names, and the files they read.
fn cells(args: &Args) -> Result<(Vec<Cell>, Vec<PathBuf>), Failure> {
    let place = args.campaign.display();
    let refuse = |problem: String| Failure::Input(format!("{place}: {problem}"));
    let text = bounded::text(&args.campaign, bounded::BY_HAND).map_err(|e| refuse(e.to_string()))?;
    let mut document: toml::Table = text.parse().map_err(|e: toml::de::Error| {
        failure::refused(&args.campaign, format!("{place}: {}", e.message()), "a campaign is TOML")
    })?;
    let mut list = |key: &str| match document.remove(key) {
        None => Ok(None),
        Some(toml::Value::Array(values)) if !values.is_empty() => Ok(Some(values)),
        Some(_) => Err(refuse(format!("`{key}`: expected a list with at least one entry, {key} = [...]"))),
    };
    let (records, scales, controllers) = (list("records")?, list("scales")?, list("controllers")?);
    let Some(records) = records else {
        return Err(refuse("`records` is missing: name the files, records = [\"a.AT2\"]".into()));
    };
    if let Some(twice) = records.iter().enumerate().find_map(|(i, name)| records[..i].contains(name).then_some(name)) {
        return Err(refuse(format!("`records`: {twice} is named twice")));
    }
    if document.get("scale").is_some_and(toml::Value::is_array) {
        return Err(refuse("`scale` is one factor; a list of them is `scales = [...]`".into()));
    }
    let scales = scales.unwrap_or_else(|| vec![toml::Value::Float(1.0)]);
    let rest = toml::to_string(&document).map_err(|e| refuse(e.to_string()))?;
    let base = Scenario::from_text(&args.campaign, &rest).map_err(|e| Failure::Input(e.to_string()))?;
    if base.record.file.is_some() || base.scale.is_some() || base.scale_to.is_some() {
        return Err(refuse("states one record or one scale beside the lists: leave it out".into()));
    }
    let controllers = match controllers {
        Some(names) if base.controller.is_some() || base.settings.is_some() => {
            return Err(refuse(format!("states `controllers` ({}) and one controller: leave one out", names.len())));
        }
        Some(names) => names.iter().map(|name| string(name, "controllers").map(Some)).collect::<Result<Vec<_>, _>>(),
        None => Ok(vec![None]),
    };
    let controllers = controllers.map_err(refuse)?;
    let count = records.len() * scales.len() * controllers.len();
    if count > MOST {
        return Err(refuse(format!("names {count} tests: expected {MOST} at most")));
    }
    let folder = args.campaign.parent().unwrap_or(Path::new(""));
    let tables: Vec<PathBuf> = [&base.table, &base.settings].into_iter().flatten().cloned().collect();
    let mut common = Sha256::new();
    common.update(rest.as_bytes());
    for path in &tables {
        common.update(sha256(path)?);
    }
    let (mut cells, mut inputs) = (Vec::with_capacity(count), tables);
    for record in &records {
        let name = string(record, "records").map_err(refuse)?;
        let file = folder.join(&name);
        let hash = sha256(&file).map_err(|e| refuse(format!("`records`: {}", words(e))))?;
        inputs.push(file.clone());
        for scale in &scales {
            let (factor, peak) = match scale {
                toml::Value::String(text) => {
                    peak_acceleration(text).map_err(|e| refuse(format!("`scales`: {e}")))?;
                    (None, Some(text.clone()))
                }
                toml::Value::Float(x) => (Some(*x), None),
                toml::Value::Integer(x) => (Some(*x as f64), None),
                other => return Err(refuse(format!("`scales`: {other} is no factor and no peak such as \"0.4g\""))),
            };
            if let Some(factor) = factor.filter(|f| !(*f > 0.0 && f.is_finite())) {
                return Err(refuse(format!("`scales`: {factor}: expected a factor above zero")));
            }
            for controller in &controllers {
                let mut scenario = base.clone();
                scenario.source = None;
                scenario.record.file = Some(file.clone());
                (scenario.scale, scenario.scale_to) = (factor.filter(|f| *f != 1.0), peak.clone());
                if let Some(controller) = controller {
                    scenario.controller = Some(controller.clone());
                }
                // What is wrong with a controller's name shows before anything runs.
                scenario.setup().map_err(|e| refuse(e.to_string()))?;
                let scale = peak.clone().unwrap_or_else(|| factor.unwrap_or(1.0).to_string());
                let controller = controller.clone().unwrap_or_else(|| "as stated".into());
                let mut key = common.clone();
                for part in [&hash, &scale, &controller, env!("CARGO_PKG_VERSION")] {
                    key.update(part.as_bytes());
                    key.update([0]);
                }
                let key: String = key.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
                let place = args.out.join(format!("{key}.json"));
                cells.push(Cell { record: name.clone(), scale, controller, scenario, key, place });
            }
        }
    }
    Ok((cells, inputs))
}

fn string(value: &toml::Value, key: &str) -> Result<String, String> {
    value.as_str().map(str::to_owned).ok_or_else(|| format!("`{key}`: {value} is no text in quotes"))
}

fn lead(count: usize, open: usize, failed: &[String]) -> String {
    let mut text = format!("{} of {count} tests are done.", count - open);
    if !failed.is_empty() {
        text += &format!(" {} failed.", failed.len());
    }
    if open > failed.len() {
        text += " The others belong to other pieces: run this command again to go on.";
    }
    text
}

fn table(results: &[(&Cell, Value)]) -> Table {
    let columns = ["record", "scale", "controller"].into_iter().chain(FIGURES.iter().map(|(name, _, _)| *name));
    let row = |(cell, value): &(&Cell, Value)| {
        let figures = FIGURES.iter().map(|(_, place, digits)| {
            value.pointer(place).and_then(Value::as_f64).map_or("\u{2013}".to_owned(), |x| format!("{x:.digits$}"))
        });
        [cell.record.clone(), cell.scale.clone(), cell.controller.clone()].into_iter().chain(figures).collect()
    };
    Table {
        caption: "Every test: true motion, accelerations low-passed at 15 Hz".into(),
        columns: columns.map(String::from).collect(),
        rows: results.iter().map(row).collect(),
    }
}

fn page(campaign: &Path, lead: String, results: &[(&Cell, Value)], table: Table) -> Page {
    let mut controllers: Vec<&str> = results.iter().map(|(cell, _)| cell.controller.as_str()).collect();
    controllers.sort_unstable();
    controllers.dedup();
    let mut rows: Vec<(String, Vec<f64>)> = Vec::new();
    for (cell, value) in results {
        let name = format!("{} at {}", cell.record, cell.scale);
        let at = rows.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
            rows.push((name, vec![f64::NAN; controllers.len()]));
            rows.len() - 1
        });
        if let Some(column) = controllers.iter().position(|c| *c == cell.controller) {
            rows[at].1[column] = value.pointer("/metrics/e_a").and_then(Value::as_f64).unwrap_or(f64::NAN);
        }
    }
    let matrix = Matrix {
        caption:
            "E_a, the norm of the acceleration's error over that of what was asked for, by record, scale and controller"
                .into(),
        rows_are: "motion".into(),
        columns_are: "controller".into(),
        columns: controllers.into_iter().map(String::from).collect(),
        rows,
        shade: Shade::OfLargest,
    };
    let name = campaign.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    Page {
        title: format!("Campaign {name}"),
        lead,
        sections: vec![Section { heading: "Overview".into(), items: vec![Item::Matrix(matrix)] }],
        details: vec![Section { heading: "Every test".into(), items: vec![Item::Table(table)] }],
        ..Page::default()
    }
}
