//! `shakedown learn`: iterative learning over repeated runs on the twin.

use super::output::Outputs;
use super::source::Source;
use super::{Failure, present, progress};
use clap::builder::PossibleValuesParser;
use serde_json::json;
use shakedown::closed_loop::learning::{Learned, Learning, Limits, Peaks, Round, learn};
use shakedown::closed_loop::named;
use shakedown::closed_loop::trial::Setup;
use shakedown::closed_loop::twin::Twin;
use shakedown::motion::condition::Recipe;
use shakedown::plant::sensors::SensorModel;
use shakedown::report::{Item, Page, Section, Table};

/// Learns a drive over repeated runs on the twin: the next run's peaks are predicted, and an unsafe drive is refused.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown learn --record taft.AT2 --controller current --runs 6
  shakedown learn --record kobe.AT2 --velocity 0.2          stops before a run that would be faster")]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// Controller by name.
    #[arg(long, value_name = "NAME", default_value = "current", value_parser = PossibleValuesParser::new(named::names()))]
    controller: String,
    /// Runs at most.
    #[arg(long, default_value_t = 6)]
    runs: usize,
    /// Frequency up to which is learned, Hz.
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

/// Learns, shows every run beside what was predicted of it.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let record = args.source.load()?;
    let wanted = Recipe::table1(named::RATE)
        .apply(&record)
        .map_err(|e| Failure::Input(format!("{}: conditioning: {e}", record.name)))?;
    let settings = named::by_name(&args.controller, named::RATE)
        .ok_or_else(|| Failure::Input(format!("--controller {}: no such controller", args.controller)))?;
    let setup = Setup { settings, table: Twin::default(), sensors: SensorModel::laboratory(1), steps: 10 };
    let limits = Limits { displacement: args.stroke, velocity: args.velocity, acceleration: args.acceleration };
    let how = Learning { band: args.band.clamp(0.5, 50.0), runs: args.runs.clamp(1, 50), ..Learning::default() };
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
    let mut items = vec![Item::Table(table)];
    items.extend(learned.refused.map(|refusal| Item::Note(refusal.to_string())));
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
