//! `shakedown demo`: guided demo on built-in data.

mod concealed;

use super::histories::{self, History, Opening};
use super::output::Outputs;
use super::{Failure, present, progress};
use crate::closed_loop::showcase::{Entry, STROKE, Way, play};
use crate::closed_loop::twin::Twin;
use crate::motion::condition::Recipe;
use crate::motion::{Motion, generate};
use crate::plant::sensors::{GRAVITY, SensorModel};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Where the report goes when nothing else is said.
const REPORT: &str = "shakedown-report.html";
/// The fit takes every sample as a variable; records hold nothing beyond 100 Hz.
const RATE: f64 = 200.0;

/// The main job end to end on data the project brings: a near-field motion through the loop, the record fitted to the
/// table, a concealed effect found.
#[derive(Debug, Default, clap::Args)]
#[command(after_help = "Examples:
  shakedown demo
  shakedown demo --seed 5 --report demo.html --json demo.json")]
pub(crate) struct Args {
    /// Seed of the motion and of the sensors' noise.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    outputs: Outputs,
}

/// Runs the story, prints its table and ends with the path of its report.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let started = Instant::now();
    let report = args.outputs.report.clone().unwrap_or_else(|| PathBuf::from(REPORT));
    crate::files::writable(&report).map_err(|e| {
        Failure::Input(format!(
            "{}: no file can be written there: {}; name a place with --report",
            report.display(),
            e.kind()
        ))
    })?;
    // Without a command line, Default gives a seed of zero where clap's default is one.
    let seed = args.seed.max(1);
    let failed = |e: String| Failure::Work(format!("demo: {e}"));
    let record = generate::NEAR_FIELD_STRONG.generate(seed).map_err(|e| failed(e.to_string()))?;
    let motion = Recipe::table1(RATE).apply(&record).map_err(|e| failed(e.to_string()))?;
    let sensors = SensorModel::laboratory(seed);
    let bar = progress::bar(Way::ALL.len() as u64, "tests");
    let tell = |&way: &Way| {
        let entry = play(&motion, way, &sensors).map_err(|e| failed(format!("{}: {e}", way.title())));
        bar.inc(1);
        entry
    };
    let entries = Way::ALL.iter().map(tell).collect::<Result<Vec<Entry>, Failure>>()?;
    bar.finish_and_clear();
    let concealed = concealed::play(seed)?;
    let sections = vec![problem(&record.name, &motion, &entries), remedy(&entries), concealed.section()];
    if !args.outputs.quiet() {
        sections.iter().for_each(present::print_section);
    }
    args.outputs.write_json(json(seed, &entries, &concealed), &[])?;
    let mut page = Page {
        title: "A near-field record on a table too slow for it, and what a model leaves out".into(),
        lead: format!("{} {}", lead(&entries), concealed.lead()),
        key: key(&entries),
        advice: vec![
            "Play a record of your own: `shakedown run --record FILE --report run.html`, and fit it: `shakedown modify FILE --out \
             drive.csv`."
                .into(),
            "Hold a model against your own recordings: `shakedown init FOLDER` writes the experiment, `shakedown diagnose` reads it."
                .into(),
        ],
        sections,
        provenance: vec![
            ("seed".into(), seed.to_string()),
            ("made in".into(), format!("{:.1} s", started.elapsed().as_secs_f64())),
        ],
        ..Page::default()
    };
    Outputs { report: Some(report), ..args.outputs.clone() }.write_report(&mut page, &[])
}

fn find(entries: &[Entry], way: Way) -> Option<&Entry> {
    entries.iter().find(|entry| entry.way == way)
}

/// E_a of a way to play the record, against what was wanted.
fn e_a(entries: &[Entry], way: Way) -> f64 {
    find(entries, way).map_or(f64::NAN, |entry| entry.scores.against_wanted.e_a.ratio)
}

fn key(entries: &[Entry]) -> Vec<(String, String)> {
    let of = |name: &str, way| (format!("E_a, {name}"), format!("{:.2}", e_a(entries, way)));
    vec![
        of("as tuned today", Way::Current),
        of("strong gains", Way::Strong),
        of("fitted online", Way::Causal),
        of("record fitted beforehand", Way::Fitted),
    ]
}

fn lead(entries: &[Entry]) -> String {
    let e_a = |way| e_a(entries, way);
    format!(
        "Acceleration error of the table: {:.2} as it is tuned today, {:.2} with strong gains, which meet the velocity limit \
         and spike; {:.2} with the core fitting the record online, {:.2} with the record fitted beforehand.",
        e_a(Way::Current),
        e_a(Way::Strong),
        e_a(Way::Causal),
        e_a(Way::Fitted)
    )
}

/// What goes wrong without a fit.
fn problem(name: &str, motion: &Motion, entries: &[Entry]) -> Section {
    let (x, v, a) = motion.peaks();
    let mut items = vec![Item::Text(format!(
        "{name}, a generated motion: {:.2} g, {v:.2} m/s, {x:.2} m. The table moves at 0.242 m/s at most, within {STROKE} m \
         of centre. The control core, at 1 kHz, drives the paper's plant through a 40 um LVDT and a 0.02 g accelerometer.",
        a / GRAVITY
    ))];
    if let Some(strong) = find(entries, Way::Strong) {
        let opening = Opening { unit: "%".into(), full: Twin::default().full_opening(), shown: 100.0 };
        // A test that was scored has a response.
        items.extend(histories::all(&strong.trial, "strong", &opening).unwrap_or_default());
    }
    Section { heading: "Strong gains against the velocity limit".into(), items }
}

/// What the fits come to.
fn remedy(entries: &[Entry]) -> Section {
    let mut items = vec![Item::Table(table(entries))];
    if let Some(fitted) = find(entries, Way::Fitted) {
        let curve = |name, values, scale, style| History { name, values, scale, style };
        let (trial, g) = (&fitted.trial, 1.0 / GRAVITY);
        let accelerations = [
            curve("record", trial.wanted.acceleration.as_slice(), g, Style::Dashed),
            curve("record, fitted", &trial.played.acceleration, g, Style::Faint),
            curve("table", &trial.trace.acceleration, g, Style::Line),
        ];
        items.push(Item::Plot(histories::plot(
            trial,
            "fitted",
            "Acceleration, record fitted beforehand",
            "acceleration [g]",
            &accelerations,
        )));
    }
    items.push(Item::Plot(displacements(entries)));
    items.push(Item::Note(
        "Clipping (Eq. 10) loses what it cuts for good and leaves the table off centre; the other fits stay within the \
         stroke and do not drift. `shakedown table1 --records DIR` and `shakedown modify` do the same with measured \
         records."
            .into(),
    ));
    Section { heading: "The record fitted to the table".into(), items }
}

fn table(entries: &[Entry]) -> Table {
    let row = |entry: &Entry| {
        let (wanted, commanded) = (&entry.scores.against_wanted, &entry.scores.against_commanded);
        vec![
            entry.way.title().into(),
            format!("{:.3}", wanted.e_a.ratio),
            format!("{:.3}", commanded.e_a.ratio),
            format!("{:.2}", wanted.response_peak / GRAVITY),
            format!("{:.2}", wanted.spike_ratio()),
            format!("{:.2}", entry.scores.saturated_s),
            format!("{:.0}", entry.farthest * 1e3),
            format!("{:.1}", entry.end * 1e3),
        ]
    };
    let columns = [
        "way",
        "E_a [1]",
        "as commanded [1]",
        "peak [g]",
        "over record's [1]",
        "at the limit [s]",
        "farthest [mm]",
        "end [mm]",
    ];
    Table {
        caption: "The same motion, six ways; E_a against the record, and against what was commanded. Accelerations \
                  low-passed at 15 Hz, which those drawn are not"
            .into(),
        columns: columns.map(String::from).to_vec(),
        rows: entries.iter().map(row).collect(),
    }
}

/// Where the table goes in the ways that modify the record.
fn displacements(entries: &[Entry]) -> Plot {
    let curve = |entry: &Entry| Series {
        name: entry.way.title().into(),
        x: (0..entry.trial.trace.displacement.len()).step_by(10).map(|k| k as f64 * entry.trial.trace.dt).collect(),
        y: entry.trial.trace.displacement.iter().step_by(10).map(|x| x * 1e3).collect(),
        style: Style::Line,
    };
    let shown = |entry: &&Entry| matches!(entry.way, Way::Clip | Way::Causal | Way::Fitted);
    Plot {
        title: "Where the table goes".into(),
        x: Axis { label: "time [s]".into(), log: false },
        y: Axis { label: "displacement [mm]".into(), log: false },
        series: entries.iter().filter(shown).map(curve).collect(),
        group: Some("fitted".into()),
        ..Plot::default()
    }
}

fn json(seed: u64, entries: &[Entry], concealed: &concealed::Concealed) -> serde_json::Value {
    let entry = |entry: &Entry| {
        let (wanted, commanded) = (&entry.scores.against_wanted, &entry.scores.against_commanded);
        json!({"way": entry.way.title(), "e_a": wanted.e_a.ratio, "e_a_commanded": commanded.e_a.ratio,
               "e_d": wanted.e_d.ratio, "peak_g": wanted.response_peak / GRAVITY, "spike_ratio": wanted.spike_ratio(),
               "saturated_s": entry.scores.saturated_s, "farthest_m": entry.farthest, "end_m": entry.end})
    };
    json!({"seed": seed, "ways": entries.iter().map(entry).collect::<Vec<_>>(), "concealed": concealed.json()})
}
