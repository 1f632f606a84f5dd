//! `shakedown diagnose`: where model and recordings part, what physics was left out, how much better it fits.

mod change;
mod next;
pub(super) mod page;
mod place;
mod set_up;
mod term;
mod ties;
mod unfit;

use super::output::{Outputs, print, write_whole};
use super::places::{folder, place};
use super::{Failure, failure, progress};
use crate::diagnose::result::Verdict;
use crate::diagnose::{DiagnoseError, Diagnosis, Examined, Options, diagnose};
use crate::digits;
use crate::recording::Experiment;
use crate::recording::check::Finding;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Locates the mismatch of a model and recordings, names the missing physics, models it, shows the fit improve.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown diagnose experiment.toml
  shakedown diagnose experiment.toml --report diagnosis.html --model table.toml
  shakedown diagnose experiment.toml --json - | jq .effects
  shakedown diagnose experiment.toml --next next          writes the test that would settle what is open
  shakedown diagnose experiment.toml --with next/run.toml takes its recording beside the others")]
pub(crate) struct Args {
    /// The experiment: model, channels, runs (`shakedown init` writes one).
    #[arg(value_name = "EXPERIMENT.toml")]
    experiment: PathBuf,
    /// Writes the model with what was found, for `run`, `identify`, `modify` and `table1`.
    #[arg(long, value_name = "FILE", value_parser = place())]
    model: Option<PathBuf>,
    /// Writes the proposed next test: `drive.csv`, `scenario.toml` with the model found, and `run.toml` for `--with`.
    #[arg(long, value_name = "DIR", value_parser = folder())]
    next: Option<PathBuf>,
    /// Adds the runs of a file of `[[runs]]`, as `--next` writes one; may be repeated.
    #[arg(long, value_name = "RUN.toml")]
    with: Vec<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Diagnoses and shows what came out.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let experiment = Experiment::load_with(&args.experiment, &args.with)
        .map_err(|e| failure::refused(&args.experiment, e, failure::EXPERIMENT))?;
    super::source::told(&experiment);
    let spinner = progress::spinner("reading".into());
    let say = |what: &str, share: f64| progress::at(&spinner, what, share);
    let examined = diagnose(&experiment, &Options { progress: Some(&say) }).map_err(failure)?;
    spinner.finish_and_clear();
    let value = serde_json::to_value(&examined.diagnosis).map_err(|e| Failure::Work(e.to_string()))?;
    args.outputs.write_json(value, &experiment.inputs)?;
    args.outputs.write_report(&mut page::page(&experiment.name, &examined), &experiment.inputs)?;
    if let Some(path) = &args.model {
        write_whole(path, examined.augmented(&experiment.model).to_toml().as_bytes())?;
    }
    if let Some(folder) = &args.next {
        next::write(folder, &experiment, &examined)?;
    }
    if !args.outputs.quiet() {
        print(&summary(&examined.diagnosis, &examined));
    }
    Ok(())
}

pub(super) fn failure(error: DiagnoseError) -> Failure {
    match error {
        DiagnoseError::Simulate(e) => Failure::Work(e.to_string()),
        other => Failure::Input(other.to_string()),
    }
}

/// A fitted value with its standard deviation and unit; one that has the far larger deviation is not determined.
fn value(q: &crate::identify::quantity::Quantity) -> String {
    let unit = if q.unit == "1" { String::new() } else { format!(" {}", q.unit) };
    match q.std {
        Some(std) if digits::says_nothing(q.value, std) => {
            format!("{}{unit}, not determined by these runs", digits::three(q.value))
        }
        std => format!("{}{unit}", digits::with_spread(q.value, std)),
    }
}

/// What is wrong with the recordings: once for each channel and remedy, with how many runs more have it.
fn findings(findings: &[Finding]) -> String {
    let mut text = String::new();
    let alike = |a: &Finding, b: &Finding| (&a.channel, &a.remedy) == (&b.channel, &b.remedy);
    for (i, finding) in findings.iter().enumerate() {
        if findings.iter().take(i).any(|earlier| alike(earlier, finding)) {
            continue;
        }
        let _ = writeln!(text, "\n  {}, {}: {}", finding.run, finding.channel, finding.problem);
        match findings.iter().skip(i + 1).filter(|later| alike(later, finding)).count() {
            0 => {}
            more => _ = writeln!(text, "    the like in {more} more"),
        }
        let _ = writeln!(text, "    {}", finding.remedy);
    }
    text
}

/// The answer in a few lines.
fn summary(diagnosis: &Diagnosis, examined: &Examined) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "{}", page::lead(diagnosis));
    let lines = set_up::lines(diagnosis);
    if !lines.is_empty() {
        let _ = writeln!(text, "\n  of the set-up, otherwise than stated:");
        for line in lines {
            let _ = writeln!(text, "    {line}");
        }
    }
    for effect in &diagnosis.effects {
        let _ = writeln!(text, "\n  {}  (probability {:.2})\n  {}", effect.id, effect.probability, effect.equation);
        for (key, q) in effect.told() {
            let _ = writeln!(text, "    {key} = {}", value(&q));
        }
    }
    if let Some(term) = &diagnosis.term {
        let _ = writeln!(text, "\n  {}\n    removes {:.0} % of the misfit", term.words, 100.0 * term.share);
    }
    text.push_str(&findings(&diagnosis.findings));
    for tie in ties::ties(diagnosis) {
        let _ = writeln!(text, "\n  not told apart by these runs: {tie}");
    }
    if let Some(instead) = set_up::instead(diagnosis) {
        let _ = writeln!(text, "\n  {instead}");
    }
    if let Some(gains) = diagnosis.change.as_ref().and_then(|change| change.gains.as_ref()) {
        let _ = writeln!(text, "\n  {}", change::stand(gains));
    }
    if let Some(test) = &diagnosis.next_test {
        let _ = writeln!(text, "\n  next test: {}\n    {}", test.record, test.why);
    }
    if let Some(why) = &diagnosis.no_test {
        let _ = writeln!(text, "\n  {why}");
    }
    if diagnosis.verdict != Verdict::BadData {
        let (before, after) = (&diagnosis.judged.before, &diagnosis.judged.after);
        let runs = examined.judging_runs().len();
        let _ = writeln!(
            text,
            "\nheld out ({runs} runs): chi2 {} -> {}; the noise floor is 1",
            digits::three(before.chi2),
            digits::three(after.chi2)
        );
        for (channel, r2) in &after.r2 {
            let _ = writeln!(
                text,
                "  {channel:<20} R2 {} -> {}",
                digits::r2(before.r2.get(channel).copied().unwrap_or(f64::NAN)),
                digits::r2(*r2)
            );
        }
    }
    let _ = writeln!(text, "{:.1} s", diagnosis.seconds);
    text
}
