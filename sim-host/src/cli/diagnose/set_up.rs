//! What of the stated set-up a diagnosis found otherwise, as a table.

use super::super::traces;
use crate::diagnose::Diagnosis;
use crate::digits;
use crate::report::{Item, Section};

/// What of the stated set-up was found otherwise.
pub(super) fn section(diagnosis: &Diagnosis) -> Option<Section> {
    let rows = diagnosis.set_up.iter().map(|found| {
        let size = found.std.unwrap_or(1e-3 * found.found.abs());
        let at = |text: Option<&str>| text.unwrap_or("all").to_owned();
        vec![
            found
                .parameter
                .as_ref()
                .map_or_else(|| found.what.name().to_owned(), |p| format!("{}, {p}", found.what.name())),
            at(found.run.as_deref()),
            at(found.channel),
            found.stated.map_or_else(|| "\u{2013}".into(), digits::stated),
            digits::to(found.found, size),
            found.std.map_or_else(|| "\u{2013}".into(), |std| digits::to(std, std)),
            if found.unit == "1" { String::new() } else { found.unit.clone() },
            if found.corrected { "yes" } else { "no" }.into(),
        ]
    });
    let rows: Vec<Vec<String>> = rows.collect();
    (!rows.is_empty()).then(|| {
        let columns = ["what", "run", "channel", "stated", "found", "std", "unit", "corrected"];
        let text = "These are faults of what was stated, seen in the recordings without a model of the table; the diagnosis went on with \
                    what was found where it says so.";
        let table = traces::table(&columns, rows, "Stated and found");
        Section { heading: "The set-up".into(), items: vec![Item::Text(text.into()), Item::Table(table)] }
    })
}
