//! `shakedown effects`: the library of physics a model may be missing.

use super::Failure;
use super::failure::refused;
use super::output::{Outputs, print, print_table};
use crate::plant::effects::{ENTRIES, Entry, Role};
use crate::plant::model::Kind;
use crate::recording::error::suggestion;
use crate::recording::own_effect;
use crate::report::{Item, Page, Section, Table};
use serde_json::json;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The library of effects: equation, parameters, signature, similar effects, the test that separates them.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown effects                        the whole library
  shakedown effects coulomb_friction       one effect in full
  shakedown effects --report effects.html  the same as a page
  shakedown effects --markdown             the table of the documentation
  shakedown effects --file own.toml        the library and a user's own effects
  shakedown effects --check own.toml       what is wrong with effects of one's own, by line")]
pub(crate) struct Args {
    /// One effect's identifier.
    id: Option<String>,
    /// Prints the library as the documentation's table.
    #[arg(long)]
    markdown: bool,
    /// Lists the `[[effect]]`s of this file beside the library.
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Checks the `[[effect]]`s of this file and says by line what is wrong.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["id", "markdown", "file"])]
    check: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

/// Prints the library or one of its entries.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let own = match args.check.as_ref().or(args.file.as_ref()) {
        Some(path) => own(path)?,
        None => Vec::new(),
    };
    let known: Vec<&Entry> = ENTRIES.iter().chain(&own).copied().collect();
    let chosen: Vec<&Entry> = match &args.id {
        None if args.check.is_some() => own,
        None => known,
        Some(id) => vec![known.iter().copied().find(|entry| entry.id == id).ok_or_else(|| unknown(id, &known))?],
    };
    let inputs: Vec<PathBuf> = args.check.iter().chain(&args.file).cloned().collect();
    args.outputs.write_report(&mut page(&chosen), &inputs)?;
    args.outputs.write_json(json!({ "effects": chosen.iter().map(|e| as_json(e)).collect::<Vec<_>>() }), &inputs)?;
    if args.outputs.quiet() {
    } else if args.markdown {
        print(&markdown(&chosen));
    } else if let (Some(_), [one]) = (&args.id, chosen.as_slice()) {
        print(&in_full(one));
    } else {
        print_table(&table(&chosen));
    }
    Ok(())
}

/// The effects of a file; all that is wrong with them in one message, a line each.
fn own(path: &Path) -> Result<Vec<&'static Entry>, Failure> {
    let (entries, errors) = own_effect::load(path).map_err(|e| refused(path, e, "effects of one's own are TOML"))?;
    if errors.is_empty() {
        return Ok(entries);
    }
    let count = errors.len() + entries.len();
    let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
    Err(Failure::Input(format!("{} of {count} effects refused\n{}", errors.len(), lines.join("\n"))))
}

fn unknown(id: &str, known: &[&Entry]) -> Failure {
    let known: Vec<&str> = known.iter().map(|entry| entry.id).collect();
    let near = suggestion(id, known.iter().copied());
    let meant = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
    Failure::Input(format!("no effect is called `{id}`{meant}; the library holds: {}", known.join(", ")))
}

fn as_json(entry: &Entry) -> serde_json::Value {
    let parameters: Vec<_> = shared(entry)
        .map(|p| json!({ "key": p.key, "unit": p.unit, "unit_rigid_mass": p.rigid_unit, "meaning": p.meaning }))
        .collect();
    json!({
        "id": entry.id, "stage": entry.stage.name(), "equation": entry.equation, "parameters": parameters,
        "signature": entry.signature, "mistaken_for": entry.mistaken_for, "test": entry.test,
    })
}

fn shared(entry: &Entry) -> impl Iterator<Item = &'static crate::plant::effects::Parameter> {
    entry.parameters.iter().filter(|p| p.role != Role::PerRun)
}

fn keys(entry: &Entry) -> String {
    shared(entry).map(|p| format!("{} [{}]", p.key, p.unit)).collect::<Vec<_>>().join(", ")
}

fn table(entries: &[&Entry]) -> Table {
    let rows = entries.iter().map(|e| vec![e.id.into(), e.stage.name().into(), e.equation.into(), keys(e)]);
    Table {
        columns: ["effect", "stage", "equation", "parameters [unit]"].map(String::from).into(),
        rows: rows.collect(),
        caption: "Physics a model may be missing; `shakedown effects ID` tells more".into(),
    }
}

fn markdown(entries: &[&Entry]) -> String {
    let mut text =
        String::from("| effect | stage | equation | parameters | looks like | mistaken for | told apart by |\n");
    text += "|---|---|---|---|---|---|---|\n";
    for e in entries {
        let cell = |s: &str| s.replace('|', "\\|");
        let _ = writeln!(
            text,
            "| `{}` | {} | `{}` | {} | {} | {} | {} |",
            e.id,
            e.stage.name(),
            cell(e.equation),
            cell(&keys(e)),
            e.signature,
            e.mistaken_for.join(", "),
            e.test
        );
    }
    text
}

/// The library as a page: all of it at a glance, then each effect.
fn page(entries: &[&Entry]) -> Page {
    let glance = Section { heading: "At a glance".into(), items: vec![Item::Table(table(entries))] };
    let each: Vec<Section> = entries
        .iter()
        .map(|entry| {
            let facts = facts(entry).map(|(name, value)| vec![name.to_owned(), value]).into();
            let parameters = shared(entry).map(|p| [p.key, p.meaning, p.unit, p.rigid_unit].map(String::from).into());
            let columns = ["parameter", "what it is", "unit", "unit, rigid mass"].map(String::from).into();
            let parameters = Table { columns, rows: parameters.collect(), caption: String::new() };
            let facts = Table { columns: vec![String::new(), entry.id.into()], rows: facts, caption: String::new() };
            Section { heading: entry.id.into(), items: vec![Item::Table(facts), Item::Table(parameters)] }
        })
        .collect();
    // One effect is what was asked for; of many, each is there to be unfolded.
    let (sections, details) = if entries.len() == 1 { (each, Vec::new()) } else { (vec![glance], each) };
    let (title, lead, key) = if let [one] = entries {
        let others = if one.mistaken_for.is_empty() {
            String::new()
        } else {
            format!(" Mistaken for {}; told apart by: {}.", one.mistaken_for.join(", "), one.test)
        };
        let lead = format!("It looks like {}.{others}", one.signature);
        (one.id.to_owned(), lead, ("equation", one.equation.to_owned()))
    } else {
        let lead =
            "Physics that a model may be missing: equation, parameters, what it looks like, what tells it apart.";
        ("Effects".to_owned(), lead.to_owned(), ("effects in the library", entries.len().to_string()))
    };
    Page { title, lead, key: vec![(key.0.into(), key.1)], sections, details, ..Page::default() }
}

/// What is known of an effect beside its parameters.
fn facts(entry: &Entry) -> [(&'static str, String); 6] {
    let kinds = entry.kinds.iter().map(|kind| match kind {
        Kind::Servo => "servo",
        Kind::RigidMass => "rigid-mass",
        Kind::ForceBalance => "force-balance",
    });
    [
        ("stage", entry.stage.name().into()),
        ("equation", entry.equation.into()),
        ("models", kinds.collect::<Vec<_>>().join(", ")),
        ("looks like", entry.signature.into()),
        ("mistaken for", entry.mistaken_for.join(", ")),
        ("told apart by", entry.test.into()),
    ]
}

fn in_full(entry: &Entry) -> String {
    let mut text = format!("{}, at the {}\n\n  {}\n\n", entry.id, entry.stage.name(), entry.equation);
    for p in shared(entry) {
        let _ = writeln!(text, "  {:<24} {} [{}]", p.key, p.meaning, p.unit);
    }
    text.push('\n');
    for (name, value) in &facts(entry)[2..] {
        let _ = writeln!(text, "{name:<14} {value}");
    }
    text
}
