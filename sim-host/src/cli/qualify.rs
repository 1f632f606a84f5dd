//! `shakedown qualify`: a measured or a planned motion against a standard for seismic qualification.

mod made;
mod within_limits;

use super::failure::within;
use super::judged::{self, Answer};
use super::output::Outputs;
use super::places::place;
use super::required::{Demand, Demanded};
use super::source::Text;
use super::{Failure, present};
use crate::motion::drive::Drive;
use crate::motion::qualify::{QualifyError, Requirement, Shape, judge, synthesise};
use crate::motion::{Record, read};
use std::path::{Path, PathBuf};

/// Holds a motion against a standard: spectra, zero-period acceleration, duration, strong motion, independence of axes.
#[derive(Debug, clap::Args)]
#[command(mut_arg("standard", |standard| standard.required(true)))]
#[command(after_help = "Examples:
  shakedown qualify table.AT2 --standard ac156 --sds 1.0 --z-over-h 1 --report qualification.html
  shakedown qualify x.csv --axis y.csv --axis z.csv --standard ac156 --sds 0.8
  shakedown qualify run.csv --channel acceleration --standard ieee693 --level high
  shakedown qualify run.AT2 --standard ieee344 --rrs floor.csv
  shakedown qualify --synthesise motion.csv --standard ac156 --sds 1.0 --margin 1.1
  shakedown qualify --synthesise motion.csv --standard ac156 --sds 1.0 --velocity 0.5 --stroke 0.125
  shakedown qualify --synthesise motion.csv --from kobe.AT2 --standard ieee344 --rrs floor.csv --table table.toml

With --velocity and --stroke, or --table, the motion keeps the table's limits, or the frequencies are named that no motion within
them can reach.

Exit status 1 where a rule is broken. No text of a standard was at hand when the rules were written: each says whether it was
checked. The verdict is an analysis and no certificate.")]
pub(crate) struct Args {
    /// The table's acceleration: any record, or columns of text.
    #[arg(required_unless_present = "synthesise")]
    record: Option<PathBuf>,
    #[command(flatten)]
    demand: Demand,
    /// Another axis of the same test, held against the others for independence alone; may be given twice.
    #[arg(long, value_name = "FILE", conflicts_with = "synthesise")]
    axis: Vec<PathBuf>,
    /// Makes a motion that satisfies the standard and writes it: .csv (time and acceleration) or .AT2; within limits a drive, .csv,
    /// .rpc or .AT2.
    #[arg(long, value_name = "FILE", value_parser = place(), conflicts_with = "record")]
    synthesise: Option<PathBuf>,
    /// Its margin: reached over required where that is least [default: 1.05].
    #[arg(long, value_name = "RATIO", requires = "synthesise", conflicts_with = "record")]
    margin: Option<f64>,
    /// Its seed [default: 1]; axes of one test take different ones.
    #[arg(long, value_name = "N", requires = "synthesise", conflicts_with = "record")]
    seed: Option<u64>,
    #[command(flatten)]
    within: within_limits::Kept,
    /// Sampling interval, s, where the file states none.
    #[arg(long, value_name = "S")]
    dt: Option<f64>,
    /// Unit of the acceleration, where the file states none: m/s2, cm/s2, mm/s2, gal or g.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Component, where the file has several: its number or a part of its name.
    #[arg(long, value_name = "NAME")]
    channel: Option<read::Channel>,
    #[command(flatten)]
    text: Text,
    #[command(flatten)]
    outputs: Outputs,
}

/// Reads or makes the motion, judges it and says what came out.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    within("--margin", args.margin.unwrap_or(1.05), 0.1, 10.0, "")?;
    if let Some(option) = args.within.shape.given().filter(|_| args.record.is_some()) {
        return Err(Failure::Input(format!(
            "{option} describes the drive that --synthesise writes; RECORD is judged as it is"
        )));
    }
    let demanded = args.demand.demanded()?;
    let demanded = demanded.ok_or_else(|| Failure::Input("--standard NAME: which standard?".into()))?;
    if args.within.asked() {
        return within_limits::run(args, demanded);
    }
    made::form(args)?;
    let asked = demanded.requirement();
    let (name, acceleration, dt, axes) = args.motion(asked)?;
    let place = args.record.as_ref().map_or_else(|| name.clone(), |path| path.display().to_string());
    let verdict = judge(&acceleration, dt, &axes, asked).map_err(|e| Failure::Input(format!("{place}: {e}")))?;
    let Demanded { standard, required, lowest } = demanded;
    let answer = Answer { name, standard, required, judged: verdict, acceleration, dt, lowest };
    if let Some(path) = &args.synthesise {
        made::write(path, &answer)?;
    }
    let inputs: Vec<PathBuf> = args.record.iter().chain(&args.axis).chain(&args.demand.rrs).cloned().collect();
    let mut page = judged::page(&answer);
    if !args.outputs.quiet() {
        super::output::print(&format!("{}\n\n", page.lead));
        present::print_section(&judged::rules(&answer));
    }
    args.outputs.write_json(judged::value(&answer), &inputs)?;
    args.outputs.write_report(&mut page, &inputs)?;
    let broken: Vec<&str> = answer.judged.broken().map(|rule| rule.name).collect();
    if broken.is_empty() {
        return Ok(());
    }
    Err(Failure::Work(format!("{place}: does not satisfy {}: {}", standard.title, broken.join(", "))))
}

impl Args {
    /// Name, acceleration, interval and the other axes.
    fn motion(&self, asked: Requirement<'_>) -> Result<(String, Vec<f64>, f64, Vec<Vec<f64>>), Failure> {
        let Some(path) = &self.record else {
            let (shape, margin) = (Shape::USUAL, self.margin.unwrap_or(1.05));
            let made = synthesise(asked, margin, &shape, self.seed.unwrap_or(1));
            let made = made.map_err(|e: QualifyError| Failure::Work(format!("qualify: {e}")))?;
            return Ok(("synthetic motion".into(), made, 1.0 / shape.rate, Vec::new()));
        };
        let first = self.read(path)?;
        let axes = self.axis.iter().map(|path| {
            let other = self.read(path)?;
            if (other.dt / first.dt - 1.0).abs() > 1e-6 || other.acceleration.len() != first.acceleration.len() {
                return Err(Failure::Input(format!(
                    "{}: {} samples every {} s, where the first axis has {} every {} s: axes are of one test",
                    path.display(),
                    other.acceleration.len(),
                    other.dt,
                    first.acceleration.len(),
                    first.dt
                )));
            }
            Ok(other.acceleration)
        });
        let axes = axes.collect::<Result<Vec<_>, _>>()?;
        Ok((first.name, first.acceleration, first.dt, axes))
    }

    fn read(&self, path: &Path) -> Result<Record, Failure> {
        let unit = self.unit.as_deref().map(str::parse).transpose();
        let unit = unit.map_err(|e| Failure::Input(format!("--unit: {e}")))?;
        let channel = self.channel.clone().unwrap_or_default();
        if let Some(drive) = Drive::read(path).map_err(|e| Failure::Input(e.to_string()))? {
            return Ok(made::of_drive(path, &drive));
        }
        super::source::record(path, &read::Options { dt: self.dt, unit, channel, text: self.text.stated() })
    }
}
