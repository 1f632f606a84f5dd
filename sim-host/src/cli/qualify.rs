//! `shakedown qualify`: a measured or a planned motion against a standard for seismic qualification.

mod made;
mod page;
mod within_limits;

use super::failure::within;
use super::output::Outputs;
use super::places::place;
use super::source::Text;
use super::{Failure, present};
use clap::ValueEnum;
use serde_json::{Value, json};
use shakedown::motion::drive::Drive;
use shakedown::motion::qualify::{
    Code, Direction, Judged, QualifyError, Required, Rule, STANDARDS, Shape, Site, Standard, judge, synthesise,
};
use shakedown::motion::{Record, read};
use std::path::{Path, PathBuf};

/// Holds a motion against a standard: spectra, zero-period acceleration, duration, strong motion, independence of axes.
#[derive(Debug, clap::Args)]
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
    /// The standard.
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(STANDARDS.map(|s| s.id)))]
    standard: String,
    /// Another axis of the same test; may be given twice.
    #[arg(long, value_name = "FILE", conflicts_with = "synthesise")]
    axis: Vec<PathBuf>,
    /// AC156: design spectral acceleration at short periods, g.
    #[arg(long, value_name = "G")]
    sds: Option<f64>,
    /// AC156: height of attachment over the roof's, 0 to 1 [default: 1].
    #[arg(long, value_name = "SHARE")]
    z_over_h: Option<f64>,
    /// AC156: the building code [default: asce7-16].
    #[arg(long, value_enum)]
    code: Option<Building>,
    /// Direction of the shaking [default: horizontal].
    #[arg(long, value_enum)]
    direction: Option<Axis>,
    /// IEEE 693: the level [default: high].
    #[arg(long, value_enum)]
    level: Option<Level>,
    /// A required spectrum of your own instead of the standard's: lines of frequency [Hz] and acceleration [g].
    #[arg(long, value_name = "FILE")]
    rrs: Option<PathBuf>,
    /// Lowest natural frequency of the specimen, Hz: spectra are judged from three quarters of it on, within the standard's range.
    #[arg(long, value_name = "HZ")]
    lowest: Option<f64>,
    /// Makes a motion that satisfies the standard and writes it: .csv (time and acceleration) or .AT2; within limits a drive, .csv,
    /// .rpc or .AT2.
    #[arg(long, value_name = "FILE", value_parser = place(), conflicts_with = "record")]
    synthesise: Option<PathBuf>,
    /// Its margin: reached over required where that is least [default: 1.05].
    #[arg(long, value_name = "RATIO", requires = "synthesise")]
    margin: Option<f64>,
    /// Its seed [default: 1]; axes of one test take different ones.
    #[arg(long, value_name = "N", requires = "synthesise")]
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

/// Building codes by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Building {
    /// ASCE 7-16.
    #[value(name = "asce7-16")]
    Asce16,
    /// ASCE 7-22.
    #[value(name = "asce7-22")]
    Asce22,
}

/// Directions by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Axis {
    /// In the plane.
    Horizontal,
    /// Upright.
    Vertical,
}

/// Levels of IEEE 693.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Level {
    /// 0.25 g at zero period.
    Moderate,
    /// 0.5 g.
    High,
}

/// What came out.
pub(super) struct Answer {
    pub(super) name: String,
    pub(super) standard: Standard,
    pub(super) required: Required,
    pub(super) judged: Judged,
    pub(super) acceleration: Vec<f64>,
    pub(super) dt: f64,
    pub(super) lowest: f64,
}

/// Reads or makes the motion, judges it and says what came out.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let standard = args.stated()?;
    let required = args.required(&standard)?;
    let lowest = args.from(&standard)?;
    if args.within.asked() {
        return within_limits::run(args, standard, required, lowest);
    }
    made::form(args)?;
    let (name, acceleration, dt, axes) = args.motion(&standard, &required, lowest)?;
    let place = args.record.as_ref().map_or_else(|| name.clone(), |path| path.display().to_string());
    let judged = judge(&acceleration, dt, &axes, &standard, &required, lowest)
        .map_err(|e| Failure::Input(format!("{place}: {e}")))?;
    let answer = Answer { name, standard, required, judged, acceleration, dt, lowest };
    if let Some(path) = &args.synthesise {
        made::write(path, &answer)?;
    }
    let inputs: Vec<PathBuf> = args.record.iter().chain(&args.axis).chain(&args.rrs).cloned().collect();
    let mut page = page::page(&answer);
    if !args.outputs.quiet() {
        super::output::print(&format!("{}\n\n", page.lead));
        present::print_section(&page::rules(&answer));
    }
    args.outputs.write_json(value(&answer), &inputs)?;
    args.outputs.write_report(&mut page, &inputs)?;
    let broken: Vec<&str> = answer.judged.broken().map(|rule| rule.name).collect();
    if broken.is_empty() {
        return Ok(());
    }
    Err(Failure::Work(format!("{place}: does not satisfy {}: {}", standard.title, broken.join(", "))))
}

impl Args {
    fn stated(&self) -> Result<Standard, Failure> {
        let standard = Standard::named(&self.standard)
            .ok_or_else(|| Failure::Input(format!("--standard {}: no such standard", self.standard)))?;
        let own = |id: &str, option: &str, given: bool| {
            let wrong = given && (standard.id != id || self.rrs.is_some());
            let why = if self.rrs.is_some() { "--rrs gives the spectrum" } else { "belongs to another standard" };
            if wrong { Err(Failure::Input(format!("{option}: {why}: leave it out"))) } else { Ok(()) }
        };
        own("ac156", "--sds", self.sds.is_some())?;
        own("ac156", "--z-over-h", self.z_over_h.is_some())?;
        own("ac156", "--code", self.code.is_some())?;
        own("ieee693", "--level", self.level.is_some())?;
        if standard.id == "ac156" && self.sds.is_none() && self.rrs.is_none() {
            return Err(Failure::Input("--sds G: AC156 takes its level from the design spectral acceleration".into()));
        }
        within("--sds", self.sds.unwrap_or(1.0), 0.01, 10.0, "g")?;
        within("--z-over-h", self.z_over_h.unwrap_or(1.0), 0.0, 1.0, "")?;
        within("--margin", self.margin.unwrap_or(1.05), 0.1, 10.0, "")?;
        within("--lowest", self.lowest.unwrap_or(1.0), 0.1, 100.0, "Hz")?;
        Ok(standard)
    }

    fn required(&self, standard: &Standard) -> Result<Required, Failure> {
        if let Some(path) = &self.rrs {
            let refuse = |e: String| Failure::Input(format!("{}: {e}", path.display()));
            let text = shakedown::files::bounded::text(path, 1 << 20).map_err(|e| refuse(e.to_string()))?;
            return Required::parse(&text, standard.damping).map_err(refuse);
        }
        let site = Site {
            s_ds: self.sds.unwrap_or(1.0),
            z_over_h: self.z_over_h.unwrap_or(1.0),
            code: self.code.map_or(Code::Asce16, |code| match code {
                Building::Asce16 => Code::Asce16,
                Building::Asce22 => Code::Asce22,
            }),
            direction: self.direction.map_or(Direction::Horizontal, |axis| match axis {
                Axis::Horizontal => Direction::Horizontal,
                Axis::Vertical => Direction::Vertical,
            }),
            high: !matches!(self.level, Some(Level::Moderate)),
        };
        standard.required(&site).map_err(|e| Failure::Input(e.to_string()))
    }

    /// The lowest frequency that is judged, Hz.
    fn from(&self, standard: &Standard) -> Result<f64, Failure> {
        let Some(lowest) = self.lowest else { return Ok(standard.band.0) };
        let from = (0.75 * lowest).min(3.5).max(standard.band.0);
        if from < standard.band.1 {
            Ok(from)
        } else {
            Err(Failure::Input(format!("--lowest {lowest}: beyond the standard's range")))
        }
    }

    /// Name, acceleration, interval and the other axes.
    fn motion(
        &self,
        standard: &Standard,
        required: &Required,
        lowest: f64,
    ) -> Result<(String, Vec<f64>, f64, Vec<Vec<f64>>), Failure> {
        let Some(path) = &self.record else {
            let (shape, margin) = (Shape::USUAL, self.margin.unwrap_or(1.05));
            let made = synthesise(standard, required, lowest, margin, &shape, self.seed.unwrap_or(1));
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

pub(super) fn value(answer: &Answer) -> Value {
    let judged = &answer.judged;
    let rule = |rule: &Rule| {
        json!({"name": rule.name, "found": rule.found, "bound": rule.bound, "at_least": rule.at_least, "unit": rule.unit,
               "holds": rule.holds, "advised": rule.advised, "checked_against_text": rule.checked, "place": rule.place})
    };
    let ordinate = |o: &shakedown::motion::qualify::Ordinate| json!({"frequency_hz": o.frequency, "required": o.required, "reached": o.reached});
    json!({
        "schema": "shakedown.qualification/1",
        "standard": answer.standard.id, "title": answer.standard.title, "status": answer.standard.status,
        "motion": answer.name, "complies": judged.complies(), "margin": judged.margin, "margin_at_hz": judged.worst_hz,
        "zero_period": judged.zero_period, "required_zero_period": answer.required.zero_period(),
        "damping": answer.required.damping, "from_hz": answer.lowest, "to_hz": answer.standard.band.1,
        "strong_motion_s": judged.intensity.d5_95,
        "rules": judged.rules.iter().map(rule).collect::<Vec<_>>(),
        "spectrum": judged.ordinates.iter().map(ordinate).collect::<Vec<_>>(),
    })
}
