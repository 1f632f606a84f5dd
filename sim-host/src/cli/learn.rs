//! `shakedown learn`: iterative learning over repeated runs on the twin.

mod origin;
mod page;
mod played;

use super::checked::Checked;
use super::described::{self, Found};
use super::failure::within;
use super::output::{Outputs, print};
use super::places::place;
use super::source::{Source, plausible};
use super::written::{Plan, Shape};
use super::{Failure, present, progress};
use crate::closed_loop::learning::stale::check_motion;
use crate::closed_loop::learning::{Learned, Learning, Limits, learn_from};
use crate::closed_loop::named;
use crate::closed_loop::trial::Setup;
use crate::closed_loop::twin::Twin;
use crate::motion::condition::Recipe;
use crate::motion::drive::{Drive, DriveUnit, Quantity};
use crate::motion::fit::named::{ASKED, RecordFit};
use crate::motion::{Motion, Record};
use crate::plant::sensors::SensorModel;
use clap::builder::PossibleValuesParser;
use std::path::{Path, PathBuf};

/// Learns a drive over repeated runs on the twin: the next run's peaks are predicted, and an unsafe drive is refused.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown learn --record taft.AT2 --controller current --runs 6
  shakedown learn --record kobe.AT2 --velocity 0.2          learns the record fitted to 0.2 m/s
  shakedown learn --record kobe.AT2 --fit none              refused: as it is it asks for more than the table can do
  shakedown learn --record kobe.AT2 --table table.toml --out learnt.csv
  shakedown learn --record kobe.AT2 --table table.toml --from learnt.csv    goes on, unless the table has changed since
  shakedown learn --record kobe.AT2 --out learnt.rpc --drive-unit V --volts-per-metre 80 --rate 2048
  shakedown learn --record kobe.AT2 --from second.csv --played run2.csv --out third.csv    what a real table made of the second run
  shakedown learn --check check.csv                         a weak motion, to be recorded with each drive that is learnt
  shakedown learn --record kobe.AT2 --from learnt.csv --check-then may.csv --check-now june.csv    refused where the specimen changed

A drive that is predicted to pass a limit is not run, be it the first or a later one. Before a learnt drive is played, record the
check motion again: with the recording from when it was learnt, `learn --from`, `device run` and `compare` say whether it is stale.")]
pub(crate) struct Args {
    #[command(flatten)]
    source: Source,
    /// The table's file: a model and what `[table]` describes beside it [default: table.toml of this folder, else the paper's
    /// table].
    #[arg(long, value_name = "TABLE.toml")]
    table: Option<PathBuf>,
    /// Controller by name [default: current, or the table's].
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(named::names()))]
    controller: Option<String>,
    /// Fits the record to speed and stroke first; `none` leaves it as it is.
    #[arg(long, value_name = "NAME", default_value = "nearest", value_parser = PossibleValuesParser::new(fits()))]
    fit: String,
    /// Writes the drive of the run that came nearest, with its provenance: .csv, .rpc or .AT2.
    #[arg(long, value_name = "FILE", value_parser = place())]
    out: Option<PathBuf>,
    #[command(flatten)]
    shape: Shape,
    /// Begins with a learnt drive; refused where it was learnt for another motion, on another table or by another controller.
    #[arg(long, value_name = "DRIVE")]
    from: Option<PathBuf>,
    /// Recording of the drive of --from on a real table: the next drive follows from it, and the twin is not run.
    #[arg(long, value_name = "RECORDING", requires = "from")]
    played: Option<PathBuf>,
    /// Column of the table's displacement in that recording [default: by its name].
    #[arg(long, value_name = "COLUMN", requires = "played")]
    displacement: Option<String>,
    #[command(flatten)]
    checked: Checked,
    /// Writes the check motion as a drive and does nothing else.
    #[arg(long, value_name = "FILE", value_parser = place(), conflicts_with_all = ["out", "from", "record", "seed"])]
    check: Option<PathBuf>,
    /// Runs at most, 1 to 50.
    #[arg(long, value_name = "N", default_value_t = 6)]
    runs: usize,
    /// Frequency up to which is learned, 0.5 to 50 Hz.
    #[arg(long, value_name = "HZ", default_value_t = 12.0)]
    band: f64,
    /// Largest displacement that a run may be predicted to reach, m [default: 0.12, or the table's].
    #[arg(long, value_name = "M")]
    stroke: Option<f64>,
    /// Largest speed, m/s [default: 0.242, or the table's].
    #[arg(long, value_name = "M/S")]
    velocity: Option<f64>,
    /// Largest acceleration, m/s2 [default: 15, or the table's].
    #[arg(long, value_name = "M/S2")]
    acceleration: Option<f64>,
    #[command(flatten)]
    outputs: Outputs,
}

/// What `--fit` takes.
fn fits() -> impl Iterator<Item = &'static str> {
    std::iter::once(AS_IT_IS).chain(RecordFit::names())
}

/// Share of the speed that the record is fitted to.
const ROOM: f64 = 0.95;

/// No fit.
const AS_IT_IS: &str = "none";

impl Args {
    fn check(&self) -> Result<(), Failure> {
        if let Some(path) = self.from.as_ref().filter(|path| !path.is_file()) {
            return Err(Failure::Input(format!(
                "{}: no such file; name a drive that `learn --out` wrote",
                path.display()
            )));
        }
        let Outputs { json, report, figures } = &self.outputs;
        if self.check.is_some() && (json.is_some() || report.is_some() || figures.is_some()) {
            let why = "--check writes a motion to play and has no result: leave --json, --report and --figures out";
            return Err(Failure::Input(why.to_owned()));
        }
        within("--runs", self.runs as f64, 1.0, 50.0, "")?;
        within("--band", self.band, 0.5, 50.0, "Hz")?;
        within("--stroke", self.stroke.unwrap_or(0.1), 0.001, 10.0, "m")?;
        within("--velocity", self.velocity.unwrap_or(0.1), 0.001, 10.0, "m/s")?;
        within("--acceleration", self.acceleration.unwrap_or(1.0), 0.01, 1000.0, "m/s2")
    }

    /// The limits, from the options, else the table.
    fn limits(&self, described: &Found, table: &Twin) -> Result<Limits, Failure> {
        Ok(Limits {
            displacement: self.stroke.or(described.table.stroke).unwrap_or(described::STROKE),
            velocity: super::velocity_limit(self.velocity, table, described.path.as_deref())?,
            acceleration: self.acceleration.or(described.table.acceleration).unwrap_or(15.0),
        })
    }

    /// What is written by the option `out`: as asked for, else as the table's drives are.
    fn plan(&self, out: &str, path: &Path, described: &Found, limits: &Limits) -> Result<Plan, Failure> {
        let mut shape = self.shape.clone();
        shape.described(path, &described.table);
        shape.plan(out, path, limits.displacement)
    }

    /// What the table is to do.
    fn wanted(&self, record: &Record, limits: &Limits) -> Result<Motion, Failure> {
        let wrong = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", record.name));
        let motion = Recipe::table1(named::RATE).apply(record).map_err(|e| wrong(&e))?;
        plausible(&record.name, &motion);
        let Some(fit) = RecordFit::parse(&self.fit) else { return Ok(motion) };
        let bar = progress::spinner(format!("fitting {}", record.name));
        // A record fitted to the last millimetre and the last of the speed leaves no room for what learning adds, and its second run
        // would be refused.
        let (speed, stroke) = (ROOM * limits.velocity, ASKED * limits.displacement);
        let fitted = fit.apply(&motion, speed, stroke, |line| bar.set_message(line.to_owned()));
        bar.finish_and_clear();
        fitted.map_err(|e| wrong(&e))
    }
}

/// Learns, shows every run beside what was predicted of it.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    args.check()?;
    let described = described::found(args.table.as_deref())?;
    let table = super::table(described.path.as_deref())?;
    let limits = args.limits(&described, &table)?;
    if let Some(path) = &args.check {
        return check(path, &args.plan("--check", path, &described, &limits)?, &limits);
    }
    let plan = match &args.out {
        Some(path) => Some(args.plan("--out", path, &described, &limits)?),
        None => args.shape.only_with("--out").map(|()| None)?,
    };
    let checked = args.checked.fresh(args.from.as_deref())?;
    let record = args.source.load()?;
    let wanted = args.wanted(&record, &limits)?;
    let name = args.controller.as_deref().or(described.table.controller.as_deref()).unwrap_or("current");
    let settings = named::by_name(name, named::RATE)
        .ok_or_else(|| Failure::Input(format!("controller {name}: expected one of {}", named::names().join(" "))))?;
    let setup = Setup { settings, table, sensors: SensorModel::laboratory(1), steps: 10 };
    let mut origin = origin::origin(args, &record, &described, name, &setup)?;
    let begin = args.from.as_deref().map(|path| origin::begin(path, &origin, &setup)).transpose()?;
    let how = Learning { band: args.band, runs: args.runs, ..Learning::default() };
    let inputs: Vec<PathBuf> = args
        .source
        .inputs()
        .into_iter()
        .chain(described.path)
        .chain(args.from.clone())
        .chain(args.played.clone())
        .chain(args.checked.inputs())
        .collect();
    if let (Some(recording), Some(from), Some(drive)) = (&args.played, &args.from, &begin) {
        let next = played::Next { args, recording, from, drive, wanted: &wanted, limits: &limits, how: &how };
        return next.run(plan.as_ref(), origin, checked.as_ref(), &inputs);
    }
    let begin = begin.map(|drive| drive.values);
    let bar = progress::spinner(format!("learning {}", record.name));
    let learned =
        learn_from(begin, &setup, &wanted, &limits, &how).map_err(|e| Failure::Work(format!("learn: {e}")))?;
    bar.finish_and_clear();
    let section = page::section(&learned, &record.name);
    if !args.outputs.quiet() {
        present::print_section(&section);
    }
    if let (Some(path), Some(plan)) = (&args.out, &plan) {
        write(path, plan, &learned, &limits, &mut origin, wanted.dt)?;
    }
    args.outputs.write_json(page::json(&learned, checked.as_ref()), &inputs)?;
    let mut page = page::page(&learned, &record.name, section, checked.as_ref());
    args.outputs.write_report(&mut page, &inputs)?;
    if learned.rounds.is_empty() {
        return Err(Failure::Work(format!(
            "{}: refused, and nothing was run: --fit brings it within the limits",
            record.name
        )));
    }
    Ok(())
}

/// The fact that says which run a drive is of, from 1.
const RUN: &str = "run";

/// Puts the limits among the facts of a drive.
fn limited(facts: &mut Vec<(String, String)>, limits: &Limits) {
    let all = [("velocity", limits.velocity), ("stroke", limits.displacement), ("acceleration", limits.acceleration)];
    facts.extend(all.map(|(name, limit)| (format!("limit_{name}"), limit.to_string())));
}

/// Writes the drive of the best run.
fn write(
    path: &Path,
    plan: &Plan,
    learned: &Learned,
    limits: &Limits,
    origin: &mut Vec<(String, String)>,
    dt: f64,
) -> Result<(), Failure> {
    let best =
        learned.rounds.iter().enumerate().min_by(|(_, a), (_, b)| a.score.e_a.ratio.total_cmp(&b.score.e_a.ratio));
    let Some((run, best)) = best else {
        return Err(Failure::Work(format!("{}: nothing was run, and nothing written", path.display())));
    };
    limited(origin, limits);
    let mut put = |key: &str, value: String| origin.push((key.to_owned(), value));
    put("method", format!("learnt, run {} of {}", run + 1, learned.rounds.len()));
    put(RUN, (run + 1).to_string());
    put("peak_displacement_m", format!("{:.6}", best.reached.displacement));
    put("peak_velocity_m_per_s", format!("{:.6}", best.reached.velocity));
    put("peak_acceleration_m_per_s2", format!("{:.6}", best.reached.acceleration));
    put("e_a", format!("{:.6}", best.score.e_a.ratio));
    written(path, plan, best.drive.clone(), dt, std::mem::take(origin))
}

/// A displacement, m, as a drive.
fn written(path: &Path, plan: &Plan, values: Vec<f64>, dt: f64, facts: Vec<(String, String)>) -> Result<(), Failure> {
    let unit = DriveUnit { symbol: "m".into(), in_si: 1.0 };
    let motion = Drive { quantity: Quantity::Displacement, dt, values, unit, facts: Vec::new() }.motion();
    plan.write("learn", path, &motion, facts).map(|_| ())
}

/// Share of the speed and of the stroke that the check motion takes.
const CHECKED: (f64, f64) = (0.17, 0.1);

/// Writes the check motion.
fn check(path: &Path, plan: &Plan, limits: &Limits) -> Result<(), Failure> {
    let (speed, reach) = (CHECKED.0 * limits.velocity, CHECKED.1 * limits.displacement);
    let facts = vec![
        ("source".to_owned(), "generated check motion".to_owned()),
        ("method".into(), "a sweep from 0.4 to 15 Hz at even speed".into()),
        ("peak_velocity_m_per_s".into(), format!("{speed:.6}")),
        ("peak_displacement_m".into(), format!("{reach:.6}")),
    ];
    written(path, plan, check_motion(named::RATE, speed, reach), 1.0 / named::RATE, facts)?;
    print(&format!("{}: 26 s, at most {speed:.3} m/s and {reach:.4} m\n", path.display()));
    Ok(())
}
