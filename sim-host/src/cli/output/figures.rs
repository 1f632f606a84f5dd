//! A page's figures in a folder: each as SVG, and the arrays that they draw as JSON.

use super::{Failure, write_whole};
use crate::report::{Page, Plot};
use serde_json::{Value, json};
use std::path::Path;

/// What the arrays are in.
const DATA: &str = "figures.json";

/// Writes all of them.
pub(super) fn write(page: &Page, folder: &Path) -> Result<(), Failure> {
    let plots: Vec<&Plot> = page.plots().collect();
    let mut listed = Vec::new();
    for (number, plot) in plots.iter().enumerate() {
        let name = format!("{:02}-{}.svg", number + 1, slug(&plot.title));
        let drawn = plot.svg();
        if let Some(svg) = &drawn {
            write_whole(&folder.join(&name), svg.as_bytes())?;
        }
        listed.push(data(plot, drawn.map(|_| name)));
    }
    let value = json!({ "schema": "shakedown.figures/1", "version": env!("CARGO_PKG_VERSION"), "figures": listed });
    let text = serde_json::to_string(&value).map_err(|e| Failure::Work(e.to_string()))? + "\n";
    write_whole(&folder.join(DATA), text.as_bytes())
}

/// What a figure draws; a value that is no number is null.
fn data(plot: &Plot, file: Option<String>) -> Value {
    let series: Vec<Value> =
        plot.series.iter().map(|series| json!({ "name": series.name, "x": series.x, "y": series.y })).collect();
    let bands: Vec<Value> =
        plot.bands.iter().map(|band| json!({ "from": band.from, "to": band.to, "label": band.label })).collect();
    json!({ "title": plot.title, "x": plot.x.label, "y": plot.y.label, "file": file, "series": series, "bands": bands })
}

/// A title as a file's name: `Displacement, all of it` is `displacement-all-of-it`.
fn slug(title: &str) -> String {
    let plain: String = title.to_lowercase().chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let parts: Vec<&str> = plain.split('-').filter(|part| !part.is_empty()).take(6).collect();
    if parts.is_empty() { "figure".into() } else { parts.join("-") }
}
