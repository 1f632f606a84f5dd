//! `shakedown prove`: the diagnosis examined on concealed cases.

mod engine;
mod recordings;

use super::output::{Outputs, print_table, tell};
use super::shard::Shard;
use super::{Failure, progress};
use clap::Subcommand;
use engine::Engine;
use shakedown::files::json::JsonError;
use shakedown::prove::campaign::{CampaignError, Plan, join, run as examine};
use shakedown::prove::summary::{Summary, summarise};
use shakedown::prove::{Examinee as _, page};
use std::path::{Path, PathBuf};

/// The diagnosis examined on concealed cases, made by code that shares nothing with it.
#[derive(Debug, clap::Args)]
#[command(
    args_conflicts_with_subcommands = true,
    after_help = "Examples:
  shakedown prove --cases 28 --seed 7                 a quick look
  shakedown prove --seed 7 --cases 1400 --out proof    resumable: run it again and it goes on
  shakedown prove --seed 7 --cases 1400 --out proof --shard 3/8
  shakedown prove merge proof --report proof.html     joins the pieces to the result of one run
  shakedown prove recordings CHY027.toml KAU039.toml --report recordings.html
  shakedown prove seals --seed 7 --cases 1400          the salted hashes, to be published first"
)]
pub(crate) struct Args {
    #[command(subcommand)]
    part: Option<Part>,
    #[command(flatten)]
    deal: Deal,
    /// Folder for one file a case; without it the campaign cannot be resumed.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// This piece of N, from 1: a self-contained part of the campaign.
    #[arg(long, value_name = "I/N", default_value = "1/1")]
    shard: Shard,
    /// Examines another `shakedown` binary than this one, for instance a frozen release.
    #[arg(long, value_name = "FILE")]
    examinee: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Which cases.
#[derive(Debug, Clone, Copy, clap::Args)]
struct Deal {
    /// Seed of the cases: every fresh one is a fresh examination.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of cases; the mix repeats every 140.
    #[arg(long, value_name = "K", default_value_t = 140)]
    cases: u64,
}

#[derive(Debug, Subcommand)]
enum Part {
    /// Joins the pieces of a campaign to the result of one run; names a piece that is lost.
    Merge {
        /// Folder with the pieces, in itself or one folder below.
        folder: PathBuf,
        #[command(flatten)]
        outputs: Outputs,
    },
    /// Diagnoses real recordings and shows them side by side.
    Recordings {
        /// Experiments, each given a model that leaves out what is known to be there.
        #[arg(value_name = "EXPERIMENT.toml", required = true)]
        experiments: Vec<PathBuf>,
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
        Some(Part::Merge { folder, outputs }) => show(&joined(folder)?, outputs),
        Some(Part::Recordings { experiments, outputs }) => recordings::run(experiments, outputs),
        Some(Part::Seals { deal }) => {
            seals(*deal);
            Ok(())
        }
        None => campaign(args),
    }
}

fn campaign(args: &Args) -> Result<(), Failure> {
    let scratch = tempfile::tempdir().map_err(|e| Failure::Work(format!("no temporary folder: {e}")))?;
    let folder = args.out.as_deref().unwrap_or(scratch.path());
    let engine = Engine::new(args.examinee.as_deref())?;
    let Deal { seed, cases } = args.deal;
    let plan = Plan { seed, cases, shard: args.shard.number, shards: args.shard.of, engine: engine.version() };
    let bar = progress::bar(plan.numbers().len() as u64, "cases");
    examine(&plan, folder, &engine, &|n| bar.inc(n)).map_err(failure)?;
    bar.finish_and_clear();
    if plan.shards > 1 {
        let mine = plan.numbers().len();
        tell(&format!("shard {}/{}: {mine} cases in {}", plan.shard, plan.shards, folder.display()));
        tell(&format!("when all are there: shakedown prove merge {}", folder.display()));
        return Ok(());
    }
    show(&joined(folder)?, &args.outputs)
}

fn joined(folder: &Path) -> Result<Summary, Failure> {
    let (plan, records) = join(folder).map_err(failure)?;
    Ok(summarise(&plan, &records))
}

fn show(summary: &Summary, outputs: &Outputs) -> Result<(), Failure> {
    if !outputs.quiet() {
        print_table(&page::gate_table(&summary.gates));
        print_table(&page::row_table(&summary.strata, "Stratum", ""));
        print_table(&page::beside_table(&summary.beside));
    }
    let mut json = serde_json::to_value(summary).map_err(|e| Failure::Work(e.to_string()))?;
    if let Some(object) = json.as_object_mut() {
        object.insert("schema".into(), "shakedown.proof/1".into());
        object.insert("seed".into(), summary.plan.seed.into());
    }
    outputs.write_json(json, &[])?;
    outputs.write_report(&mut page::page(summary), &[])?;
    match (&summary.failed.first(), summary.failed.len() as u64 == summary.plan.cases) {
        (Some(first), true) => Err(Failure::Work(format!("no case was answered; the first: {first}"))),
        (Some(first), false) => {
            tell(&format!("{} cases were not answered; the first: {first}", summary.failed.len()));
            Ok(())
        }
        (None, _) => Ok(()),
    }
}

fn seals(deal: Deal) {
    for case in shakedown_truth::cases(deal.seed, deal.cases) {
        super::output::print(&format!("{}\t{}\n", case.name, case.sealed.seal));
    }
}

fn failure(error: CampaignError) -> Failure {
    match error {
        CampaignError::Json(JsonError::File { .. }) | CampaignError::Seal(_) => Failure::Work(error.to_string()),
        _ => Failure::Input(error.to_string()),
    }
}
