//! `shakedown init`: a commented experiment from a user's own files.

use super::Failure;
use super::output::{print, write_whole};
use shakedown::recording::propose::{Proposal, propose};
use shakedown::recording::{Experiment, Severity, check};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Proposes an experiment for the recordings of a folder: columns, units and gains, each with its evidence.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown init recordings/                    writes recordings/experiment.toml
  shakedown init recordings/ --out kobe.toml    writes recordings/kobe.toml
  shakedown init recordings/ --out -            prints it

Then settle what it lists, and:
  shakedown identify recordings/experiment.toml
  shakedown diagnose recordings/experiment.toml")]
pub(crate) struct Args {
    /// The folder with the recordings: CSV or other text with a header line, or MATLAB v5.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Name of the experiment's file in that folder; `-` prints it.
    #[arg(long, value_name = "FILE", default_value = "experiment.toml")]
    out: PathBuf,
    /// Replaces a file of that name.
    #[arg(long)]
    force: bool,
}

/// Looks at the files, writes the experiment beside them and says what is still open.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let to_terminal = args.out.as_os_str() == "-";
    let path = args.folder.join(&args.out);
    if !to_terminal && path.exists() && !args.force {
        let message =
            format!("{}: is there already; name another with --out, or replace it with --force", path.display());
        return Err(Failure::Input(message));
    }
    let proposal = propose(&args.folder).map_err(|e| Failure::Input(e.to_string()))?;
    if to_terminal {
        print(&proposal.text);
        return Ok(());
    }
    write_whole(&path, proposal.text.as_bytes())?;
    print(&summary(&proposal, &path));
    Ok(())
}

fn summary(proposal: &Proposal, path: &Path) -> String {
    let mut text = format!("Wrote {} from {} recordings.\n", path.display(), proposal.files.len());
    for choice in &proposal.choices {
        let unit = choice.unit.map_or("unit unknown", |u| u.symbol);
        let mark = if choice.doubtful { "  CONFIRM" } else { "" };
        let _ = writeln!(text, "  {:<22} [{unit}]  {}{mark}", choice.channel.name(), choice.evidence.join("; "));
    }
    for (name, reason) in &proposal.left_out {
        let _ = writeln!(text, "Left out {name}: {reason}");
    }
    text.push_str("To settle:\n");
    for question in &proposal.open {
        let _ = writeln!(text, "  - {question}");
    }
    match Experiment::load(path) {
        Ok(experiment) => {
            for finding in check(&experiment) {
                let grave = if finding.severity == Severity::BadData { "BAD DATA" } else { "remark" };
                let _ = writeln!(text, "{grave}: {}: {}; {}", finding.run, finding.problem, finding.remedy);
            }
        }
        Err(error) => {
            let _ = writeln!(text, "It cannot be used before that: {error}");
        }
    }
    text
}
