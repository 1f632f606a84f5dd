//! The table described once: `--table`, or the `table.toml` of the folder that the command is started in.

use super::Failure;
use super::output::tell;
use crate::recording::Described;
use std::path::{Path, PathBuf};

/// What a folder's own description is called.
const NAME: &str = "table.toml";

/// A table's file and what it states beside the model.
#[derive(Debug, Clone, Default)]
pub(crate) struct Found {
    /// The file; none where nothing describes a table.
    pub(crate) path: Option<PathBuf>,
    /// What `[table]` states.
    pub(crate) table: Described,
}

/// The table of `--table`, else that of this folder where its `[table]` states something, which is said.
pub(crate) fn found(option: Option<&Path>) -> Result<Found, Failure> {
    let load = |path: &Path| Described::load(path).map_err(|e| Failure::Input(e.to_string()));
    if let Some(path) = option {
        return Ok(Found { path: Some(path.to_path_buf()), table: load(path)? });
    }
    let here = Path::new(NAME);
    // A file of that name that is no description of a table is none of this command's business.
    let Some(table) = here.is_file().then(|| Described::load(here)) else { return Ok(Found::default()) };
    let table = match table {
        Ok(table) if table.is_empty() => return Ok(Found::default()),
        Ok(table) => table,
        Err(e) if std::fs::read_to_string(here).is_ok_and(|text| text.lines().any(|line| line.trim() == "[table]")) => {
            return Err(Failure::Input(e.to_string()));
        }
        Err(_) => return Ok(Found::default()),
    };
    tell(&format!("note: {NAME} of this folder describes the table: {}", words(&table)));
    Ok(Found { path: Some(here.to_path_buf()), table })
}

/// What is stated, in words.
fn words(table: &Described) -> String {
    let number = |name: &str, value: Option<f64>, unit: &str| value.map(|value| format!("{name} {value} {unit}"));
    let parts = [
        number("stroke", table.stroke, "m"),
        number("acceleration", table.acceleration, "m/s2"),
        number("jerk", table.jerk, "m/s3"),
        table.controller.as_ref().map(|name| format!("controller {name}")),
        number("payload", table.payload, "kg"),
        table.port.as_ref().map(|port| format!("port {}", port.display())),
        table.drive_unit.as_ref().map(|unit| format!("drives in {unit}")),
        number("", table.volts_per_metre, "V/m").map(|text| text.trim().to_owned()),
        table.valve.as_ref().map(|(unit, full)| format!("valve open at {full} {unit}")),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Stroke where nothing states one, m.
pub(crate) const STROKE: f64 = 0.12;
