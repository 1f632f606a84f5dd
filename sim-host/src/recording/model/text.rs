//! A model's values as the lines of a TOML file.

use super::Accuracy;
use std::fmt::Write as _;

pub(super) fn line(text: &mut String, key: &str, value: f64, accuracy: Option<&Accuracy>) {
    let _ = match accuracy {
        None => writeln!(text, "{key} = {value:?}"),
        Some(a) => {
            let known = [("std", a.std), ("low", a.low), ("high", a.high)];
            let more = known.iter().filter_map(|(k, v)| v.map(|v| format!(", {k} = {v:?}")));
            writeln!(text, "{key} = {{ value = {value:?}{} }}", more.collect::<String>())
        }
    };
}

pub(super) fn list<'a>(text: &mut String, key: &str, items: impl Iterator<Item = &'a str>) {
    let quoted: Vec<String> = items.map(|i| format!("{i:?}")).collect();
    if !quoted.is_empty() {
        let _ = writeln!(text, "{key} = [{}]", quoted.join(", "));
    }
}
