//! Two results of `--json` side by side: every number that both or either holds, by its place.

use super::super::output::{print, print_table};
use super::Args;
use crate::cli::Failure;
use crate::files::bounded;
use crate::report::{Item, Page, Section, Table};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Longest list whose elements are compared one by one; longer ones are curves.
const LIST: usize = 200;
/// Rows at most.
const ROWS: usize = 2000;
/// Largest result, bytes.
const LARGEST: u64 = 64 << 20;
/// Keys that say when and by whom a result was made.
const ORIGIN: [&str; 3] = ["version", "inputs", "seconds"];
/// Keys that name an element of a list.
const NAMES: [&str; 8] = ["name", "record", "id", "file", "run", "channel", "frequency_hz", "from_hz"];

/// A number or a word of a result.
#[derive(Debug, Clone, PartialEq)]
enum Leaf {
    Number(f64),
    Word(String),
}

/// Reads both, pairs what they hold and shows it.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let paths = [&args.first, &args.second];
    let (a, b) = (read(paths[0])?, read(paths[1])?);
    if let (Some(x), Some(y)) = (a.get("schema"), b.get("schema"))
        && x != y
    {
        return Err(Failure::Input(format!(
            "{} holds {x} and {} {y}: compare results of one command",
            paths[0].display(),
            paths[1].display()
        )));
    }
    let rows = paired(&a, &b);
    if !rows.iter().any(|(_, x, y)| x.is_some() && y.is_some()) {
        return Err(Failure::Input(format!(
            "{} and {} share no value: compare results of one command",
            paths[0].display(),
            paths[1].display()
        )));
    }
    let differ = rows.iter().filter(|(_, x, y)| x != y).count();
    let inputs: Vec<_> = paths.iter().map(|p| (*p).clone()).collect();
    args.outputs
        .write_json(json!({ "values": rows.iter().map(as_json).collect::<Vec<_>>(), "differ": differ }), &inputs)?;
    let lead = match differ {
        0 => format!("All {} values are the same.", rows.len()),
        n => format!("{n} of {} values differ.", rows.len()),
    };
    let shown: Vec<_> = rows.iter().filter(|(_, x, y)| x != y).take(ROWS).collect();
    let changed = table(&shown, "What differs");
    if !args.outputs.quiet() {
        if differ > 0 {
            print_table(&changed);
        }
        print(&format!("\n{lead}\n"));
    }
    let all: Vec<_> = rows.iter().take(ROWS).collect();
    let mut sections = Vec::new();
    if differ > 0 {
        sections.push(Section { heading: "What differs".into(), items: vec![Item::Table(changed)] });
    }
    let whole = table(&all, &format!("Every value, the first {ROWS} at most"));
    let details = vec![Section { heading: "All values".into(), items: vec![Item::Table(whole)] }];
    let title = format!("{} and {}", paths[0].display(), paths[1].display());
    args.outputs.write_report(&mut Page { title, lead, sections, details, ..Page::default() }, &inputs)
}

fn read(path: &Path) -> Result<Value, Failure> {
    let text = bounded::text(path, LARGEST).map_err(|e| Failure::Input(format!("{}: {e}", path.display())))?;
    let value: Value = serde_json::from_str(&text).map_err(|e| {
        Failure::Input(format!("{}: is no JSON: {e}; name what a command wrote with --json", path.display()))
    })?;
    if value.is_object() {
        Ok(value)
    } else {
        Err(Failure::Input(format!("{}: holds no result: expected an object as --json writes it", path.display())))
    }
}

type Row = (String, Option<Leaf>, Option<Leaf>);

/// Every place that either holds, in the order of the first.
fn paired(a: &Value, b: &Value) -> Vec<Row> {
    let (mut first, mut second) = (Vec::new(), Vec::new());
    flatten("", a, &mut first);
    flatten("", b, &mut second);
    let of: BTreeMap<&str, &Leaf> = second.iter().map(|(k, v)| (k.as_str(), v)).collect();
    let known: std::collections::BTreeSet<&str> = first.iter().map(|(k, _)| k.as_str()).collect();
    let mut rows: Vec<Row> =
        first.iter().map(|(k, v)| (k.clone(), Some(v.clone()), of.get(k.as_str()).map(|v| (*v).clone()))).collect();
    rows.extend(
        second.iter().filter(|(k, _)| !known.contains(k.as_str())).map(|(k, v)| (k.clone(), None, Some(v.clone()))),
    );
    rows
}

fn flatten(place: &str, value: &Value, out: &mut Vec<(String, Leaf)>) {
    let below = |key: &str| if place.is_empty() { key.to_owned() } else { format!("{place}.{key}") };
    match value {
        Value::Null => {}
        Value::Bool(b) => out.push((place.to_owned(), Leaf::Word(b.to_string()))),
        Value::String(s) => out.push((place.to_owned(), Leaf::Word(s.clone()))),
        Value::Number(n) => out.push((place.to_owned(), Leaf::Number(n.as_f64().unwrap_or(f64::NAN)))),
        Value::Object(map) => {
            let told = map.iter().filter(|(key, _)| !(place.is_empty() && ORIGIN.contains(&key.as_str())));
            told.for_each(|(key, value)| flatten(&below(key), value, out));
        }
        Value::Array(list) if list.len() > LIST => {
            out.push((below("length"), Leaf::Number(list.len() as f64)));
        }
        Value::Array(list) => {
            for (i, element) in list.iter().enumerate() {
                flatten(&format!("{place}[{}]", label(list, i)), element, out);
            }
        }
    }
}

/// What an element of a list is called: what names it, where that is its own; else its number.
fn label(list: &[Value], i: usize) -> String {
    let text = |v: &Value| match v {
        Value::String(s) => Some(s.clone()),
        Value::Number(n) => Some(n.to_string()),
        _ => None,
    };
    let name = |element: &Value| {
        let parts = NAMES.iter().chain(&["controller"]).filter_map(|key| element.get(key).and_then(text));
        let parts: Vec<String> = parts.collect();
        (!parts.is_empty()).then(|| parts.join(", "))
    };
    let own = name(&list[i]);
    match own {
        Some(own) if list.iter().filter(|other| name(other).as_ref() == Some(&own)).count() == 1 => own,
        _ => i.to_string(),
    }
}

fn as_json((place, a, b): &Row) -> Value {
    let of = |leaf: &Option<Leaf>| match leaf {
        None => Value::Null,
        Some(Leaf::Number(x)) => json!(x),
        Some(Leaf::Word(w)) => json!(w),
    };
    json!({ "value": place, "a": of(a), "b": of(b) })
}

fn table(rows: &[&Row], caption: &str) -> Table {
    let number = |x: f64| if x == x.trunc() && x.abs() < 1e9 { format!("{x}") } else { format!("{x:.5}") };
    let of = |leaf: &Option<Leaf>| match leaf {
        None => "\u{2013}".to_owned(),
        Some(Leaf::Number(x)) if *x != 0.0 && x.abs() < 1e-3 => format!("{x:.3e}"),
        Some(Leaf::Number(x)) => number(*x),
        Some(Leaf::Word(w)) => w.chars().take(60).collect(),
    };
    let change = |a: &Option<Leaf>, b: &Option<Leaf>| match (a, b) {
        (Some(Leaf::Number(a)), Some(Leaf::Number(b))) if a != b && *a != 0.0 => {
            format!("{:+.1} %", 100.0 * (b - a) / a.abs())
        }
        _ => String::new(),
    };
    Table {
        caption: caption.into(),
        columns: ["value", "A", "B", "change"].map(String::from).into(),
        rows: rows.iter().map(|(place, a, b)| vec![place.clone(), of(a), of(b), change(a, b)]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_pair_by_name_and_a_missing_one_shows() {
        let a = json!({ "rows": [{ "record": "Kobe", "e_a": 0.3 }, { "record": "Taft", "e_a": 0.1 }], "version": "1" });
        let b = json!({ "rows": [{ "record": "Taft", "e_a": 0.1 }, { "record": "Kobe", "e_a": 0.2 }], "more": 1 });
        let rows = paired(&a, &b);
        let differ: Vec<&str> = rows.iter().filter(|(_, a, b)| a != b).map(|(k, _, _)| k.as_str()).collect();
        assert_eq!(differ, ["rows[Kobe].e_a", "more"]);
    }
}
