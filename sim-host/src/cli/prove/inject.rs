//! `prove inject`: stretches of real recordings, each diagnosed as it is and with a known fault planted. Nothing of a recording
//! is kept: a stretch lives in a temporary folder while it is diagnosed.

mod units;

use super::super::output::{Outputs, print_table};
use super::super::places::file_name;
use super::super::{Failure, progress};
use super::engine::Engine;
use crate::prove::inject::{Claims, Fault, Kind, LEAST, Trial, claims, found, misses, mistaken_for, table};
use crate::prove::page::gate_table;
use crate::prove::{Examinee as _, inject};
use crate::recording::Experiment;
use crate::recording::channel::Channel;
use crate::recording::run::Run;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use units::si;

/// Real recordings with known faults planted.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Experiments on real recordings, whatever their models leave out: what is found in the whole is stated of each stretch.
    #[arg(value_name = "EXPERIMENT.toml", required = true)]
    experiments: Vec<PathBuf>,
    /// Seed of the faults.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of stretches.
    #[arg(long, value_name = "K", default_value_t = 250)]
    stretches: u64,
    /// Length of a stretch (s), at least 10.
    #[arg(long, value_name = "S", default_value_t = 12.0)]
    length: f64,
    /// Folder for one file a stretch, so that it can go on; of the recordings it holds nothing.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Examines another program.
    #[arg(long, value_name = "COMMAND")]
    examinee: Option<String>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Rows before a stretch that its file holds, so that it is plain that the table moved already.
const BEFORE: usize = 20;

/// A recording with what was found in the whole of it.
struct Source {
    experiment: Experiment,
    /// The experiment's text as a table: its channels' noise and its runs' controllers.
    text: toml::Table,
    /// The model that the diagnosis of the whole wrote: the twin.
    model: toml::Table,
    /// What is claimed of the whole once the twin is stated.
    whole: Claims,
}

/// A stretch of a recording.
#[derive(Clone, Copy)]
struct Stretch {
    source: usize,
    run: usize,
    from: usize,
    rows: usize,
}

pub(super) fn run(args: &Args) -> Result<(), Failure> {
    super::within("--length", args.length, 10.0, 1e4, "s")?;
    super::within("--stretches", args.stretches as f64, 1.0, 1e6, "")?;
    let engine = Engine::new(args.examinee.as_deref())?;
    let scratch = tempfile::tempdir().map_err(|e| Failure::Work(format!("no temporary folder: {e}")))?;
    let bar = progress::bar(args.stretches + args.experiments.len() as u64, "stretches");
    let mut sources = Vec::new();
    for (i, path) in args.experiments.iter().enumerate() {
        sources.push(source(&engine, path, &scratch.path().join(format!("whole-{i}")))?);
        bar.inc(1);
    }
    let stretches = stretches(&sources, args.length, args.stretches as usize);
    if stretches.is_empty() {
        return Err(Failure::Input(format!("no run is {} s long", args.length)));
    }
    let each: Vec<Option<Trial>> = stretches
        .par_iter()
        .enumerate()
        .map(|(number, stretch)| {
            let kept = args.out.as_ref().map(|folder| folder.join(format!("stretch-{number:04}.json")));
            let trial = match kept.as_ref().and_then(|path| crate::files::json::read::<Trial>(path).ok()) {
                Some(trial) => Some(trial),
                None => trial(&engine, &sources[stretch.source], *stretch, args.seed, number as u64)?,
            };
            if let (Some(path), Some(trial)) = (kept, &trial) {
                keep(&path, trial)?;
            }
            bar.inc(1);
            Ok(trial)
        })
        .collect::<Result<_, Failure>>()?;
    bar.finish_and_clear();
    show(inject::summarise(each.into_iter().flatten().collect()), &args.outputs)
}

fn keep(path: &Path, trial: &Trial) -> Result<(), Failure> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|e| Failure::Work(format!("{}: {e}", folder.display())))?;
    crate::files::json::write(path, serde_json::to_string_pretty(trial)).map_err(|e| Failure::Work(e.to_string()))
}

fn show(summary: inject::Summary, outputs: &Outputs) -> Result<(), Failure> {
    if summary.trials.is_empty() {
        return Err(Failure::Work("no stretch could be diagnosed".into()));
    }
    let mut json = serde_json::to_value(&summary).map_err(|e| Failure::Work(e.to_string()))?;
    if let Some(object) = json.as_object_mut() {
        object.insert("schema".into(), "shakedown.injected/1".into());
    }
    outputs.write_json(json, &[])?;
    if !outputs.quiet() {
        [misses(&summary), table(&summary), gate_table(&summary.gates)].iter().for_each(print_table);
    }
    let missed: Vec<&str> = summary.gates.iter().filter(|g| g.holds == Some(false)).map(|g| g.name.as_str()).collect();
    if missed.is_empty() { Ok(()) } else { Err(Failure::Work(format!("gates missed: {}", missed.join("; ")))) }
}

/// Diagnoses the whole recording and keeps the model that comes of it.
fn source(engine: &Engine, path: &Path, scratch: &Path) -> Result<Source, Failure> {
    let input = |e: &dyn std::fmt::Display| Failure::Input(format!("{}: {e}", path.display()));
    let experiment = Experiment::load(path).map_err(|e| Failure::Input(e.to_string()))?;
    let text = std::fs::read_to_string(path).map_err(|e| input(&e))?;
    let text: toml::Table = text.parse().map_err(|e| input(&e))?;
    let twin = scratch.with_extension("toml");
    let first = engine.twin(path, &twin).map_err(Failure::Work)?;
    let model = std::fs::read_to_string(&twin).map_err(|e| Failure::Work(format!("{}: {e}", twin.display())))?;
    let model: toml::Table = model.parse().map_err(|e| input(&e))?;
    let model = free(model);
    let again = scratch.with_extension("again.toml");
    std::fs::write(&again, stated_with(&text, &model, path).to_string()).map_err(|e| input(&e))?;
    let mut whole = claims(&engine.diagnose(&again).map_err(Failure::Work)?.diagnosis);
    whole.0.extend(mistaken_for(&first).0);
    Ok(Source { experiment, text, model, whole })
}

/// The whole experiment with the twin for its model: what is claimed of it then is what is the recording's own.
fn stated_with(text: &toml::Table, model: &toml::Table, path: &Path) -> toml::Table {
    let mut out = text.clone();
    out.remove("effects");
    out.extend(model.clone());
    let folder = path.canonicalize().ok().and_then(|p| p.parent().map(Path::to_path_buf)).unwrap_or_default();
    for run in out.get_mut("runs").and_then(toml::Value::as_array_mut).into_iter().flatten() {
        if let Some(file) = run.get_mut("file") {
            let place = folder.join(file.as_str().unwrap_or_default());
            *file = place.to_string_lossy().into_owned().into();
        }
    }
    out
}

/// The twin with its effects' parameters free, as its own are.
fn free(mut model: toml::Table) -> toml::Table {
    if let Some(table) = model.get_mut("model").and_then(toml::Value::as_table_mut) {
        let list = |key: &str| table.get(key).and_then(toml::Value::as_array).cloned().unwrap_or_default();
        let mut fit = list("fit");
        fit.extend(list("effects"));
        table.insert("fit".into(), fit.into());
    }
    model
}

/// Stretches dealt evenly over all runs, as many of each as it is long.
fn stretches(sources: &[Source], length: f64, wanted: usize) -> Vec<Stretch> {
    let mut room = Vec::new();
    for (source, one) in sources.iter().enumerate() {
        for (run, recorded) in one.experiment.runs.iter().enumerate() {
            let rows = (length / recorded.dt).ceil() as usize;
            if recorded.len() >= rows {
                room.push((source, run, rows, recorded.len() - rows, recorded.dt));
            }
        }
    }
    let whole: f64 = room.iter().map(|r| r.3 as f64 * r.4).sum();
    let mut out = Vec::new();
    for (source, run, rows, spare, dt) in room {
        let share = if whole > 0.0 { spare as f64 * dt / whole } else { 1.0 };
        let count = ((wanted as f64 * share).round() as usize).max(1);
        out.extend((0..count).map(|i| Stretch {
            source,
            run,
            from: i * spare / count.max(2).saturating_sub(1).max(1),
            rows,
        }));
    }
    out.retain(|s| s.from + s.rows <= sources[s.source].experiment.runs[s.run].len());
    out
}

/// One stretch, asked as it is and with a fault; none where no fault can be planted.
fn trial(engine: &Engine, source: &Source, stretch: Stretch, seed: u64, number: u64) -> Result<Option<Trial>, Failure> {
    let whole = &source.experiment.runs[stretch.run];
    let first = stretch.from.saturating_sub(BEFORE);
    let run = whole.part(first, stretch.from + stretch.rows);
    let mut rng = ChaCha8Rng::seed_from_u64(seed.wrapping_mul(1_000_003) ^ number);
    let scale = source.model.get("model").and_then(|m| value(m.get("scale")?));
    let planted = (0..Kind::ALL.len()).find_map(|i| {
        let kind = Kind::ALL[(number as usize + i) % Kind::ALL.len()];
        let mut spoilt = run.clone();
        Fault::plant(kind, &mut spoilt, stretch.from - first, scale, LEAST, &mut rng).map(|fault| (fault, spoilt))
    });
    let Some((fault, spoilt)) = planted else { return Ok(None) };
    let ask = |run: &Run| -> Result<Claims, Failure> {
        let folder = tempfile::tempdir().map_err(|e| Failure::Work(format!("no temporary folder: {e}")))?;
        let path = write(source, stretch, run, first, folder.path()).map_err(|e| Failure::Work(e.to_string()))?;
        Ok(engine.diagnose(&path).map_or_else(|e| failed(&e), |answer| claims(&answer.diagnosis)))
    };
    let (untouched, planted) = (ask(&run)?, ask(&spoilt)?);
    Ok(Some(Trial {
        number,
        recording: file_name(&whole.path),
        from_s: whole.time[stretch.from],
        to_s: whole.time[stretch.from + stretch.rows - 1],
        found: found(&fault, &planted, &untouched),
        false_claims: untouched.beyond(&source.whole),
        fault,
        planted,
        untouched,
    }))
}

/// A diagnosis that failed claims something that no recording has.
fn failed(error: &str) -> Claims {
    claims(&serde_json::json!({"set_up": [{"what": format!("failed: {error}")}]}))
}

fn value(entry: &toml::Value) -> Option<f64> {
    entry.as_float().or_else(|| entry.get("value")?.as_float())
}

/// Writes a stretch as an experiment of its own, in SI.
fn write(source: &Source, stretch: Stretch, run: &Run, first: usize, folder: &Path) -> std::io::Result<PathBuf> {
    let channels: Vec<Channel> =
        run.channels.iter().map(|(channel, _)| channel).filter(|c| *c != Channel::Time).collect();
    let mut rows = String::from("time");
    for channel in &channels {
        let _ = write!(rows, ",{}", channel.name());
    }
    for k in 0..run.len() {
        let _ = write!(rows, "\n{:?}", run.time[k]);
        for channel in &channels {
            let v = run.channel(*channel).map_or(f64::NAN, |values| values[k]);
            let _ = if v.is_finite() { write!(rows, ",{v:e}") } else { write!(rows, ",") };
        }
    }
    std::fs::write(folder.join("stretch.csv"), rows + "\n")?;
    let mut table = source.model.clone();
    table.insert("name".into(), "stretch".into());
    let mut stated = toml::Table::new();
    stated.insert("time".into(), column("time", "s", None));
    for channel in &channels {
        let unit = si(*channel, source.text.get("channels").and_then(|c| c.get(channel.name())));
        stated.insert(channel.name().into(), column(channel.name(), unit, run.noise.get(*channel).copied()));
    }
    table.insert("channels".into(), stated.into());
    let mut entry = toml::Table::new();
    entry.insert("file".into(), "stretch.csv".into());
    if stretch.from > first {
        entry.insert("from_s".into(), run.time[stretch.from - first].into());
    }
    let stated = source.text.get("runs").and_then(|runs| runs.get(stretch.run));
    if let Some(controller) = stated.and_then(|run| run.get("controller")) {
        entry.insert("controller".into(), controller.clone());
    }
    table.insert("runs".into(), vec![toml::Value::from(entry)].into());
    let path = folder.join("experiment.toml");
    std::fs::write(&path, table.to_string())?;
    Ok(path)
}

fn column(name: &str, unit: &str, noise: Option<f64>) -> toml::Value {
    let mut table = toml::Table::new();
    table.insert("column".into(), name.into());
    table.insert("unit".into(), unit.into());
    if let Some(noise) = noise.filter(|n| n.is_finite()) {
        table.insert("noise".into(), noise.into());
    }
    table.into()
}

impl Engine {
    /// Diagnoses an experiment and writes the model that comes of it.
    fn twin(&self, experiment: &Path, model: &Path) -> Result<Value, String> {
        self.diagnose_with(experiment, &["--model".as_ref(), model.as_os_str()])
    }
}
