//! What a device said, as a page.

use crate::recording::file;
use crate::report::{Axis, Item, Page, Plot, Section, Series, Style, Table};
use std::path::Path;

/// Longest recording that is drawn, bytes: a quarter of an hour at 1 kHz.
const DRAWN: u64 = 64 << 20;

/// A page of facts.
pub(super) fn facts(title: &str, lead: &str, facts: &[(&str, String)]) -> Page {
    let rows = facts.iter().map(|(name, value)| vec![(*name).into(), value.clone()]).collect();
    let table = Table { columns: vec![String::new(), "device".into()], rows, caption: String::new() };
    let sections = vec![Section { heading: "What it says".into(), items: vec![Item::Table(table)] }];
    Page { title: title.into(), lead: lead.into(), sections, ..Page::default() }
}

/// The figures of a recording; a note where there are none.
pub(super) fn figures(recording: Option<&Path>) -> Section {
    let items = match recording.map(drawn) {
        None => vec![Item::Note("No telemetry came: is `telemetry_every` 0 in the setup?".into())],
        Some(Err(why)) => vec![Item::Note(why)],
        Some(Ok(items)) => items,
    };
    Section { heading: "What it recorded".into(), items }
}

fn drawn(path: &Path) -> Result<Vec<Item>, String> {
    let length = std::fs::metadata(path).map_or(0, |file| file.len());
    if length > DRAWN {
        return Err(format!(
            "{}: {length} bytes are more than a page should draw; `shakedown diagnose` reads it",
            path.display()
        ));
    }
    let names = ["time", "reference", "modified_reference", "displacement", "acceleration", "command", "external"];
    let table = file::read(path, &names).map_err(|e| e.to_string())?;
    let [time, reference, fitted, displacement, acceleration, command, external] = table.columns.as_slice() else {
        return Err(format!("{}: lacks a column", path.display()));
    };
    let of = |name: &str, y: &[f64], scale: f64, style| Series {
        name: name.into(),
        x: time.clone(),
        y: y.iter().map(|y| scale * y).collect(),
        style,
    };
    let plot = |title: &str, label: &str, series| {
        Item::Plot(Plot {
            title: title.into(),
            x: Axis { label: "time [s]".into(), ..Axis::default() },
            y: Axis { label: label.into(), ..Axis::default() },
            series,
            group: Some("run".into()),
            ..Plot::default()
        })
    };
    Ok(vec![
        plot(
            "Displacement",
            "displacement [mm]",
            vec![
                of("reference", reference, 1e3, Style::Faint),
                of("reference, modified", fitted, 1e3, Style::Dashed),
                of("measured", displacement, 1e3, Style::Line),
            ],
        ),
        plot("Acceleration", "acceleration [m/s2]", vec![of("measured", acceleration, 1.0, Style::Line)]),
        plot(
            "Command",
            "command [mm]",
            vec![of("existing controller's", external, 1e3, Style::Faint), of("valve's", command, 1e3, Style::Line)],
        ),
    ])
}
