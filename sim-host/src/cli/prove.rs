//! `shakedown prove`: the diagnosis examined on concealed cases.

mod engine;
mod inject;
mod recordings;
mod stretches;
mod studies;

use super::failure::within;
use super::output::{Outputs, print_table, tell};
use super::shard::Shard;
use super::{Failure, progress};
use crate::files::json::JsonError;
use crate::prove::campaign::{CampaignError, Plan, join, run as examine};
use crate::prove::gates::Gate;
use crate::prove::record::Record;
use crate::prove::{Examinee as _, examiner, laboratory, page, summary};
use crate::report::{Page, Table};
use clap::Subcommand;
use engine::Engine;
use std::path::{Path, PathBuf};

/// The diagnosis examined on concealed cases, made by code that shares nothing with it.
#[derive(Debug, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  shakedown prove --cases 20 --seed 7                 a quick look
  shakedown prove --seed 7 --cases 1000 --out proof    resumable: run it again and it goes on
  shakedown prove --seed 7 --cases 1000 --out proof --shard 3/8
  shakedown prove --cases 20 --stratum 'single, gross' --kind leakage
  shakedown prove merge proof --report proof.html     joins the pieces to the result of one run
  shakedown prove recordings CHY027.toml KAU039.toml --report recordings.html
  shakedown prove recordings KAU039.toml --stretches 10
  shakedown prove seals --seed 7 --cases 1400          the salted hashes, to be published first"
)]
pub(crate) struct Args {
    #[command(subcommand)]
    part: Option<Part>,
    #[command(flatten)]
    deal: Deal,
    /// Folder for one file a case, with the whole diagnosis and the whole answer; without it the campaign cannot be resumed.
    #[arg(long, visible_alias = "keep", value_name = "DIR")]
    out: Option<PathBuf>,
    /// This piece of N, from 1: a self-contained part of the campaign.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Examines another program, asked by `COMMAND diagnose EXPERIMENT --json -`; docs/benchmark.md says what it reads and
    /// answers.
    #[arg(long, value_name = "COMMAND")]
    examinee: Option<String>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Which cases.
#[derive(Debug, Clone, clap::Args)]
struct Deal {
    /// Examiner: 2, or 1, which is frozen as it was.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    examiner: u8,
    /// Seed of the cases: every fresh one is a fresh examination.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Lock of the flaws that examiner 2 builds from its grammar; 0 is for development.
    #[arg(long, value_name = "N", default_value_t = 0)]
    lock: u64,
    /// Number of cases; the mix repeats every 220, with examiner 1 every 140.
    #[arg(long, value_name = "K", default_value_t = 220)]
    cases: u64,
    /// Deals this stratum only, for instance 'null', 'single, gross', 'pair'; may be repeated.
    #[arg(long, value_name = "NAME")]
    stratum: Vec<String>,
    /// Deals this kind of flaw only, by its identifier, pairs and triples left out; may be repeated.
    #[arg(long, value_name = "ID")]
    kind: Vec<String>,
    /// Leaves out the fits of each case without noise: several times as fast; what intervals are to cover and what a library's
    /// equation cannot explain is then not known.
    #[arg(long)]
    quick: bool,
}

impl Deal {
    fn plan(&self, shard: Shard, engine: String) -> Result<Plan, Failure> {
        within("--cases", self.cases as f64, 1.0, 1e7, "")?;
        if self.examiner == 1 && !(self.stratum.is_empty() && self.kind.is_empty() && self.lock == 0) {
            return Err(Failure::Input("--stratum, --kind and --lock are of examiner 2".into()));
        }
        let known = examiner::strata();
        if let Some(other) = self.stratum.iter().find(|name| !known.contains(name)) {
            return Err(Failure::Input(format!("--stratum '{other}' is none of: {}", known.join("; "))));
        }
        let plan = Plan {
            examiner: self.examiner,
            lock: self.lock,
            strata: self.stratum.clone(),
            kinds: self.kind.clone(),
            seed: self.seed,
            cases: self.cases,
            shard: shard.number,
            shards: shard.of,
            engine,
            quick: self.quick,
        };
        let whole = Plan { shard: 1, shards: 1, ..plan.clone() };
        if whole.numbers().is_empty() {
            return Err(Failure::Input("no case is of these strata and kinds".into()));
        }
        Ok(plan)
    }
}

#[derive(Debug, Subcommand)]
enum Part {
    /// Joins the pieces of a campaign to the result of one run; names a piece that is lost.
    Merge {
        /// Folder with the pieces, in itself or one folder below.
        folder: PathBuf,
        /// Sums up the cases that are there, of a campaign that is not done.
        #[arg(long)]
        partial: bool,
        #[command(flatten)]
        outputs: Outputs,
    },
    /// Diagnoses real recordings and shows them side by side.
    Recordings {
        /// Experiments, each given a model that leaves out what is known to be there.
        #[arg(value_name = "EXPERIMENT.toml", required = true)]
        experiments: Vec<PathBuf>,
        /// Cuts each recording into stretches of this length (s), too, and counts how often each gives the names of the whole.
        #[arg(long, value_name = "S")]
        stretches: Option<f64>,
        #[command(flatten)]
        outputs: Outputs,
    },
    /// Fits the library's own equation to each form of a gross effect without noise: what is left says how far they are apart.
    Independence {
        #[command(flatten)]
        deal: Deal,
        /// Folder for one file a case.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        #[command(flatten)]
        outputs: Outputs,
    },
    /// Plants known faults into stretches of real recordings, asks for them, and asks for nothing of each stretch as it is.
    Inject(inject::Args),
    /// Calibrates probabilities on the cases that `--out` kept, and judges them on each kind of flaw left out in turn.
    Calibrate {
        /// Folder with the cases, in itself or one folder below.
        folder: PathBuf,
        #[command(flatten)]
        outputs: Outputs,
    },
    /// Prints each case's seal: a salted SHA-256 of its answer.
    Seals {
        #[command(flatten)]
        deal: Deal,
    },
}

/// Deals, examines, scores; or joins what was dealt and examined before.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    match &args.part {
        Some(Part::Merge { folder, partial, outputs }) => show(&joined(folder, *partial)?, outputs),
        Some(Part::Recordings { experiments, stretches, outputs }) => recordings::run(experiments, *stretches, outputs),
        Some(Part::Independence { deal, out, outputs }) => studies::forms(deal, out.as_deref(), outputs),
        Some(Part::Inject(args)) => inject::run(args),
        Some(Part::Calibrate { folder, outputs }) => studies::constants(folder, outputs),
        Some(Part::Seals { deal }) => {
            seals(&deal.plan(Shard { number: 1, of: 1 }, String::new())?);
            Ok(())
        }
        None => campaign(args),
    }
}

fn campaign(args: &Args) -> Result<(), Failure> {
    if let Some(folder) = args.out.as_ref().filter(|folder| folder.exists() && !folder.is_dir()) {
        return Err(Failure::Input(format!("--out {}: is a file; name a folder", folder.display())));
    }
    let scratch = tempfile::tempdir().map_err(|e| Failure::Work(format!("no temporary folder: {e}")))?;
    let folder = args.out.as_deref().unwrap_or(scratch.path());
    let engine = Engine::new(args.examinee.as_deref())?;
    let plan = args.deal.plan(args.shard, engine.version())?;
    let bar = progress::bar(plan.numbers().len() as u64, "cases");
    examine(&plan, folder, &engine, &|n| bar.inc(n)).map_err(failure)?;
    bar.finish_and_clear();
    if plan.shards > 1 {
        let mine = plan.numbers().len();
        tell(&format!("shard {}/{}: {mine} cases in {}", plan.shard, plan.shards, folder.display()));
        tell(&format!("when all are there: shakedown prove merge {}", folder.display()));
        return Ok(());
    }
    show(&joined(folder, false)?, &args.outputs)
}

fn joined(folder: &Path, partial: bool) -> Result<(Plan, Vec<Record>), Failure> {
    join(folder, partial).map_err(failure)
}

/// What a campaign of either examiner comes to.
struct Shown {
    schema: &'static str,
    json: serde_json::Value,
    tables: Vec<Table>,
    page: Page,
    gates: Vec<Gate>,
    failed: Vec<String>,
}

fn shown(plan: &Plan, records: &[Record]) -> serde_json::Result<Shown> {
    if plan.examiner == 1 {
        let summary = summary::summarise(plan, records);
        return Ok(Shown {
            schema: "shakedown.proof/1",
            json: serde_json::to_value(&summary)?,
            tables: vec![
                page::gate_table(&summary.gates),
                page::row_table(&summary.strata, "Stratum", ""),
                page::beside_table(&summary.beside),
            ],
            page: page::page(&summary),
            gates: summary.gates,
            failed: summary.failed,
        });
    }
    let summary = laboratory::summarise(plan, records);
    Ok(Shown {
        schema: "shakedown.proof/2",
        json: serde_json::to_value(&summary)?,
        tables: vec![
            laboratory::page::miss_table(&summary),
            laboratory::page::fault_table(&summary),
            laboratory::page::row_table(&summary.strata, "Stratum"),
            page::gate_table(&summary.gates),
        ],
        page: laboratory::page::page(&summary),
        gates: summary.gates,
        failed: summary.failed,
    })
}

fn show((plan, records): &(Plan, Vec<Record>), outputs: &Outputs) -> Result<(), Failure> {
    if records.is_empty() {
        return Err(Failure::Input("there are no cases to sum up".into()));
    }
    let mut shown = shown(plan, records).map_err(|e| Failure::Work(e.to_string()))?;
    if !outputs.quiet() {
        shown.tables.iter().for_each(print_table);
    }
    if let Some(object) = shown.json.as_object_mut() {
        object.insert("schema".into(), shown.schema.into());
        object.insert("seed".into(), plan.seed.into());
    }
    outputs.write_json(shown.json, &[])?;
    outputs.write_report(&mut shown.page, &[])?;
    match (shown.failed.first(), shown.failed.len() == records.len()) {
        (Some(first), true) => return Err(Failure::Work(format!("no case was answered; the first: {first}"))),
        (Some(first), false) => tell(&format!("{} cases were not answered; the first: {first}", shown.failed.len())),
        (None, _) => {}
    }
    let missed: Vec<&str> = shown.gates.iter().filter(|g| g.holds == Some(false)).map(|g| g.name.as_str()).collect();
    if missed.is_empty() { Ok(()) } else { Err(Failure::Work(format!("gates missed: {}", missed.join("; ")))) }
}

fn seals(plan: &Plan) {
    for number in plan.numbers() {
        let (name, seal) = examiner::seal(plan, number);
        super::output::print(&format!("{name}\t{seal}\n"));
    }
}

fn failure(error: CampaignError) -> Failure {
    match error {
        CampaignError::Json(JsonError::File { .. }) | CampaignError::Seal(_) => Failure::Work(error.to_string()),
        _ => Failure::Input(error.to_string()),
    }
}
