//! `shakedown learn`: iterative learning over repeated runs on the twin.

use super::failure::within;
use super::output::Outputs;
use super::source::{Source, plausible};
use super::{Failure, present, progress};
use clap::builder::PossibleValuesParser;
use serde_json::json;
use shakedown::closed_loop::learning::{Learned, Learning, Limits, Peaks, Round, learn};
use shakedown::closed_loop::named;
use shakedown::closed_loop::trial::Setup;
use shakedown::closed_loop::twin::Twin;
use shakedown::motion::condition::Recipe;
use shakedown::motion::fit::named::Fit;
use shakedown::motion::{Motion, Record};
use shakedown::plant::sensors::SensorModel;
use shakedown::report::{Item, Page, Section, Table};

/// Learns a drive over repeated runs on the twin: the next run's peaks are predicted, and an unsafe drive is refused.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown learn --record taft.AT2 --controller current --runs 6
  shakedown learn --record kobe.AT2 --velocity 0.2          learns the record fitted to 0.2 m/s
  shakedown learn --record kobe.AT2 --fit none              refused: as it is it asks for more than the table can do

A drive that is predicted to pass a limit is not run, be it the first or a later one.")]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Controller by name.
    #[arg(long, value_name = "NAME", default_value = "current", value_parser = PossibleValuesParser::new(named::names()))]
    controller: String,
    /// Fits the record to speed and stroke first; `none` leaves it as it is.
    #[arg(long, value_name = "NAME", default_value = "nearest", value_parser = PossibleValuesParser::new(fits()))]
    fit: String,
    /// Runs at most, 1 to 50.
    #[arg(long, value_name = "N", default_value_t = 6)]
    runs: usize,
    /// Frequency up to which is learned, 0.5 to 50 Hz.
    #[arg(long, value_name = "HZ", default_value_t = 12.0)]
    band: f64,
    /// Largest displacement that a run may be predicted to reach, m.
    #[arg(long, value_name = "M", default_value_t = 0.12)]
    stroke: f64,
    /// Largest speed, m/s.
    #[arg(long, value_name = "M/S", default_value_t = 0.242)]
    velocity: f64,
    /// Largest acceleration, m/s2.
    #[arg(long, value_name = "M/S2", default_value_t = 15.0)]
    acceleration: f64,
    #[command(flatten)]
    outputs: Outputs,
}

/// What `--fit` takes.
fn fits() -> impl Iterator<Item = &'static str> {
    std::iter::once(AS_IT_IS).chain(Fit::names())
}

/// No fit.
const AS_IT_IS: &str = "none";

impl Args {
    fn check(&self) -> Result<(), Failure> {
        within("--runs", self.runs as f64, 1.0, 50.0)?;
        within("--band", self.band, 0.5, 50.0)?;
        within("--stroke", self.stroke, 0.001, 10.0)?;
        within("--velocity", self.velocity, 0.001, 10.0)?;
        within("--acceleration", self.acceleration, 0.01, 1000.0)
    }

    /// What the table is to do.
    fn wanted(&self, record: &Record) -> Result<Motion, Failure> {
        let wrong = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", record.name));
        let motion = Recipe::table1(named::RATE).apply(record).map_err(|e| wrong(&e))?;
        plausible(&record.name, &motion);
        let Some(fit) = Fit::parse(&self.fit) else { return Ok(motion) };
        let bar = progress::spinner(format!("fitting {}", record.name));
        let fitted = fit.apply(&motion, self.velocity, self.stroke, |line| bar.set_message(line.to_owned()));
        bar.finish_and_clear();
        fitted.map_err(|e| wrong(&e))
    }
}

/// Learns, shows every run beside what was predicted of it.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.check()?;
    let record = args.source.load()?;
    let wanted = args.wanted(&record)?;
    let settings = named::by_name(&args.controller, named::RATE)
        .ok_or_else(|| Failure::Input(format!("--controller {}: no such controller", args.controller)))?;
    let setup = Setup { settings, table: Twin::default(), sensors: SensorModel::laboratory(1), steps: 10 };
    let limits = Limits { displacement: args.stroke, velocity: args.velocity, acceleration: args.acceleration };
    let how = Learning { band: args.band, runs: args.runs, ..Learning::default() };
    let bar = progress::spinner(format!("learning {}", record.name));
    let learned = learn(&setup, &wanted, &limits, &how).map_err(|e| Failure::Work(format!("learn: {e}")))?;
    bar.finish_and_clear();
    let section = section(&learned, &record.name);
    if !args.outputs.quiet() {
        present::print_section(&section);
    }
    let inputs = args.source.inputs();
    args.outputs.write_json(json(&learned), &inputs)?;
    let lead = "Every run's peaks were predicted from the run before it, and held against the table's limits first.";
    let mut page = Page { title: "Learning".into(), lead: lead.into(), sections: vec![section], ..Page::default() };
    args.outputs.write_report(&mut page, &inputs)
}

fn section(learned: &Learned, record: &str) -> Section {
    let pair = |predicted: Option<f64>, found: f64| match predicted {
        Some(predicted) => format!("{predicted:.3} / {found:.3}"),
        None => format!("- / {found:.3}"),
    };
    let row = |(i, r): (usize, &Round)| {
        let of = |get: fn(&Peaks) -> f64| pair(r.predicted.as_ref().map(get), get(&r.peaks));
        vec![
            (i + 1).to_string(),
            format!("{:.3}", r.score.e_a.ratio),
            format!("{:.4}", r.score.e_d.ratio),
            of(|p| p.displacement),
            of(|p| p.velocity),
            of(|p| p.acceleration),
        ]
    };
    let columns = ["run", "E_a [1]", "E_d [1]", "displacement [m]", "velocity [m/s]", "acceleration [m/s2]"];
    let table = Table {
        caption: "Run by run; peaks predicted / found, within the band learned".into(),
        columns: columns.map(String::from).to_vec(),
        rows: learned.rounds.iter().enumerate().map(row).collect(),
    };
    let mut items: Vec<Item> = (!learned.rounds.is_empty()).then_some(Item::Table(table)).into_iter().collect();
    items.extend(learned.refused.map(|refusal| Item::Note(refusal.to_string())));
    if learned.rounds.is_empty() {
        items.push(Item::Note("Nothing was run. Fitted to the table first (--fit), the record may be learned.".into()));
    }
    Section { heading: format!("Learning {record}"), items }
}

fn json(learned: &Learned) -> serde_json::Value {
    let peaks =
        |p: &Peaks| json!({"displacement": p.displacement, "velocity": p.velocity, "acceleration": p.acceleration});
    let round = |r: &Round| {
        json!({"e_a": r.score.e_a.ratio, "e_d": r.score.e_d.ratio, "peaks": peaks(&r.peaks),
               "predicted": r.predicted.as_ref().map(peaks)})
    };
    json!({"runs": learned.rounds.iter().map(round).collect::<Vec<_>>(),
           "refused": learned.refused.map(|r| r.to_string())})
}
