//! `shakedown init`: a commented experiment from a user's own files.

use super::Failure;
use super::output::{Outputs, print, write_whole};
use super::source::Text;
use crate::recording::Channel;
use crate::recording::inner_loop::{Closure, InnerLoop};
use crate::recording::propose::{Proposal, propose_as};
use crate::recording::{Experiment, Severity, check};
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use serde_json::json;
use std::ffi::OsString;
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
    /// The folder with the recordings: text with a header line (CSV, MTS 793, LabVIEW .lvm), MATLAB, HDF5, TDMS or RPC III.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Name of the experiment's file in that folder; `-` prints it.
    #[arg(long, value_name = "FILE", default_value = "experiment.toml")]
    out: OsString,
    /// Replaces a file of that name.
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    text: Text,
    #[command(flatten)]
    outputs: Outputs,
}

/// The model of a table that nobody has described yet.
const MODEL: &str = "[model]                      # the paper's table (Eq. 7), NOT yours: `identify --out` and `diagnose --model` write yours\n\
    kind = \"servo\"\nb1 = 0.69                    # 1/s per m of command\nb0 = 138.0                   # 1/s2 per m of command\n\
    a1 = 57.65                   # 1/s\nvelocity_limit = 0.242       # m/s";

/// Looks at the files, writes the experiment beside them and says what is still open.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let to_terminal = args.out == "-";
    let path = args.folder.join(&args.out);
    if Path::new(&args.out).components().count() > 1 {
        let (out, folder) = (Path::new(&args.out).display(), args.folder.display());
        let message =
            format!("--out {out}: names a file in {folder}, beside the recordings; give a name without a folder");
        return Err(Failure::Input(message));
    }
    if !to_terminal && path.exists() && !args.force {
        let message =
            format!("{}: is there already; name another with --out, or replace it with --force", path.display());
        return Err(Failure::Input(message));
    }
    let proposal = propose_as(&args.folder, &args.text.stated()).map_err(|e| Failure::Input(e.to_string()))?;
    if !to_terminal {
        write_whole(&path, proposal.text.as_bytes())?;
    }
    let table = args.folder.join("table.toml");
    let described = !to_terminal && !table.exists();
    if described {
        write_whole(&table, crate::recording::described::template(MODEL).as_bytes())?;
    }
    let inputs: Vec<PathBuf> = proposal.files.iter().map(|name| args.folder.join(name)).collect();
    args.outputs.write_json(as_json(&proposal, (!to_terminal).then_some(&path)), &inputs)?;
    args.outputs.write_report(&mut page(&proposal), &inputs)?;
    if args.outputs.quiet() {
    } else if to_terminal {
        print(&proposal.text);
    } else {
        print(&summary(&proposal, &path));
        if described {
            print(&format!("Wrote {}: describe the table there once, and no limit is typed twice.\n", table.display()));
        }
    }
    Ok(())
}

fn as_json(proposal: &Proposal, experiment: Option<&PathBuf>) -> serde_json::Value {
    let channels = proposal.choices.iter().map(|choice| {
        json!({ "channel": choice.channel.name(), "unit": choice.unit.map(|u| u.symbol), "evidence": choice.evidence,
                "to_confirm": choice.doubtful })
    });
    let left_out = proposal.left_out.iter().map(|(file, reason)| json!({ "file": file, "reason": reason }));
    json!({
        "experiment": experiment, "files": proposal.files, "left_out": left_out.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(), "notes": proposal.notes, "to_settle": proposal.open,
        "inner_loop": proposal.inner.as_ref().map(inner_loop),
        "controller": proposal.control.as_ref().map(|law| json!({ "law": law.text, "misses": law.error })),
    })
}

/// The inner loop, for other tools.
fn inner_loop(found: &InnerLoop) -> serde_json::Value {
    let gains = found.gains.iter().map(|g| {
        (
            g.term.name().to_owned(),
            json!({ "value": g.value, "std": g.std, "share": g.share, "determined": g.determined() }),
        )
    });
    json!({
        "closed_by": if found.closure == Closure::Command { "command" } else { "hardware" },
        "gains": gains.collect::<serde_json::Map<_, _>>(), "delay_s": found.delay, "lag_s": found.lag,
        "scale": found.scale, "misses": found.misses, "from_hz": found.band.0, "to_hz": found.band.1,
    })
}

fn page(proposal: &Proposal) -> Page {
    let table = |columns: &[&str], rows, caption: &str| {
        Item::Table(Table { columns: columns.iter().map(|c| (*c).into()).collect(), rows, caption: caption.into() })
    };
    let channels = proposal.choices.iter().map(|choice| {
        let unit = choice.unit.map_or("unknown", |u| u.symbol);
        let confirm = if choice.doubtful { "to confirm" } else { "" };
        vec![choice.channel.name().into(), unit.into(), choice.evidence.join("; "), confirm.into()]
    });
    let files = proposal.files.iter().map(|file| vec![file.clone(), "a run".into()]);
    let left_out = proposal.left_out.iter().map(|(file, reason)| vec![file.clone(), format!("left out: {reason}")]);
    let doubtful = proposal.choices.iter().filter(|choice| choice.doubtful).count();
    let items = vec![
        table(&["channel", "unit", "what speaks for it", ""], channels.collect(), "Channels"),
        table(&["file", ""], files.chain(left_out).collect(), "Files"),
    ];
    let sections = vec![
        Section { heading: "What is proposed".into(), items },
        Section { heading: figures_of(proposal), items: figures(proposal) },
    ];
    let lead =
        format!("An experiment from {} recordings: each proposal with what speaks for it.", proposal.files.len());
    let key = vec![
        ("recordings".to_owned(), proposal.files.len().to_string()),
        ("channels proposed".into(), proposal.choices.len().to_string()),
        ("of them to confirm".into(), doubtful.to_string()),
    ];
    let advice = proposal.open.iter().map(|open| format!("To settle: {open}.")).collect();
    Page { title: "A first experiment".into(), lead, key, advice, sections, ..Page::default() }
}

fn figures_of(proposal: &Proposal) -> String {
    proposal.files.first().map_or_else(|| "The channels".into(), |file| format!("The channels of {file}"))
}

/// Every channel over time, so that a wrong column is seen at once.
fn figures(proposal: &Proposal) -> Vec<Item> {
    let time = proposal.choices.iter().find(|choice| choice.channel == Channel::Time);
    let step = time.and_then(|choice| Some(proposal.facts.get(choice.column)?.step? * choice.unit?.factor));
    let channels = proposal.choices.iter().filter(|choice| choice.channel != Channel::Time);
    let plot = |choice: &crate::recording::propose::Choice| {
        let samples = proposal.facts.get(choice.column)?.samples.clone();
        let unit = choice.unit.map_or("unit unknown", |unit| unit.symbol);
        let unit = if unit == "1" { "no unit" } else { unit };
        let x = if step.is_some() { "time [s]" } else { "sample" };
        Some(Item::Plot(Plot {
            title: choice.channel.name().into(),
            x: Axis { label: x.into(), log: false },
            y: Axis { label: format!("{} [{unit}]", choice.channel.name()), log: false },
            series: vec![Series {
                name: proposal.facts[choice.column].heading.text.clone(),
                x: (0..samples.len()).map(|k| k as f64 * step.unwrap_or(1.0)).collect(),
                y: samples,
                style: Style::Line,
            }],
            group: Some("time".into()),
            ..Plot::default()
        }))
    };
    channels.filter_map(plot).collect()
}

fn summary(proposal: &Proposal, path: &Path) -> String {
    let mut text = format!("Wrote {} from {} recordings.\n", path.display(), proposal.files.len());
    for choice in &proposal.choices {
        let unit = choice.unit.map_or("unit unknown", |u| u.symbol);
        let mark = if choice.doubtful { "  CONFIRM" } else { "" };
        let _ = writeln!(text, "  {:<22} [{unit}]  {}{mark}", choice.channel.name(), choice.evidence.join("; "));
    }
    let unused: Vec<&str> = proposal.unused().map(|fact| fact.heading.text.as_str()).collect();
    if !unused.is_empty() {
        let _ = writeln!(text, "Columns that are not used: {}", unused.join(", "));
    }
    for note in &proposal.notes {
        let _ = writeln!(text, "Found: {note}");
    }
    if let Some(inner) = &proposal.inner {
        let _ = writeln!(text, "Inner loop: {}", inner.describe());
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
