//! An experiment as files: `experiment.toml` and one CSV a run.

use crate::closed_loop::{Controller, Run, Traces};
use crate::plant::Machine;
use crate::refit::{Parameter, Sigma};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// A column: its channel, what the CSV calls it, its unit, the factor from SI to the file, and its decimals.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Channel of the formats.
    pub channel: &'static str,
    /// Header in the CSV.
    pub name: String,
    /// Unit as stated.
    pub unit: &'static str,
    /// File value = SI value times this.
    pub factor: f64,
    /// Decimals written.
    pub decimals: usize,
    /// Stated noise (SI).
    pub noise: Option<f64>,
}

/// One run's rows, in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// File name.
    pub file: String,
    /// One column a channel, in the order of [`Sheets::columns`].
    pub values: Vec<Vec<f64>>,
    /// The loop as stated.
    pub controller: Controller,
    /// Held out.
    pub holdout: bool,
}

/// A whole experiment.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheets {
    /// Name in the TOML.
    pub name: String,
    /// The stated model.
    pub machine: Machine,
    /// Its free parameters.
    pub fit: Vec<Parameter>,
    /// Effects that the model declares and frees.
    pub effects: Vec<&'static str>,
    /// Columns.
    pub columns: Vec<Column>,
    /// Runs.
    pub sheets: Vec<Sheet>,
}

/// What decides the columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layout {
    /// Millimetres and g instead of metres and m/s2.
    pub laboratory_units: bool,
    /// Whether there is an accelerometer, and its noise; the displacement's noise.
    pub sigma: Sigma,
    /// Unit of the command.
    pub command_unit: &'static str,
    /// Scale of the pressure (file unit per m/s2), its offset and noise, where recorded.
    pub pressure: Option<(f64, f64, f64)>,
    /// Supply pressure at the start (`MPa`), where recorded.
    pub supply: Option<f64>,
}

const GRAVITY: f64 = 9.80665;

impl Layout {
    /// Columns of every run.
    pub fn columns(&self) -> Vec<Column> {
        let column = |channel, unit, factor, decimals, noise| Column {
            channel,
            name: if self.laboratory_units { short_name(channel).to_string() } else { channel.to_string() },
            unit,
            factor,
            decimals,
            noise,
        };
        let (length, per_m, length_digits) = if self.laboratory_units { ("mm", 1e3, 4) } else { ("m", 1.0, 7) };
        let mut out = vec![
            column("time", "s", 1.0, 8, None),
            column("reference", length, per_m, length_digits, None),
            column("displacement", length, per_m, length_digits, Some(self.sigma.displacement)),
        ];
        if let Some(noise) = self.sigma.acceleration {
            let (unit, factor, digits) = if self.laboratory_units { ("g", 1.0 / GRAVITY, 7) } else { ("m/s2", 1.0, 6) };
            out.push(column("acceleration", unit, factor, digits, Some(noise)));
        }
        out.push(column("command", self.command_unit, 1.0, 9, None));
        if let Some((scale, _, noise)) = self.pressure {
            out.push(column("pressure_difference", "MPa", scale, 6, Some(noise)));
        }
        if let Some(start) = self.supply {
            out.push(column("supply_pressure", "MPa", start, 5, Some(0.002)));
        }
        out
    }

    /// The rows of one run. `jitter` draws the noise of the pressures, standard normal.
    pub fn values(
        &self,
        columns: &[Column],
        run: &Run,
        traces: &Traces,
        mut jitter: impl FnMut() -> f64,
    ) -> Vec<Vec<f64>> {
        columns
            .iter()
            .map(|column| {
                let noise = column.noise.unwrap_or(0.0);
                let scaled = |x: &[f64]| x.iter().map(|v| v * column.factor).collect::<Vec<_>>();
                match column.channel {
                    "time" => (0..run.reference.len()).map(|k| k as f64 * run.dt).collect(),
                    "reference" => scaled(&run.reference),
                    "displacement" => scaled(&traces.displacement),
                    "acceleration" => scaled(&traces.acceleration),
                    "pressure_difference" => {
                        let offset = self.pressure.map_or(0.0, |p| p.1);
                        traces.pressure.iter().map(|p| column.factor * (p + noise * jitter() + offset)).collect()
                    }
                    "supply_pressure" => traces.supply.iter().map(|r| column.factor * (r + noise * jitter())).collect(),
                    _ => traces.command.clone(),
                }
            })
            .collect()
    }
}

fn short_name(channel: &str) -> &str {
    match channel {
        "time" => "t",
        "reference" => "xr",
        "displacement" => "lvdt",
        "acceleration" => "acc",
        "command" => "u",
        "pressure_difference" => "dp",
        "supply_pressure" => "ps",
        other => other,
    }
}

impl Sheets {
    /// Writes the folder; it is made where it is missing.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        for sheet in &self.sheets {
            let file = std::fs::File::create(folder.join(&sheet.file))?;
            let mut out = std::io::BufWriter::with_capacity(1 << 16, file);
            self.write_rows(sheet, &mut out)?;
            out.flush()?;
        }
        std::fs::write(folder.join("experiment.toml"), self.toml())
    }

    fn write_rows(&self, sheet: &Sheet, out: &mut impl std::io::Write) -> std::io::Result<()> {
        let names: Vec<&str> = self.columns.iter().map(|c| c.name.as_str()).collect();
        writeln!(out, "{}", names.join(","))?;
        let rows = sheet.values.iter().map(Vec::len).min().unwrap_or(0);
        for row in 0..rows {
            for (i, (column, values)) in self.columns.iter().zip(&sheet.values).enumerate() {
                if i > 0 {
                    out.write_all(b",")?;
                }
                write!(out, "{:.*}", column.decimals, values[row])?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    }

    /// The experiment.
    pub fn toml(&self) -> String {
        let mut out = format!("name = \"{}\"\n\n[model]\n", self.name);
        let kind = if matches!(self.machine, Machine::Servo { .. }) { "servo" } else { "rigid-mass" };
        let _ = writeln!(out, "kind = \"{kind}\"");
        for (key, value) in self.machine.parameters() {
            let _ = writeln!(out, "{key} = {value:?}");
        }
        let list = |names: &[&str]| names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ");
        let mut free: Vec<&str> = self.fit.iter().map(|p| p.key()).collect();
        free.extend(&self.effects);
        if !free.is_empty() {
            let _ = writeln!(out, "fit = [{}]", list(&free));
        }
        if !self.effects.is_empty() {
            let _ = writeln!(out, "effects = [{}]", list(&self.effects));
        }
        out.push_str("\n[channels]\n");
        for column in &self.columns {
            let _ = write!(out, "{} = {{ column = \"{}\", unit = \"{}\"", column.channel, column.name, column.unit);
            if let Some(noise) = column.noise {
                let _ = write!(out, ", noise = {:.4e}", noise * column.factor.abs());
            }
            out.push_str(" }\n");
        }
        for sheet in &self.sheets {
            let controller = match sheet.controller {
                Controller::Pi { kp, ki } => format!("{{ kp = {kp:?}, ki = {ki:?} }}"),
                Controller::Cascade { kp, kv } => format!("{{ kind = \"cascade\", kp = {kp:?}, kv = {kv:?} }}"),
            };
            let using = if sheet.holdout { "holdout" } else { "fit" };
            let _ =
                write!(out, "\n[[runs]]\nfile = \"{}\"\ncontroller = {controller}\nuse = \"{using}\"\n", sheet.file);
        }
        out
    }
}
