//! `shakedown faults`: the guard among random faults, and any one run of it again.

mod adversary;
mod healthy;
mod page;

use super::output::{Outputs, print_table, tell};
use super::shard::Shard;
use super::{Failure, progress};
use crate::faults::campaign::{join, run as run_all, run_shard};
use crate::faults::{Beside, CLASSES, CampaignError, Case, Class, Motions, Plan, Summary, rig, watcher};
use crate::files::json::JsonError;
use clap::builder::PossibleValuesParser;
use serde_json::json;
use std::path::PathBuf;

/// Random faults at random times in random records, judged by a watcher that knows the truth and not the guard.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown faults --runs 1000                                    a quick look
  shakedown faults --seed 1 --runs 100000 --out faults             resumable: run it again and it goes on
  shakedown faults --seed 1 --runs 100000 --out faults --shard 1/2
  shakedown faults --seed 1 --class lvdt-stuck --runs 500          one class alone
  shakedown faults --seed 1 --runs 100000 --guard-alone            without limit switches
  shakedown faults --seed 1 --runs 100000 --second-sensor          with a second displacement sensor instead of them
  shakedown faults --healthy 10000                                nothing wrong: no trip
  shakedown faults --adversary 2000 --class lvdt-stuck             the worst case of a class
  shakedown faults --found faults/adversary-lvdt-stuck.json --report run.html   that case, drawn
  shakedown faults --seed 1 --run 4711 --report run.html           one run again, drawn; the other arguments as they were

Ends with status 1 where a run broke what docs/hazards.md promises.")]
pub(crate) struct Args {
    /// Seed of every run.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of runs.
    #[arg(long, value_name = "K", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(1..))]
    runs: u64,
    /// Every fault from one class.
    #[arg(long, value_name = "CLASS", value_parser = PossibleValuesParser::new(CLASSES.iter().map(|class| class.id)))]
    class: Option<String>,
    /// Tables without the limit switches that docs/commissioning.md asks for: what the guard sees by itself.
    #[arg(long)]
    guard_alone: bool,
    /// Tables with a second displacement sensor that the device reads instead of the limit switches.
    #[arg(long, conflicts_with = "guard_alone")]
    second_sensor: bool,
    /// Folder with PEER records to take runs from beside the generated ones.
    #[arg(long, value_name = "DIR")]
    records: Option<PathBuf>,
    /// Folder for one file every thousand runs; without it the campaign cannot be resumed.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// This piece of N, from 1.
    #[arg(long, value_name = "I/N", default_value = "1/1", requires = "out")]
    shard: Shard,
    /// Runs this one again and shows it.
    #[arg(long, value_name = "NUMBER", conflicts_with_all = ["runs", "out"])]
    run: Option<u64>,
    /// So many tests with nothing wrong instead, which must not trip: tables, laws, records, and sines up to the envelope.
    #[arg(long, value_name = "K", conflicts_with_all = ["runs", "out", "run", "class", "guard_alone", "second_sensor"])]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    healthy: Option<u64>,
    /// Searches for the worst case of every class instead (cross-entropy), with so many runs each, rounded up to generations of 200;
    /// resumable with --out.
    #[arg(long, value_name = "K", conflicts_with_all = ["runs", "run", "healthy"])]
    #[arg(value_parser = clap::value_parser!(u64).range(1..))]
    adversary: Option<u64>,
    /// Shows the worst case that a search found and kept in this file (`adversary-CLASS.json`), or with --run another of those it kept.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["runs", "healthy", "adversary", "class", "seed", "out"])]
    #[arg(conflicts_with_all = ["guard_alone", "second_sensor"])]
    found: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

impl Args {
    /// The aid beside the guard.
    const fn beside(&self) -> Beside {
        match (self.guard_alone, self.second_sensor) {
            (true, _) => Beside::Nothing,
            (_, true) => Beside::SecondSensor,
            _ => Beside::LimitSwitches,
        }
    }

    /// The same as an argument.
    const fn beside_flag(&self) -> &'static str {
        match self.beside() {
            Beside::Nothing => " --guard-alone",
            Beside::SecondSensor => " --second-sensor",
            Beside::LimitSwitches => "",
        }
    }
}

/// Runs the campaign, or one run of it.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    if let Some(folder) = args.out.as_ref().filter(|folder| folder.exists() && !folder.is_dir()) {
        return Err(Failure::Input(format!("--out {}: is a file; name a folder", folder.display())));
    }
    let motions = Motions::new(args.records.as_deref()).map_err(|e| Failure::Input(e.to_string()))?;
    if let Some(runs) = args.healthy {
        return healthy::healthy(args, runs, &motions);
    }
    if let Some(runs) = args.adversary {
        return adversary::adversary(args, runs, &motions);
    }
    if let Some(file) = &args.found {
        return show_run(args, &adversary::case(file, args.run, &motions)?, &motions);
    }
    if let Some(number) = args.run {
        let only = args.class.as_deref().and_then(Class::named);
        return show_run(args, &Case::deal(args.seed, number, only, &motions).beside(args.beside()), &motions);
    }
    let plan = Plan {
        seed: args.seed,
        runs: args.runs,
        class: args.class.clone(),
        beside: args.beside(),
        records: motions.all.iter().map(|played| played.name.clone()).collect(),
        version: env!("CARGO_PKG_VERSION").into(),
    };
    let bar = progress::bar(plan.runs.div_ceil(args.shard.of), "runs");
    let outcomes = match &args.out {
        None => run_all(&plan, &motions, &|n| bar.inc(n)).map_err(failure)?,
        Some(folder) => {
            run_shard(&plan, (args.shard.number, args.shard.of), folder, &motions, &|n| bar.inc(n)).map_err(failure)?;
            match join(&plan, folder) {
                Err(missing @ CampaignError::Missing { .. }) if args.shard.of > 1 => {
                    bar.finish_and_clear();
                    tell(&format!("shard {}/{} is done; {missing}", args.shard.number, args.shard.of));
                    return Ok(());
                }
                joined => joined.map_err(failure)?,
            }
        }
    };
    bar.finish_and_clear();
    show(args, &Summary::of(&outcomes), &motions)
}

fn show(args: &Args, summary: &Summary, motions: &Motions) -> Result<(), Failure> {
    let sections = page::sections(summary, args.beside());
    if !args.outputs.quiet() {
        sections.iter().for_each(super::present::print_section);
    }
    let mut json = serde_json::to_value(summary).map_err(|e| Failure::Work(e.to_string()))?;
    if let Some(object) = json.as_object_mut() {
        object.insert("schema".into(), "shakedown.faults/1".into());
        object.insert("seed".into(), args.seed.into());
        object.insert("beside".into(), json!(args.beside()));
        object.insert("guard_alone".into(), args.guard_alone.into());
    }
    args.outputs.write_json(json, &motions.files)?;
    args.outputs.write_report(&mut page::page(summary, args.seed, sections), &motions.files)?;
    match summary.failed.first() {
        None => Ok(()),
        Some(first) => {
            let count = summary.failed.len();
            let class = args.class.as_ref().map_or_else(String::new, |class| format!(" --class {class}"));
            let again = format!("--seed {}{class}{} --run {}", args.seed, args.beside_flag(), first.run);
            Err(Failure::Work(format!("{count} runs broke a promise; the first: {again}")))
        }
    }
}

/// One run, judged and drawn.
fn show_run(args: &Args, case: &Case, motions: &Motions) -> Result<(), Failure> {
    let pair = rig::run(case).map_err(|e| Failure::Work(e.to_string()))?;
    let outcome = watcher::judge_pair(case, &pair);
    let name = motions.all.get(case.motion).map_or("", |played| played.name.as_str());
    let table = page::facts(case, &outcome, name);
    if !args.outputs.quiet() {
        print_table(&table);
    }
    let json = json!({"schema": "shakedown.faulted-run/1", "seed": args.seed, "outcome": outcome, "record": name,
                      "fault": case.fault, "table": case.table});
    args.outputs.write_json(json, &motions.files)?;
    args.outputs.write_report(&mut page::run_page(case, &pair, table), &motions.files)
}

fn failure(error: CampaignError) -> Failure {
    match error {
        CampaignError::Json(JsonError::File { .. }) | CampaignError::Rig(_) => Failure::Work(error.to_string()),
        _ => Failure::Input(error.to_string()),
    }
}
