//! `shakedown run`: a closed-loop test of the control core against the plant.

mod page;
mod trace;

use super::output::{Outputs, tell};
use super::places::place;
use super::source::{Source, Text, plausible};
use super::written::provenance;
use super::{Failure, described, failure, indices, present, progress, unseen};
use crate::closed_loop::named;
use crate::closed_loop::scenario::{Conditioning, NamedRecipe, RecordSource, Scenario};
use crate::closed_loop::trial::{ScoredSignal, Scores, Setup, Trial, TrialError};
use crate::motion::Motion;
use crate::motion::condition::{self, Step, peak_acceleration};
use crate::motion::drive::Drive;
use crate::motion::fit::FitError;
use crate::motion::fit::named::{PREVIEW, RecordFit};
use crate::motion::metrics::Indices;
use crate::plant::sensors::{GRAVITY, SensorModel};
use clap::ValueEnum;
use serde_json::json;
use shakedown_core::Modification;
use std::path::PathBuf;
use std::time::Instant;

/// A closed-loop test: the control core drives the paper's plant along a ground motion.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown run                                          a generated near-field motion, the gains in use
  shakedown run --record kobe.AT2 --controller strong --report kobe.html
  shakedown run --record kobe.AT2 --controller strong --fit convex --scale-to 0.74g
  shakedown run --record kobe.AT2 --controller strong --modification preview
  shakedown run --record elcentro.AT2 --conditioning fitting --fit nearest --controller tracking
  shakedown run --record kobe.AT2 --table found.toml      on the table that a diagnosis described
  shakedown run --record a.txt --dt 0.005 --unit g --modification causal --trace a.csv
  shakedown run SCENARIO.toml --json -

A scenario names all of this in a file:
  controller = \"strong\"
  fit = \"convex\"
  [record]
  file = \"kobe.AT2\"
  [sensors]
  displacement_step = 4e-5")]
pub(crate) struct Args {
    /// The test as a file; command-line options override it.
    #[arg(value_name = "SCENARIO.toml")]
    scenario: Option<PathBuf>,
    #[command(flatten)]
    source: Source,
    /// Controller of Table 1, or `tracking`, the core's own law for the paper's table [default: current].
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(named::names()))]
    controller: Option<String>,
    /// What the record is made into: `specimen` as `modify` does, all of it above 0.1 Hz; `table1` low-passes it at 4.7 Hz as
    /// the paper's references are, `plain` does not; all add rest [default: specimen].
    #[arg(long, value_enum)]
    conditioning: Option<Recipe>,
    /// Scales the motion to a peak acceleration, such as 0.74g or 3m/s2.
    #[arg(long, value_name = "PEAK")]
    scale_to: Option<String>,
    /// Brings the motion within the table's limits beforehand: any method of `modify` by its name, or the paper's
    /// choices of Fig. 13 (peak-kept, peak-scaled, record-scaled, time-compressed).
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(RecordFit::names()))]
    fit: Option<String>,
    /// The table's file: a model as `identify` and `diagnose --model` write it, and what `[table]` describes beside it: stroke,
    /// controller, valve [default: table.toml of this folder, else the paper's table].
    #[arg(long, value_name = "TABLE.toml")]
    table: Option<PathBuf>,
    /// How the core modifies the reference online [default: clip for `modified`, else off].
    #[arg(long, value_enum)]
    modification: Option<Online>,
    /// Writes the run as a recording: CSV, one row a tick, units in the header.
    #[arg(long, value_name = "FILE", value_parser = place())]
    trace: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Conditioning by name.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Recipe {
    /// As `modify` does: nothing below 0.1 Hz.
    Specimen,
    /// As the paper's references are: nothing above 4.7 Hz.
    Table1,
    /// All of it.
    Plain,
    /// As fits are measured: 200 Hz, 40 s, nothing below 0.1 Hz.
    Fitting,
}

/// The core's modifiers.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Online {
    /// Not at all.
    Off,
    /// Eq. 10.
    Clip,
    /// Drift-free, within the stroke, without preview.
    Causal,
    /// The same with half a second of preview: the table follows half a second late.
    Preview,
}

impl Args {
    /// The scenario with what the command line says put over it.
    fn scenario(&self) -> Result<Scenario, Failure> {
        let hint = "a scenario is TOML; a ground motion is given by --record";
        let other = |message: String| match message.split('`').nth(1) {
            Some("model" | "effects" | "effect") => message + "; a table's model is given by --table",
            Some("channels" | "runs") => message + "; an experiment is for `identify` and `diagnose`",
            _ => message,
        };
        let read =
            |path: &PathBuf| Scenario::read(path).map_err(|e| failure::refused(path, other(e.to_string()), hint));
        let mut scenario = self.scenario.as_ref().map_or_else(|| Ok(Scenario::default()), read)?;
        if scenario.name.is_empty() {
            scenario.name = "run".into();
        }
        if let Some(name) = &self.controller {
            (scenario.controller, scenario.settings) = (Some(name.clone()), None);
        }
        let source = &self.source;
        if source.record.is_some() || source.seed.is_some() {
            scenario.record =
                RecordSource { file: source.record.clone(), seed: source.seed, ..RecordSource::default() };
        }
        let record = &mut scenario.record;
        if let (Some(option), None) = (source.text.given(), &record.file) {
            return Err(Failure::Input(format!("{option} describes a file: give it with --record FILE")));
        }
        record.dt = source.dt.or(record.dt);
        record.unit = source.unit.clone().or(record.unit.take());
        record.channel = source.channel.clone().or(record.channel.take());
        scenario.table = self.table.clone().or(scenario.table);
        scenario.scale_to = self.scale_to.clone().or(scenario.scale_to);
        scenario.conditioning = match self.conditioning {
            None => scenario.conditioning,
            Some(Recipe::Specimen) => Conditioning::Named(NamedRecipe::Specimen),
            Some(Recipe::Table1) => Conditioning::Named(NamedRecipe::Table1),
            Some(Recipe::Plain) => Conditioning::Named(NamedRecipe::Plain),
            Some(Recipe::Fitting) => Conditioning::Named(NamedRecipe::Fitting),
        };
        scenario.fit = self.fit.as_deref().and_then(RecordFit::parse).or(scenario.fit);
        scenario.modification = self.modification.map(Online::modification).or(scenario.modification);
        Ok(scenario)
    }
}

impl Online {
    fn modification(self) -> Modification {
        match self {
            Self::Off => Modification::Off,
            Self::Clip => Modification::Clip,
            Self::Causal => Modification::Causal,
            Self::Preview => Modification::Preview { seconds: PREVIEW as f32 },
        }
    }
}

/// A motion as it was asked for, and as it is played.
struct Played {
    name: String,
    /// What was done to it before it was played.
    conditioning: String,
    /// The provenance of a drive; empty for a record.
    drive: Vec<(String, String)>,
    original: Motion,
    fitted: Motion,
}

/// Reads, conditions, scales and fits the motion.
fn motion(scenario: &Scenario, text: &Text, setup: &Setup) -> Result<Played, Failure> {
    if let Some(played) = drive(scenario, text, setup)? {
        return Ok(played);
    }
    let record = &scenario.record;
    let source = Source {
        record: record.file.clone(),
        dt: record.dt,
        unit: record.unit.clone(),
        channel: record.channel.clone(),
        text: text.clone(),
        seed: record.seed,
    };
    let record = source.load().map_err(|failure| stated_at(scenario, failure))?;
    let place = source.record.as_ref().map_or_else(|| record.name.clone(), |path| path.display().to_string());
    let refuse = |what: &str, e: String| Failure::Input(format!("{place}: {what}{e}"));
    let mut recipe = scenario.recipe(setup.rate(), record.dt);
    recipe.steps.extend(scenario.scale.map(|factor| Step::Scale { factor }));
    if let Some(text) = &scenario.scale_to {
        let peak = peak_acceleration(text).map_err(|e| Failure::Input(format!("--scale-to: {e}")))?;
        recipe.steps.push(Step::ScaleToPeak { peak });
    }
    let original = recipe.apply(&record).map_err(|e| refuse("conditioning: ", e.to_string()))?;
    plausible(&place, &original);
    let fitted = match scenario.fit {
        None => original.clone(),
        Some(fit) => fitted(fit, &original, setup, &record.name).map_err(|e| refuse("fit: ", e.to_string()))?,
    };
    let conditioning = conditioning(scenario);
    Ok(Played { name: record.name, conditioning, drive: Vec::new(), original, fitted })
}

/// A record that was refused, with where the scenario names it.
fn stated_at(scenario: &Scenario, failure: Failure) -> Failure {
    let line = scenario.line("record", "file");
    match (failure, &scenario.source) {
        (Failure::Input(text), Some((path, _))) if !line.is_empty() => {
            Failure::Input(format!("{text} ({}{line})", path.display()))
        }
        (other, _) => other,
    }
}

/// A drive, played as it is; none where the file is no drive.
fn drive(scenario: &Scenario, text: &Text, setup: &Setup) -> Result<Option<Played>, Failure> {
    let Some(path) = &scenario.record.file else { return Ok(None) };
    let place = path.display();
    let Some(drive) = Drive::read(path).map_err(|e| Failure::Input(e.to_string()))? else { return Ok(None) };
    let record = &scenario.record;
    let given = [
        ("--fit", scenario.fit.is_some()),
        ("--scale-to", scenario.scale_to.is_some()),
        ("scale", scenario.scale.is_some()),
        ("--conditioning", !matches!(scenario.conditioning, Conditioning::Unstated)),
        ("--dt", record.dt.is_some()),
        ("--unit", record.unit.is_some()),
        ("--channel", record.channel.is_some()),
    ];
    let option = failure::first_given(given).or_else(|| text.given());
    if let Some(option) = option {
        return Err(Failure::Input(format!("{place}: is a drive and played as it is: leave {option} out")));
    }
    let rate = 1.0 / drive.dt;
    if (rate / setup.rate() - 1.0).abs() > 1e-6 {
        let wanted = setup.rate();
        return Err(Failure::Input(format!(
            "{place}: is a drive at {rate:.3} Hz and the controller runs at {wanted:.3} Hz: write it with `modify --rate {wanted}`"
        )));
    }
    say_stale(&drive, scenario, setup)?;
    let motion = drive.motion();
    plausible(&place.to_string(), &motion);
    let source = drive.fact("source").unwrap_or("a motion").to_owned();
    Ok(Some(Played {
        name: format!("drive from {source}"),
        conditioning: "none: a drive is played as it is".into(),
        drive: drive.facts,
        original: motion.clone(),
        fitted: motion,
    }))
}

/// Says where a learnt drive was learnt on another table or by another controller, before it is played.
fn say_stale(drive: &Drive, scenario: &Scenario, setup: &Setup) -> Result<(), Failure> {
    let learnt_on = provenance::learnt_on(scenario.table.as_deref(), page::controller(scenario), setup.rate())?;
    for (key, now) in learnt_on {
        let Some(then) = drive.fact(&key) else { continue };
        if then != now {
            tell(&format!(
                "warning: the drive is stale: it was learnt with {key} = {then}, and now it is {now}; learn it again before it is played \
                 on the table"
            ));
        }
    }
    Ok(())
}

/// What is done to a record before it is played, in words.
fn conditioning(scenario: &Scenario) -> String {
    let mut text = match &scenario.conditioning {
        Conditioning::Unstated | Conditioning::Named(NamedRecipe::Specimen) => {
            format!("specimen: {}", condition::Recipe::SPECIMEN)
        }
        Conditioning::Named(NamedRecipe::Table1) => {
            "table1: 3 s of rest before and 5 s after, 4.7 Hz 6th-order low-pass, 0.05 Hz high-pass".to_owned()
        }
        Conditioning::Named(NamedRecipe::Plain) => {
            "plain: 3 s of rest before and 5 s after, 0.05 Hz high-pass".to_owned()
        }
        Conditioning::Named(NamedRecipe::Fitting) => {
            "fitting: first 40 s, 200 Hz, 3 s of rest before and 5 s after, 0.1 Hz high-pass".to_owned()
        }
        Conditioning::Steps(recipe) => format!("{} steps of the scenario", recipe.steps.len()),
    };
    if let Some(factor) = scenario.scale {
        text += &format!("; scaled by {factor}");
    }
    if let Some(peak) = &scenario.scale_to {
        text += &format!("; scaled to {peak}");
    }
    text
}

/// The motion brought within the plant's speed and the settings' stroke.
fn fitted(fit: RecordFit, original: &Motion, setup: &Setup, name: &str) -> Result<Motion, FitError> {
    let spinner = progress::spinner(format!("fitting {name}"));
    let tell = |line: &str| spinner.set_message(format!("{name}: {line}"));
    let fitted = fit.apply(original, setup.table.velocity_limit(), f64::from(setup.settings.stroke), tell);
    spinner.finish_and_clear();
    fitted
}

/// A test, with the same test on ideal sensors, which tells the motion's errors from the sensors'.
struct Outcome {
    played: Played,
    ideal: Trial,
    sensed: Trial,
    truth: Scores,
    with_sensors: Scores,
    indices: Indices,
    times_real_time: f64,
}

fn test(played: Played, setup: &Setup) -> Result<Outcome, Failure> {
    let failed = |e: TrialError| match e {
        TrialError::NotFinite { .. } => Failure::Input(format!("run: {e}")),
        _ => Failure::Work(format!("run: {e}")),
    };
    let bar = progress::spinner(format!("testing with {}", played.name));
    let ideal_setup = Setup { sensors: SensorModel::default(), ..setup.clone() };
    let started = Instant::now();
    // A fit of the same length is held against the original sample by sample, at the control rate.
    let original = setup.at_rate(&played.original).map_err(failed)?;
    let ideal = ideal_setup.play(&played.fitted).map_err(failed)?.fitted_from(&original);
    let times_real_time = played.fitted.duration() / started.elapsed().as_secs_f64();
    let sensed = setup.play(&played.fitted).map_err(failed)?.fitted_from(&original);
    let truth = ideal.scores(ScoredSignal::Truly, None).map_err(failed)?;
    let with_sensors = sensed.scores(ScoredSignal::BySensors, None).map_err(failed)?;
    let indices = ideal.indices(ScoredSignal::Truly).map_err(failed)?;
    bar.finish_and_clear();
    Ok(Outcome { played, ideal, sensed, truth, with_sensors, indices, times_real_time })
}

/// A scenario with the table it runs on.
struct Ready {
    scenario: Scenario,
    described: described::Found,
    setup: Setup,
}

fn ready(mut scenario: Scenario) -> Result<Ready, Failure> {
    let described = described::found(scenario.table.as_deref())?;
    scenario.table.clone_from(&described.path);
    if scenario.controller.is_none() && scenario.settings.is_none() {
        scenario.controller.clone_from(&described.table.controller);
    }
    let mut setup = scenario.setup().map_err(|e| Failure::Input(e.to_string()))?;
    if let Some(stroke) = described.table.stroke {
        setup.settings.stroke = stroke as f32;
    }
    Ok(Ready { scenario, described, setup })
}

/// What `run --json` says of a scenario, for commands that run many.
pub(super) fn result(scenario: Scenario) -> Result<serde_json::Value, Failure> {
    let Ready { scenario, setup, .. } = ready(scenario)?;
    let outcome = test(motion(&scenario, &Text::default(), &setup)?, &setup)?;
    Ok(json(&outcome, &scenario))
}

/// Runs the test, prints its figures, writes `--json`, `--trace` and `--report`.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let Ready { scenario, described, setup } = ready(args.scenario()?)?;
    if scenario.settings.is_some() {
        unseen::say_unseen(&setup.settings);
    }
    let outcome = test(motion(&scenario, &args.source.text, &setup)?, &setup)?;
    if !args.outputs.quiet() {
        present::print_section(&page::figures_section(&outcome, &setup));
    }
    let files = [&args.scenario, &scenario.settings, &scenario.table, &scenario.record.file];
    let inputs: Vec<PathBuf> = files.into_iter().flatten().cloned().collect();
    if let Some(path) = &args.trace {
        trace::write(path, &outcome.sensed.trace)?;
    }
    args.outputs.write_json(json(&outcome, &scenario), &inputs)?;
    args.outputs.write_report(&mut page::page(&outcome, &scenario, &setup, &described.table)?, &inputs)
}

fn metrics(scores: &Scores) -> serde_json::Value {
    let (wanted, commanded) = (&scores.against_wanted, &scores.against_commanded);
    json!({
        "e_a": wanted.e_a.ratio, "e_a_squared": wanted.e_a.squared(),
        "e_a_commanded": commanded.e_a.ratio, "e_d": wanted.e_d.ratio, "e_d_commanded": commanded.e_d.ratio,
        "peak_g": wanted.response_peak / GRAVITY, "reference_peak_g": wanted.reference_peak / GRAVITY,
        "spike_ratio": wanted.spike_ratio(), "delay_s": wanted.e_a.delay, "saturated_s": scores.saturated_s,
    })
}

fn json(outcome: &Outcome, scenario: &Scenario) -> serde_json::Value {
    json!({
        "name": scenario.name, "record": outcome.played.name, "conditioning": outcome.played.conditioning,
        "fit": scenario.fit.map(|fit| format!("{fit:?}")),
        "drive": (!outcome.played.drive.is_empty()).then(|| {
            outcome.played.drive.iter().map(|(key, value)| (key.clone(), json!(value))).collect::<serde_json::Map<_, _>>()
        }),
        "controller": page::controller(scenario), "indices": indices::value(&outcome.indices),
        "metrics": metrics(&outcome.truth), "metrics_with_sensors": metrics(&outcome.with_sensors),
        "times_real_time": outcome.times_real_time, "seed": scenario.sensors.seed,
    })
}
