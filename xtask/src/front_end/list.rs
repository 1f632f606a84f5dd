//! What is bought: the items, and the list of parts.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::Deserialize;

use super::sheet::{Kind, Sheet};
use crate::shell::Problem;

/// An item, of which a part is one.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Item {
    /// What any part must be.
    specification: String,
    /// One that is; empty where none is named.
    example: String,
}

/// All items, by name.
pub(super) fn items(folder: &Path) -> Result<BTreeMap<String, Item>, Problem> {
    let path = folder.join("items.toml");
    let fail = |e: String| Problem::Failed(format!("{}: {e}", path.display()));
    let text = std::fs::read_to_string(&path).map_err(|e| fail(e.to_string()))?;
    toml::from_str(&text).map_err(|e| fail(e.to_string()))
}

/// The list of parts: one line an item and value, with every place it goes to, sheet by sheet.
pub(super) fn csv(sheets: &[Sheet], items: &BTreeMap<String, Item>) -> String {
    let mut lines: BTreeMap<(&str, String), Vec<String>> = BTreeMap::new();
    for sheet in sheets {
        for part in sheet.parts.iter().filter(|part| !part.item.is_empty()) {
            let value = if part.kind == Kind::Coil { String::new() } else { engineering(part.value) };
            lines.entry((&part.item, value)).or_default().push(format!("{}:{}", sheet.name, part.name));
        }
    }
    let mut text = String::from("item,value,count a set of sheets,places,specification,example\n");
    for ((item, value), places) in lines {
        let (specification, example) = items.get(item).map_or(("", ""), |i| (&i.specification, &i.example));
        let places_in = places.join(" ");
        let _ = writeln!(text, "{item},{value},{},{places_in},\"{specification}\",\"{example}\"", places.len());
    }
    text
}

/// A value with its prefix: `16.5k`, `100n`; empty for none.
pub(super) fn engineering(value: f64) -> String {
    let prefixes = [(1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "u"), (1e-9, "n"), (1e-12, "p")];
    let found = prefixes.iter().find(|(scale, _)| value >= *scale * 0.9999);
    found.map_or_else(String::new, |(scale, prefix)| {
        let number = format!("{:.3}", value / scale);
        format!("{}{prefix}", number.trim_end_matches('0').trim_end_matches('.'))
    })
}
