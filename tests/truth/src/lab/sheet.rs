//! An experiment as files: `experiment.toml` and one CSV a run.

use super::answer::file;
use super::scene::{Kind, Scene, rounded};
use super::stated::{Controller, Kind as Law};
use crate::closed_loop::Traces;
use crate::plant::Machine;
use crate::refit::Parameter;
use crate::rng::Stream;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

const GRAVITY: f64 = 9.80665;

/// A column: its channel, header, unit, factor from SI to the file, decimals, and stated noise (SI).
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Channel of the formats.
    pub channel: &'static str,
    /// Header in the CSV.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// File value = SI value times this.
    pub factor: f64,
    /// Decimals written.
    pub decimals: usize,
    /// Stated noise (SI); none where it is not stated.
    pub noise: Option<f64>,
}

/// One run's rows, in the units of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// File name.
    pub file: String,
    /// One vector a column.
    pub values: Vec<Vec<f64>>,
    /// The loop as stated.
    pub controller: Controller,
    /// `fit`, `holdout`, or nothing stated.
    pub using: Option<&'static str>,
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
    pub effects: Vec<String>,
    /// Columns.
    pub columns: Vec<Column>,
    /// Runs.
    pub sheets: Vec<Sheet>,
}

/// What the pressures are stated in: MPa per m/s2, offset (m/s2), noise (m/s2); supply at the start (MPa).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pressures {
    /// Load pressure.
    pub load: Option<(f64, f64, f64)>,
    /// Supply pressure.
    pub supply: Option<f64>,
}

/// What decides the rows beside the traces.
pub struct Rows<'a> {
    /// The experiment.
    pub scene: &'a Scene,
    /// Pressures.
    pub pressures: Pressures,
    /// Whether the recording is as perfect sensors and files give it.
    pub clean: bool,
}

impl Rows<'_> {
    /// Columns of every run.
    pub fn columns(&self) -> Vec<Column> {
        let says = &self.scene.says;
        // Without noise the recording is still weighed by the noise that there truly was.
        let sigma = &self.scene.sigma;
        let noise =
            if self.clean { (Some(sigma.displacement), sigma.acceleration) } else { (says.noise.0, says.noise.1) };
        let lab = says.laboratory_units;
        let column = |channel, short, unit, factor, decimals, noise| Column {
            channel,
            name: if lab { short } else { channel },
            unit,
            factor,
            decimals,
            noise,
        };
        let (length, per_m, digits) = if lab { ("mm", 1e3, 4) } else { ("m", 1.0, 7) };
        let mut out =
            vec![column("time", "t", "s", 1.0, 8, None), column("reference", "xr", length, per_m, digits, None)];
        if says.channels[0] {
            out.push(column("displacement", "lvdt", length, per_m, digits, noise.0));
        }
        if says.channels[1] {
            let (unit, factor) = if lab { ("g", 1.0 / GRAVITY) } else { ("m/s2", 1.0) };
            out.push(column("acceleration", "acc", unit, factor, 7, noise.1));
        }
        if says.channels[2] {
            let unit = match self.scene.kind {
                Kind::Servo => "1",
                Kind::Rigid => "N",
                Kind::Axis => "V",
            };
            out.push(column("command", "u", unit, 1.0, 9, None));
        }
        if let Some((scale, _, noise)) = self.pressures.load {
            out.push(column("pressure_difference", "dp", "MPa", scale, 6, Some(noise)));
        }
        if let Some(start) = self.pressures.supply {
            out.push(column("supply_pressure", "ps", "MPa", start, 5, Some(0.002)));
        }
        out
    }

    /// One run's sheet.
    pub fn sheet(&self, i: usize, columns: &[Column], traces: &Traces, rng: &mut Stream) -> Sheet {
        let run = &self.scene.runs[i];
        let says = &self.scene.says;
        let stated_dt = run.dt / if self.clean { 1.0 } else { says.clock };
        let mut values: Vec<Vec<f64>> = columns
            .iter()
            .map(|column| {
                let noise = if self.clean { 0.0 } else { column.noise.unwrap_or(0.0) };
                let scaled = |x: &[f64]| x.iter().map(|v| v * column.factor).collect::<Vec<_>>();
                match column.channel {
                    "time" => (0..run.reference.len()).map(|k| k as f64 * stated_dt).collect(),
                    "reference" => scaled(&run.reference),
                    "displacement" => scaled(&traces.displacement),
                    "acceleration" => scaled(&traces.acceleration),
                    "pressure_difference" => {
                        let offset = self.pressures.load.map_or(0.0, |p| p.1);
                        traces.pressure.iter().map(|p| column.factor * (p + noise * rng.normal() + offset)).collect()
                    }
                    "supply_pressure" => {
                        traces.supply.iter().map(|r| column.factor * (r + noise * rng.normal())).collect()
                    }
                    _ => traces.command.clone(),
                }
            })
            .collect();
        let mut controller = Controller { late: 0, ..run.controller };
        if !self.clean {
            spoil(&mut values, stated_dt, says.stamps, says.rows_left_out, rng);
            controller = restated(controller, says.gains);
        }
        let last = i + 1 == self.scene.runs.len();
        let using = (self.scene.runs.len() > 1).then_some(if last { "holdout" } else { "fit" });
        Sheet { file: file(run.number), values, controller, using }
    }
}

/// Time stamps that scatter and rows that were lost.
fn spoil(values: &mut [Vec<f64>], dt: f64, (scatter, places): (f64, usize), left_out: bool, rng: &mut Stream) {
    if scatter > 0.0 {
        for t in values[0].iter_mut().skip(1) {
            *t += (scatter * rng.normal()).clamp(-0.45 * dt, 0.45 * dt);
        }
    }
    for _ in 0..places {
        let rows = values[0].len();
        let lost = 1 + rng.below(20);
        let from = 50 + rng.below(rows.saturating_sub(150));
        let to = (from + lost).min(rows);
        if left_out {
            for column in values.iter_mut() {
                column.drain(from..to);
            }
        } else {
            for column in values.iter_mut().skip(2) {
                column[from..to].fill(f64::NAN);
            }
        }
    }
}

fn restated(controller: Controller, gains: [f64; 3]) -> Controller {
    let times = |value: f64, factor: f64| if factor == 1.0 { value } else { rounded(value * factor, 5) };
    let kind = match controller.kind {
        Law::Pi { kp, ki } => Law::Pi { kp: times(kp, gains[0]), ki: times(ki, gains[1]) },
        Law::Cascade { kp, kv } => Law::Cascade { kp: times(kp, gains[0]), kv: times(kv, gains[1]) },
    };
    Controller { kind, kvf: times(controller.kvf, gains[2]), ..controller }
}

fn stated_loop(controller: &Controller) -> String {
    let mut out = match controller.kind {
        Law::Pi { kp, ki } => format!("kp = {kp:?}, ki = {ki:?}"),
        Law::Cascade { kp, kv } => format!("kind = \"cascade\", kp = {kp:?}, kv = {kv:?}"),
    };
    if controller.kvf != 0.0 {
        let _ = write!(out, ", kvf = {:?}", controller.kvf);
    }
    if let Some([frequency, damping, depth]) = controller.notch {
        let _ = write!(out, ", notch = {{ frequency = {frequency:?}, damping = {damping:?}, depth = {depth:?} }}");
    }
    format!("{{ {out} }}")
}

impl Sheets {
    /// Writes the folder; it is made where it is missing.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::create_dir_all(folder)?;
        for sheet in &self.sheets {
            let out = std::fs::File::create(folder.join(&sheet.file))?;
            let mut out = std::io::BufWriter::with_capacity(1 << 16, out);
            self.write_rows(sheet, &mut out)?;
            out.flush()?;
        }
        std::fs::write(folder.join("experiment.toml"), self.toml())
    }

    fn write_rows(&self, sheet: &Sheet, out: &mut impl std::io::Write) -> std::io::Result<()> {
        let names: Vec<&str> = self.columns.iter().map(|c| c.name).collect();
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
        let declared: Vec<&str> = self.effects.iter().map(String::as_str).collect();
        let mut free: Vec<&str> = self.fit.iter().map(|p| p.key()).collect();
        free.extend(&declared);
        if !free.is_empty() {
            let _ = writeln!(out, "fit = [{}]", list(&free));
        }
        if !declared.is_empty() {
            let _ = writeln!(out, "effects = [{}]", list(&declared));
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
            let _ =
                write!(out, "\n[[runs]]\nfile = \"{}\"\ncontroller = {}\n", sheet.file, stated_loop(&sheet.controller));
            if let Some(using) = sheet.using {
                let _ = writeln!(out, "use = \"{using}\"");
            }
        }
        out
    }
}
