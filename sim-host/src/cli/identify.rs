//! `shakedown identify`: fits a model to recordings, with error bars, and judges it on the hold-out runs.

mod page;
mod transfer;

use super::output::{Outputs, print, print_table, write_whole};
use super::places::place;
use super::{Failure, failure, progress};
use crate::identify::answer;
use crate::identify::outcome::{IdentifyError, identify};
use crate::recording::Experiment;
use std::path::PathBuf;

/// Fits the parameters an experiment lists in `fit`, with intervals, and judges the model on hold-out runs.
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
    args.outputs.write_json(answer::value(&found), &experiment.inputs)?;
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
