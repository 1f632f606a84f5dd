//! `shakedown modify`: fits a record to the table's limits and writes the drive, with its provenance.

mod missed;
mod out;
mod page;
mod required;

use super::failure::{first_given, number};
use super::output::Outputs;
use super::places::place;
use super::required::Demand;
use super::source::{Text, plausible, record as read_record};
use super::{Failure, described, present, progress, written};
use crate::motion::condition::{Recipe, Step, peak_acceleration};
use crate::motion::fit::answer::{Answer, AnswerError, Compared};
use crate::motion::fit::certificate::{self, Relaxation, Relaxed};
use crate::motion::fit::method::{Method, modify};
use crate::motion::fit::named::PREVIEW;
use crate::motion::fit::spectrum::Band;
use crate::motion::fit::{FitError, Limits, Norm, Reference};
use crate::motion::{AccelerationUnit, Motion, Record, generate, read};
use clap::ValueEnum;
use std::path::PathBuf;
use std::time::Instant;

/// Fits a record to the table's limits and writes the drive: CSV, RPC III or AT2, by the file's name.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "Examples:
  shakedown modify KJM000.AT2 --out drive.AT2 --scale-to 0.74g
  shakedown modify KJM000.AT2 --out drive.csv --drive displacement --drive-unit mm --rate 1000
  shakedown modify KJM000.AT2 --out drive.rpc --velocity 0.3 --stroke 0.15 --report fit.html
  shakedown modify KJM000.AT2 --objective spectrum --band 0.05,0.5 --tolerance 0.05 --out drive.AT2
  shakedown modify KJM000.AT2 --objective spectrum --standard ac156 --sds 1.0 --velocity 0.5 --stroke 0.15 --out drive.csv
  shakedown modify KJM000.AT2 --objective spectrum --standard ieee344 --rrs floor.csv --out drive.rpc
                                          to a required spectrum, or the proof that no motion within the limits reaches it
  shakedown modify KJM000.AT2 --preview 0.5 --json -      what the device itself would make of it
  shakedown modify KJM000.AT2 --table found.toml          within what a diagnosed table can do
  shakedown modify KJM000.AT2 --target 0.2                what it would take to come that near
  shakedown modify near-field-strong --report fit.html    a generated record, with no file at hand")]
pub(crate) struct Args {
    /// The record: a file, or the name of a generated one (near-field-strong, near-field-moderate, far-field).
    record: PathBuf,
    /// Where the drive goes, .csv, .rpc or .AT2; without it only the figures are given.
    #[arg(long, value_name = "FILE", value_parser = place())]
    out: Option<PathBuf>,
    #[command(flatten)]
    shape: written::Shape,
    /// Largest speed, m/s [default: 0.242, or the table's].
    #[arg(long, value_name = "M/S")]
    velocity: Option<f64>,
    /// The table's file: a model as `identify` and `diagnose --model` write it, and what `[table]` describes beside it: gives
    /// speed, stall, stroke and the drive's unit [default: table.toml of this folder].
    #[arg(long, value_name = "TABLE.toml")]
    table: Option<PathBuf>,
    /// Largest displacement to either side, m [default: 0.12, or the table's].
    #[arg(long, value_name = "M")]
    stroke: Option<f64>,
    /// Largest acceleration, m/s2 (convex only) [default: the table's].
    #[arg(long, value_name = "M/S2")]
    acceleration: Option<f64>,
    /// Largest jerk, m/s3 (convex only).
    #[arg(long, value_name = "M/S3")]
    jerk: Option<f64>,
    /// Acceleration at which the actuator stalls, m/s2 (convex only): the flow left under load is
    /// v^2 <= velocity^2 (1 - |a| / stall).
    #[arg(long, value_name = "M/S2")]
    stall: Option<f64>,
    /// Scales the record to this peak acceleration first.
    #[arg(long, value_name = "0.74g")]
    scale_to: Option<String>,
    /// How it is fitted [default: convex; preview where --preview is given].
    #[arg(long, value_enum)]
    method: Option<How>,
    /// What is kept.
    #[arg(long, value_enum, default_value_t = Objective::Waveform)]
    objective: Objective,
    /// What "nearest" means for --method convex [default: two].
    #[arg(long, value_enum)]
    norm: Option<Measure>,
    /// Preview of the online modifier, s [default: 0.5].
    #[arg(long, value_name = "S")]
    preview: Option<f64>,
    #[command(flatten)]
    demand: Demand,
    /// Periods whose spectral ordinates are kept, s [default: 0.05,0.5].
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',')]
    band: Option<Vec<f64>>,
    /// Damping of the spectrum that is kept, 1 [default: 0.05].
    #[arg(long, value_name = "RATIO")]
    damping: Option<f64>,
    /// Largest relative deviation of the spectrum that is kept, 1 [default: 0.05].
    #[arg(long, value_name = "SHARE")]
    tolerance: Option<f64>,
    /// An `E_a` to come down to: where the limits do not allow it, the smallest factor on them that does.
    #[arg(long, value_name = "E_A")]
    target: Option<f64>,
    /// Keeps a stretch of the record only, s.
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',')]
    trim: Option<Vec<f64>>,
    /// Takes the record as it is: no rest before and after, no 0.1 Hz high-pass, its own sampling rate.
    #[arg(long)]
    as_is: bool,
    /// Sampling interval, s, where the file states none.
    #[arg(long, value_name = "S")]
    dt: Option<f64>,
    /// Unit of the record's values, where the file states none: g, m/s2, cm/s2, gal ...; m, mm, V or % is the drive's unit.
    #[arg(long, value_name = "UNIT")]
    unit: Option<String>,
    /// Which component of the file: its number or a part of its name.
    #[arg(long, value_name = "NAME")]
    channel: Option<read::Channel>,
    #[command(flatten)]
    text: Text,
    /// Seed of a generated record [default: 1].
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Methods by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum How {
    /// The paper's Eq. 10.
    Clip,
    /// Taut string: the best under the velocity limit alone.
    Taut,
    /// The best under every limit.
    Convex,
    /// Online with no preview, as the device runs it.
    Causal,
    /// Online with a preview, as the device runs it.
    Preview,
}

/// Objectives by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Objective {
    /// The acceleration, sample by sample.
    Waveform,
    /// The response spectrum: the record's own over --band, and the waveform where that leaves a choice; with --standard, what that
    /// requires.
    Spectrum,
}

/// Norms by name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Measure {
    /// Root of summed squares, the paper's.
    Two,
    /// Sum of magnitudes.
    One,
    /// Largest magnitude.
    Peak,
}

/// Reads, conditions, fits, writes and says what came out.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let args = &args.with_table()?;
    if let Some(demanded) = args.demand.demanded()? {
        return required::run(args, demanded);
    }
    let method = args.method()?;
    let limits = args.limits()?;
    args.check_target()?;
    // Said before the work, not after it.
    let plan = args.plan()?;
    let (record, inputs) = args.read()?;
    let motion = args.condition(&record)?;
    plausible(&args.record.display().to_string(), &motion);
    let spinner = progress::spinner(format!("fitting {}", record.name));
    let tell = |line: &str| spinner.set_message(format!("{}: {line}", record.name));
    let begin = Instant::now();
    let modified = modify(&motion, &limits, method, tell).map_err(|e| failure(&e))?;
    let seconds = begin.elapsed().as_secs_f64();
    let clipped = modify(&motion, &limits, Method::Clip, |_| {}).map_err(|e| failure(&e))?;
    let relaxations = args.relaxations(&motion, &limits, tell)?;
    let compared = Compared::new(&motion, &modified.motion, &clipped.motion)?;
    spinner.finish_and_clear();
    let mut answer = Answer {
        name: record.name.clone(),
        conditioning: args.conditioning(),
        method,
        limits,
        motion,
        modified,
        clipped: clipped.motion,
        compared,
        relaxations,
        target: args.target,
        seconds,
        drive: Vec::new(),
    };
    if let Some(plan) = &plan {
        answer.drive = out::write(args, plan, &record, &answer, &inputs)?;
    }
    args.give(&answer, &inputs)
}

impl Args {
    /// The options with what the table's description states where they are silent.
    fn with_table(&self) -> Result<Self, Failure> {
        let described::Found { path, table } = described::found(self.table.as_deref())?;
        let mut args = self.clone();
        args.table = path;
        args.stroke = args.stroke.or(table.stroke);
        // Only the convex program keeps these.
        if matches!(args.method()?, Method::Convex(_) | Method::Spectrum(_)) {
            args.acceleration = args.acceleration.or(table.acceleration);
            args.jerk = args.jerk.or(table.jerk);
        }
        // A unit that is none of acceleration is the drive's.
        let unit = args.unit.clone().filter(|unit| unit.parse::<AccelerationUnit>().is_err());
        args.shape.or_unit(unit.as_deref().filter(|_| args.out.is_some()));
        if let Some(out) = &args.out {
            args.shape.described(out, &table);
        }
        Ok(args)
    }

    fn stroke(&self) -> f64 {
        self.stroke.unwrap_or(described::STROKE)
    }

    fn give(&self, answer: &Answer, inputs: &[PathBuf]) -> Result<(), Failure> {
        if !self.outputs.quiet() {
            present::print_section(&page::summary(answer));
            present::print_section(&page::given_up(answer));
        }
        let mut json = answer.json();
        if let Some(object) = json.as_object_mut() {
            object.insert("out".into(), self.out.as_ref().map(|out| out.display().to_string()).into());
        }
        self.outputs.write_json(json, inputs)?;
        // Its spectra take longer than some fits.
        if !self.outputs.draws() {
            return Ok(());
        }
        let mut page = page::page(answer)?;
        page.provenance.extend(answer.drive.iter().map(|(key, value)| (format!("drive: {key}"), value.clone())));
        self.outputs.write_report(&mut page, inputs)
    }

    fn method(&self) -> Result<Method, Failure> {
        let named = self.method.unwrap_or(if self.preview.is_some() { How::Preview } else { How::Convex });
        let clash = |what: &str| Err(Failure::Input(format!("modify: {what}")));
        if self.preview.is_some() && named != How::Preview {
            return clash("--preview belongs to --method preview: leave one of them out");
        }
        if self.objective == Objective::Spectrum && named != How::Convex {
            return clash("--objective spectrum is kept by --method convex only: leave --method out");
        }
        let others = [("--acceleration", self.acceleration), ("--jerk", self.jerk), ("--stall", self.stall)];
        if let Some((name, _)) = others.iter().find(|(_, limit)| limit.is_some())
            && named != How::Convex
        {
            return clash(&format!("{name} is a limit that only --method convex keeps: leave one of them out"));
        }
        let kept = self.objective == Objective::Spectrum;
        let spectral = [
            ("--band", self.band.is_some()),
            ("--damping", self.damping.is_some()),
            ("--tolerance", self.tolerance.is_some()),
        ];
        if let Some(name) = first_given(spectral).filter(|_| !kept) {
            return clash(&format!("{name} says what --objective spectrum keeps: add that, or leave {name} out"));
        }
        if self.norm.is_some() && (kept || named != How::Convex) {
            return clash("--norm belongs to --method convex with --objective waveform: leave it out");
        }
        Ok(match named {
            How::Clip => Method::Clip,
            How::Taut => Method::Taut,
            How::Causal => Method::Causal,
            How::Preview => Method::Preview(self.preview.unwrap_or(PREVIEW)),
            How::Convex if kept => Method::Spectrum(self.kept()?),
            How::Convex => Method::Convex(match self.norm {
                None | Some(Measure::Two) => Norm::Two,
                Some(Measure::One) => Norm::One,
                Some(Measure::Peak) => Norm::Peak,
            }),
        })
    }

    /// The part of the spectrum that is kept.
    fn kept(&self) -> Result<Band, Failure> {
        let usual = Band::USUAL;
        let (shortest, longest) =
            self.band.as_ref().map_or(Ok((usual.shortest, usual.longest)), |values| pair("--band", values))?;
        let (damping, tolerance) = (self.damping.unwrap_or(usual.damping), self.tolerance.unwrap_or(usual.tolerance));
        Ok(Band { shortest, longest, damping, tolerance })
    }

    /// What is asked for, and what a table's model file says of the rest.
    fn limits(&self) -> Result<Limits, Failure> {
        let table = super::table(self.table.as_deref())?;
        let velocity = super::velocity_limit(self.velocity, &table, self.table.as_deref())?;
        for (name, value, low, high, unit) in [
            ("--velocity", Some(velocity), 1e-3, 20.0, "m/s"),
            ("--stroke", Some(self.stroke()), 1e-4, 5.0, "m"),
            ("--acceleration", self.acceleration, 1e-2, 1e3, "m/s2"),
            ("--jerk", self.jerk, 1e-1, 1e6, "m/s3"),
            ("--stall", self.stall, 1e-1, 1e5, "m/s2"),
            ("--preview", self.preview, 1e-3, 60.0, "s"),
            ("--damping", self.damping, 1e-3, 0.5, "1"),
            ("--tolerance", self.tolerance, 1e-4, 1.0, "1"),
            ("--dt", self.dt, 1e-5, 1.0, "s"),
        ] {
            in_range(name, value, (low, high), unit)?;
        }
        Ok(Limits {
            acceleration: self.acceleration,
            jerk: self.jerk,
            stall: self.stall.or_else(|| table.stall()),
            ..Limits::table(velocity, self.stroke())
        })
    }

    /// The record and the files it came from.
    fn read(&self) -> Result<(Record, Vec<PathBuf>), Failure> {
        let generated = self.record.to_str().and_then(generate::Recipe::named).filter(|_| !self.record.exists());
        let unit = self.unit.as_deref().map(str::parse).transpose();
        // Of the drive where it is no unit of acceleration: judged with the drive.
        let unit = match unit {
            Err(_) if self.out.is_some() => None,
            other => other.map_err(|e| Failure::Input(format!("--unit: {e}")))?,
        };
        if let Some(recipe) = generated {
            let own = [("--dt", self.dt.is_some()), ("--unit", unit.is_some()), ("--channel", self.channel.is_some())];
            let given = first_given(own).or_else(|| self.text.given());
            if let Some(option) = given {
                return Err(Failure::Input(format!(
                    "{option} describes a file, and {} is generated: leave it out",
                    recipe.name
                )));
            }
            let record = recipe.generate(self.seed.unwrap_or(1)).map_err(|e| Failure::Input(format!("modify: {e}")))?;
            return Ok((record, Vec::new()));
        }
        if self.seed.is_some() {
            return Err(Failure::Input("--seed is of a generated record, and a file was named: leave it out".into()));
        }
        if !self.record.exists() && self.record.extension().is_none() && self.record.components().count() == 1 {
            let names: Vec<&str> = generate::RECIPES.iter().map(|recipe| recipe.name).collect();
            let place = self.record.display();
            return Err(Failure::Input(format!(
                "{place}: no such file, and no generated record; those are {}",
                names.join(", ")
            )));
        }
        let channel = self.channel.clone().unwrap_or_default();
        let options = read::Options { dt: self.dt, unit, channel, text: self.text.stated() };
        Ok((read_record(&self.record, &options)?, vec![self.record.clone()]))
    }

    /// What is done to the record before it is fitted.
    fn recipe(&self, record: &Record) -> Result<Recipe, Failure> {
        let mut steps = Vec::new();
        if let Some(values) = &self.trim {
            let (from_s, to_s) = pair("--trim", values)?;
            let length = record.duration();
            if !(from_s >= 0.0 && from_s < to_s && from_s < length) {
                let text =
                    format!("--trim {from_s},{to_s}: expected FROM below TO within the record, 0 to {length:.3} s");
                return Err(Failure::Input(text));
            }
            steps.push(Step::Trim { from_s, to_s });
        }
        if let Some(text) = &self.scale_to {
            let peak = peak_acceleration(text).map_err(|e| Failure::Input(format!("--scale-to {e}")))?;
            steps.push(Step::ScaleToPeak { peak });
        }
        if !self.as_is {
            steps.extend(Recipe::specimen(record.dt).steps);
        }
        Ok(Recipe { steps })
    }

    fn condition(&self, record: &Record) -> Result<Motion, Failure> {
        let place = self.record.display();
        self.recipe(record)?.apply(record).map_err(|e| Failure::Input(format!("{place}: {e}")))
    }

    /// The conditioning in a sentence.
    fn conditioning(&self) -> String {
        let mut parts = Vec::new();
        if let Some([from, to]) = self.trim.as_deref() {
            parts.push(format!("{from} to {to} s of the record"));
        }
        parts.extend(self.scale_to.iter().map(|peak| format!("scaled to {peak}")));
        if self.as_is {
            parts.push("nothing else done to the record".into());
        } else {
            parts.push(Recipe::SPECIMEN.into());
        }
        parts.join("; ")
    }

    fn check_target(&self) -> Result<(), Failure> {
        match self.target {
            Some(target) if !(target > 0.0 && target.is_finite()) => {
                Err(Failure::Input(format!("--target {target}: expected a number above zero")))
            }
            _ => Ok(()),
        }
    }

    /// What it would take to meet the target, by the velocity limit and by all limits together.
    fn relaxations(&self, motion: &Motion, limits: &Limits, tell: impl Fn(&str)) -> Result<Vec<Relaxation>, Failure> {
        let Some(target) = self.target else { return Ok(Vec::new()) };
        let start = motion.displacement.first().copied().unwrap_or(0.0);
        let reference = Reference::new(motion.dt, motion.velocity.clone(), start).map_err(|e| failure(&e))?;
        let mut found = Vec::new();
        for relaxed in [Relaxed::Velocity, Relaxed::Stroke, Relaxed::All] {
            tell(&format!("looking for the smallest factor on {}", relaxed.name()));
            match certificate::relaxation(&reference, limits, relaxed, target) {
                Ok(relaxation) => found.extend(relaxation),
                // This limit alone cannot do it: the others may.
                Err(FitError::Infeasible(_)) => {}
                Err(e) => return Err(failure(&e)),
            }
        }
        Ok(found)
    }
}

impl From<AnswerError> for Failure {
    fn from(error: AnswerError) -> Self {
        Self::Work(format!("modify: {error}"))
    }
}

/// Refuses a value that no table has; where it would be one in thousandths or hundredths, that is asked.
fn in_range(name: &str, value: Option<f64>, (low, high): (f64, f64), unit: &str) -> Result<(), Failure> {
    let Some(value) = value.filter(|value| !(low..=high).contains(value)) else { return Ok(()) };
    let smaller = [1e-3, 1e-2].map(|f| value * f).into_iter().find(|v| (low..=high).contains(v));
    let meant = smaller.map_or_else(String::new, |v| format!("; did you mean {v} {unit}?"));
    Err(Failure::Input(format!("{name} {}: expected {low} to {high} {unit}{meant}", number(value))))
}

/// Two numbers of an argument, `FROM,TO`.
fn pair(name: &str, values: &[f64]) -> Result<(f64, f64), Failure> {
    if let [from, to] = values {
        return Ok((*from, *to));
    }
    Err(Failure::Input(format!("modify: {name} takes two numbers, FROM,TO; {} were given", values.len())))
}

/// Which exit status a failed fit has.
fn failure(error: &FitError) -> Failure {
    match error {
        FitError::Infeasible(_) | FitError::Solver(_) => Failure::Work(format!("modify: {error}")),
        FitError::OutsideStroke { .. } => Failure::Input(format!("modify: {error}: a larger --stroke holds it")),
        FitError::Limit { name, value } => {
            Failure::Input(format!("modify: --{name} {value}: expected a number above zero"))
        }
        other => Failure::Input(format!("modify: {other}")),
    }
}
