//! `shakedown identify`: fits a model to recordings, with error bars, and judges it on the runs held back.

mod page;
mod transfer;

use super::output::{Outputs, print, print_table, write_whole};
use super::places::place;
use super::{Failure, failure, progress};
use serde_json::{Value, json};
use shakedown::identify::frequency::transfer::Trial;
use shakedown::identify::judge::Score;
use shakedown::identify::outcome::{Identified, IdentifyError, identify};
use shakedown::identify::transfer::Transfer;
use shakedown::recording::Experiment;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Fits the parameters an experiment lists in `fit`, with intervals, and judges the model on runs held back.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown identify experiment.toml
  shakedown identify experiment.toml --out table.toml --report fit.html")]
pub(crate) struct Args {
    /// The experiment: model, channels, runs (`shakedown init` writes one).
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Writes the fitted model, for `run` and `diagnose`.
    #[arg(long, value_name = "FILE", value_parser = place())]
    out: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Fits, judges and shows.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let experiment =
        Experiment::load(&args.experiment).map_err(|e| failure::refused(&args.experiment, e, failure::EXPERIMENT))?;
    super::source::told(&experiment);
    let spinner = progress::spinner("fitting".into());
    let found = identify(&experiment).map_err(|e| failure(args, e));
    spinner.finish_and_clear();
    let found = found?;
    args.outputs.write_json(value(&found), &experiment.inputs)?;
    args.outputs.write_report(&mut page::page(&experiment.name, &found), &experiment.inputs)?;
    if let Some(path) = &args.out {
        write_whole(path, found.model(&experiment.model).to_toml().as_bytes())?;
    }
    if !args.outputs.quiet() {
        if !found.quantities.is_empty() {
            print_table(&page::parameters(&found));
        }
        print(&format!("\n{}\n", page::lead(&found)));
        for doubt in found.doubts() {
            print(&format!("  {doubt}\n"));
        }
        for finding in &found.findings {
            print(&format!("\n  {}, {}: {}\n    {}\n", finding.run, finding.channel, finding.problem, finding.remedy));
        }
    }
    Ok(())
}

fn failure(args: &Args, error: IdentifyError) -> Failure {
    match error {
        IdentifyError::Simulate(e) => Failure::Work(e.to_string()),
        other => Failure::Input(format!("{}: {other}", args.experiment.display())),
    }
}

fn value(found: &Identified) -> Value {
    let noise: BTreeMap<&str, f64> =
        found.prepared.fit.iter().flat_map(|run| &run.measured).map(|m| (m.channel.name(), m.noise)).collect();
    let mut fit = standing(&found.fitted);
    fit["converged"] = found.fit.converged().into();
    fit["evaluations"] = found.fit.evaluations.into();
    json!({
        "parameters": found.quantities,
        "fit": fit,
        "holdout": standing(&found.held_back),
        "noise": noise,
        "transfer_function": found.transfer.as_ref().map(function),
        "doubts": found.doubts(),
        "findings": found.findings,
    })
}

/// The transfer function from command to motion and the orders it was chosen among.
fn function(transfer: &Transfer) -> Value {
    let trial = |trial: &Trial| {
        let function = &trial.fit.function;
        json!({
            "numerator": function.numerator,
            "denominator": function.denominator,
            "integrators": function.integrators,
            "delay": function.delay,
            "std": trial.fit.std,
            "chi2": trial.fit.chi2,
            "chi2_held_back": trial.held_back,
        })
    };
    json!({
        "output": transfer.output.name(),
        "judged_by": if transfer.by_runs { "runs held back" } else { "second halves of the runs" },
        "chosen": transfer.trials.first().map(trial),
        "tried": transfer.trials.iter().map(trial).collect::<Vec<_>>(),
    })
}

fn standing(score: &Score) -> Value {
    let nrmse: BTreeMap<&str, f64> = score.nrmse.iter().map(|(c, value)| (c.name(), *value)).collect();
    let r2: BTreeMap<&str, f64> = nrmse.iter().map(|(&c, value)| (c, 1.0 - value * value)).collect();
    json!({ "chi2": score.chi2, "nrmse": nrmse, "r2": r2 })
}
