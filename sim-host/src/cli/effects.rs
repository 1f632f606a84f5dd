//! `shakedown effects`: the library of physics a model may be missing.

use super::Failure;
use super::output::{Outputs, print, print_table};
use serde_json::json;
use shakedown::plant::effects::{ENTRIES, Entry, Role, entry, identifiers};
use shakedown::plant::model::Kind;
use shakedown::recording::error::suggestion;
use shakedown::report::{Item, Page, Section, Table};
use std::fmt::Write as _;

/// The library of effects: equation, parameters, signature, what it is mistaken for, the test that tells.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown effects                        the whole library
  shakedown effects coulomb_friction       one effect in full
  shakedown effects --report effects.html  the same as a page
  shakedown effects --markdown             the table of the documentation")]
pub(crate) struct Args {
    /// One effect's identifier.
    id: Option<String>,
    /// Prints the library as the documentation's table.
    #[arg(long)]
    markdown: bool,
    #[command(flatten)]
    outputs: Outputs,
}

/// Prints the library or one of its entries.
pub(crate) fn run(args: &Args) -> Result<(), Failure> {
    let chosen: Vec<&Entry> = match &args.id {
        None => ENTRIES.to_vec(),
        Some(id) => vec![entry(id).ok_or_else(|| {
            let meant =
                suggestion(id, identifiers()).map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            Failure::Input(format!(
                "no effect is called `{id}`{meant}; the library holds: {}",
                identifiers().join(", ")
            ))
        })?],
    };
    args.outputs.write_report(&mut page(&chosen), &[])?;
    args.outputs.write_json(json!({ "effects": chosen.iter().map(|e| as_json(e)).collect::<Vec<_>>() }), &[])?;
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

fn as_json(entry: &Entry) -> serde_json::Value {
    let parameters: Vec<_> = shared(entry)
        .map(|p| json!({ "key": p.key, "unit": p.unit, "unit_rigid_mass": p.rigid_unit, "meaning": p.meaning }))
        .collect();
    json!({
        "id": entry.id, "stage": entry.stage.name(), "equation": entry.equation, "parameters": parameters,
        "signature": entry.signature, "mistaken_for": entry.mistaken_for, "test": entry.test,
    })
}

fn shared(entry: &Entry) -> impl Iterator<Item = &'static shakedown::plant::effects::Parameter> {
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
    let mut sections = vec![Section { heading: "At a glance".into(), items: vec![Item::Table(table(entries))] }];
    sections.extend(entries.iter().map(|entry| {
        let facts = facts(entry).map(|(name, value)| vec![name.to_owned(), value]).into();
        let parameters = shared(entry).map(|p| [p.key, p.meaning, p.unit, p.rigid_unit].map(String::from).into());
        let columns = ["parameter", "what it is", "unit", "unit, rigid mass"].map(String::from).into();
        let parameters = Table { columns, rows: parameters.collect(), caption: String::new() };
        let facts = Table { columns: vec![String::new(), entry.id.into()], rows: facts, caption: String::new() };
        Section { heading: entry.id.into(), items: vec![Item::Table(facts), Item::Table(parameters)] }
    }));
    let lead = "Physics that a model may be missing: equation, parameters, what it looks like, what tells it apart.";
    Page { title: "Effects".into(), lead: lead.into(), sections, ..Page::default() }
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
