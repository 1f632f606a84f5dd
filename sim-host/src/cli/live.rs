//! `shakedown live`: a bench watched and operated from a page in the browser.

use super::output::{Outputs, print, tell};
use super::reference::resampled;
use super::{Failure, desk, failure, table};
use crate::closed_loop::twin::Twin;
use crate::files::Unfinished;
use crate::live::{Attendant, Bench, Hub, Recorded, Server, SoftDevice, Storage, Summary, watch};
use crate::motion::condition::{Recipe, Step};
use crate::motion::generate;
use crate::motion::resample::Interpolation;
use crate::recording::Experiment;
use clap::ArgGroup;
use serde_json::json;
use std::path::PathBuf;
use std::time::Instant;

/// Shows a bench as it runs, on a page of this machine alone; starts, holds and stops its tests.
#[derive(Debug, clap::Args)]
#[command(group(ArgGroup::new("what").args(["port", "recording"])))]
#[command(after_help = "Examples:
  shakedown live                                         the twin: the firmware's own loop around the paper's table
  shakedown live reference.csv --table found.toml        a reference of yours on the twin of a table of yours
  shakedown live reference.csv --port /dev/ttyACM0 --out runs/
  shakedown live --port /dev/ttyACM0 --for 60 --out runs/    a device that takes its reference from its converter
  shakedown live --recording run/experiment.toml         a recording, as if it were measured now

The page is served on the loopback address only, and its address holds a token that no other page knows. Keys: A arms (Enter
confirms), S starts, H fades out and holds, Esc stops and disarms, T trips. Closing the page changes nothing; Ctrl-C here
stops, disarms and saves what was recorded. A host that is killed leaves a streamed test to fade out by itself.")]
pub(crate) struct Args {
    /// The reference: text with a header line, columns `time` (s) and `reference` (m), or a drive of `modify`; without one the
    /// twin plays a generated near-field motion, and a device is only watched.
    #[arg(value_name = "FILE", conflicts_with = "recording")]
    file: Option<PathBuf>,
    /// The column with the reference.
    #[arg(long, value_name = "NAME", default_value = "reference")]
    column: String,
    /// The serial port of a device; without one, and without a recording, the twin.
    #[arg(long, value_name = "PORT")]
    port: Option<PathBuf>,
    /// Bits a second.
    #[arg(long, value_name = "BAUD", default_value_t = 1_000_000, requires = "port")]
    baud: u32,
    /// Length of a test of what is at the device's converter, s.
    #[arg(long = "for", value_name = "S", requires = "port", conflicts_with = "file")]
    time: Option<f64>,
    /// Plays a run of this experiment instead.
    #[arg(long, value_name = "EXPERIMENT.toml")]
    recording: Option<PathBuf>,
    /// Which run of it; one that is split to be held out counts as two.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "recording")]
    run: usize,
    /// How much faster it is played than it was recorded.
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, requires = "recording")]
    speed: f64,
    /// The twin's table, a model as `identify` and `diagnose --model` write it [default: the paper's table].
    #[arg(long, value_name = "TABLE.toml", conflicts_with_all = ["port", "recording"])]
    table: Option<PathBuf>,
    /// A device's page does not ask for the day's proof test (`device commission --daily`); a rehearsal's never does.
    #[arg(long, requires = "port")]
    without_proof_test: bool,
    /// Folder for the recordings, one folder a test; a device's tests need one.
    #[arg(long, value_name = "DIR", conflicts_with = "recording")]
    out: Option<PathBuf>,
    /// Port of the page [default: any that is free].
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    listen: u16,
    /// Opens the page in the browser.
    #[arg(long)]
    open: bool,
    /// Ends after so long, s.
    #[arg(long, value_name = "S")]
    seconds: Option<f64>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Watches until it is ended.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(seconds) = args.seconds {
        failure::within("--seconds", seconds, 0.1, 1e7, "s")?;
    }
    if let Some(experiment) = &args.recording {
        failure::within("--speed", args.speed, 0.01, 1000.0, "")?;
        let read = Experiment::load(experiment).map_err(|e| failure::refused(experiment, e, failure::EXPERIMENT))?;
        let refuse = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", experiment.display()));
        let recorded = Recorded::new(&read, args.run, args.speed).map_err(|e| refuse(&e))?;
        return serve(args, recorded, &read.inputs);
    }
    if args.port.is_some() {
        return device(args);
    }
    let setup_of = table(args.table.as_deref())?;
    let setup = SoftDevice::setup(&setup_of);
    let storage = Storage {
        reference: reference(args, f64::from(setup.control.rate))?,
        attended: None,
        folder: args.out.clone(),
        proof: None,
    };
    let name = args.table.as_ref().map_or_else(|| "the paper's table".to_owned(), |path| path.display().to_string());
    let twin = twin(&setup, setup_of, args)?;
    serve(args, Attendant::new(twin, "twin", name, setup, storage), &inputs(args))
}

/// The twin at work.
fn twin(setup: &shakedown_core::link::Setup, of: Twin, args: &Args) -> Result<SoftDevice, Failure> {
    let place = args.table.as_ref().map_or_else(String::new, |path| format!("{}: ", path.display()));
    SoftDevice::start(*setup, of).map_err(|e| Failure::Input(format!("{place}{e}")))
}

fn inputs(args: &Args) -> Vec<PathBuf> {
    args.file.iter().chain(&args.table).cloned().collect()
}

/// What the twin plays, m at `rate`, Hz.
fn reference(args: &Args, rate: f64) -> Result<Vec<f32>, Failure> {
    if let Some(file) = &args.file {
        return resampled(file, &args.column, rate);
    }
    let failed = |e: &dyn std::fmt::Display| Failure::Work(format!("generated motion: {e}"));
    let record = generate::NEAR_FIELD_STRONG.generate(1).map_err(|e| failed(&e))?;
    let mut recipe = Recipe::specimen(record.dt);
    recipe.steps.push(Step::Resample { rate_hz: rate, between: Interpolation::Linear });
    let motion = recipe.apply(&record).map_err(|e| failed(&e))?;
    Ok(motion.displacement.iter().map(|&x| x as f32).collect())
}

#[cfg(not(unix))]
fn device(_: &Args) -> Result<(), Failure> {
    Err(Failure::Input("--port: devices are reached from Linux and macOS only; leave it out to watch the twin".into()))
}

#[cfg(unix)]
fn device(args: &Args) -> Result<(), Failure> {
    use crate::device::{PROOF_TEST, Port, ProofTest, Session};
    use shakedown_core::link::Source;
    let path = args.port.clone().unwrap_or_default();
    let attended = match args.time {
        None => None,
        Some(time) => {
            failure::within("--for", time, 0.1, 86_400.0, "s")?;
            Some((1e3 * time) as u64)
        }
    };
    let has_test = args.file.is_some() || attended.is_some();
    if has_test && args.out.is_none() {
        return Err(Failure::Input(
            "--out DIR: where shall the tests be recorded? a device's tests are always kept".into(),
        ));
    }
    let refuse = |e: &dyn std::fmt::Display| {
        Failure::Input(format!("{}: {e}; `shakedown device list` shows the ports there are", path.display()))
    };
    let setup = Session::new(Port::open(&path, args.baud).map_err(|e| refuse(&e))?).setup();
    let setup = setup.map_err(|e| Failure::Work(e.to_string()))?;
    match (setup.wiring.source, &args.file, attended) {
        (Source::Analog, Some(file), _) => {
            return Err(Failure::Input(format!(
                "{}: the device takes its reference from its converter and would not play it; give --for S instead",
                file.display()
            )));
        }
        (Source::Streamed, _, Some(_)) => {
            return Err(Failure::Input(
                "--for: the device takes its reference through the link; give a FILE with one".into(),
            ));
        }
        _ => {}
    }
    let reference = match &args.file {
        Some(file) => resampled(file, &args.column, f64::from(setup.control.rate))?,
        None => Vec::new(),
    };
    let port = Port::open(&path, args.baud).map_err(|e| refuse(&e))?;
    let asks = !args.without_proof_test && setup.wiring.source != Source::Rehearsal;
    let proof = asks.then(|| ProofTest::new(PROOF_TEST));
    if let Some(overdue) = proof.as_ref().filter(|_| has_test).and_then(ProofTest::overdue) {
        tell(&format!("note: {overdue}: the page will not arm before `device commission --daily`"));
    }
    let storage = Storage { reference, attended, folder: args.out.clone(), proof };
    let name = path.display().to_string();
    serve(args, Attendant::new(port, "device", name, setup, storage), &inputs(args))
}

/// Serves the page until it is ended.
fn serve(args: &Args, mut bench: impl Bench, inputs: &[PathBuf]) -> Result<(), Failure> {
    let hub = Hub::new(bench.facts());
    let server = Server::start(std::sync::Arc::clone(&hub), args.listen).map_err(|e| Failure::Input(e.to_string()))?;
    tell(&format!("live at {}\nCtrl-C stops, disarms and ends", server.address()));
    if args.open {
        desk::show(server.address())?;
    }
    let unfinished = Unfinished::begin();
    let begun = Instant::now();
    let over = |_: &_| {
        unfinished.asked_to_end() || args.seconds.is_some_and(|seconds| begun.elapsed().as_secs_f64() >= seconds)
    };
    let outcome = watch(&mut bench, &hub, over);
    drop(server);
    let summary = outcome.map_err(|e| Failure::Work(e.to_string()))?;
    say(args, &bench, &summary, inputs)
}

/// What was watched, in words, JSON and page.
fn say(args: &Args, bench: &impl Bench, summary: &Summary, inputs: &[PathBuf]) -> Result<(), Failure> {
    let facts = bench.facts();
    let value = json!({ "kind": facts.kind, "name": facts.name, "rate_hz": facts.rate, "watched": summary });
    args.outputs.write_json(value, inputs)?;
    let rows = [
        ("records", summary.samples.to_string()),
        ("records missing", summary.missing.to_string()),
        ("records dropped by the device", summary.dropped.to_string()),
        ("frames garbled on the line", summary.garbled.to_string()),
        ("watched for [s]", summary.seconds.to_string()),
        ("last said", summary.message.clone()),
    ];
    let lead = format!("{} {}: {} records, {} missing.", facts.kind, facts.name, summary.samples, summary.missing);
    args.outputs.write_report(&mut page(lead, &rows), inputs)?;
    if !args.outputs.quiet() {
        let lines: Vec<String> = rows.iter().map(|(name, value)| format!("{name}: {value}\n")).collect();
        print(&lines.concat());
    }
    Ok(())
}

fn page(lead: String, rows: &[(&str, String)]) -> crate::report::Page {
    use crate::report::{Item, Page, Section, Table};
    let rows = rows.iter().map(|(name, value)| vec![(*name).to_owned(), value.clone()]).collect();
    let table = Table { columns: vec![String::new(), "watched".into()], rows, caption: String::new() };
    let sections = vec![Section { heading: "What was watched".into(), items: vec![Item::Table(table)] }];
    Page { title: "A bench watched live".into(), lead, sections, ..Page::default() }
}
