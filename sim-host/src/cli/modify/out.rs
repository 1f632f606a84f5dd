//! The drive that is written: its quantity, unit and rate from the options, its provenance from everything.

use super::super::Failure;
use super::super::asked;
use super::super::failure::within;
use super::super::output::{announce, sha256, tell};
use super::Args;
use shakedown::motion::Record;
use shakedown::motion::drive::{Drive, DriveUnit, Form, Quantity};
use shakedown::motion::fit::answer::Answer;
use shakedown::recording::Described;
use std::path::{Path, PathBuf};

/// What the drive is, as options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(super) struct Shape {
    /// What the drive is written as: displacement or acceleration [default: displacement; acceleration in .AT2].
    #[arg(long, value_name = "WHAT", requires = "out", value_parser = clap::builder::PossibleValuesParser::new(["displacement", "acceleration"]))]
    drive: Option<String>,
    /// Unit of the drive: m, cm, mm, in, V or % of --stroke; m/s2, cm/s2, mm/s2 or g for acceleration [default: mm; m/s2].
    #[arg(long, value_name = "UNIT", requires = "out")]
    drive_unit: Option<String>,
    /// Volts of the controller for one metre, where the drive is in V.
    #[arg(long, value_name = "V/M")]
    volts_per_metre: Option<f64>,
    /// Rate of the drive, Hz [default: 1000; the fit's own in .AT2].
    #[arg(long, value_name = "HZ", requires = "out")]
    rate: Option<f64>,
}

impl Shape {
    /// The table's unit of drives, where a displacement is written and nothing else is asked for.
    pub(super) fn described(&mut self, out: Option<&Path>, unit: bool, table: &Described) {
        let displacement = self.drive.as_deref() != Some("acceleration")
            && out.is_some_and(|path| Form::of(path).is_ok_and(|form| form != Form::Peer));
        if displacement && !unit && self.drive_unit.is_none() {
            self.drive_unit.clone_from(&table.drive_unit);
        }
        if self.drive_unit.as_deref() == Some("V") {
            self.volts_per_metre = self.volts_per_metre.or(table.volts_per_metre);
        }
    }
}

/// What is written where.
pub(super) struct Plan {
    form: Form,
    quantity: Quantity,
    unit: DriveUnit,
    rate: Option<f64>,
}

/// Rate of a drive where none is asked for, Hz.
const RATE: f64 = 1000.0;

impl Args {
    /// What is to be written, judged before the work; none where nothing is.
    pub(super) fn plan(&self) -> Result<Option<Plan>, Failure> {
        let Some(path) = &self.out else { return Ok(None) };
        let refuse = |option: &str, why: &str| Err(Failure::Input(format!("{option}: {why}")));
        // A device takes any form.
        let device = std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir());
        let form = match Form::of(path) {
            Ok(form) => form,
            Err(_) if device => Form::Csv,
            Err(why) => return refuse(&format!("--out {}", path.display()), &why),
        };
        let quantity = self.shape.drive.as_deref().and_then(Quantity::named);
        if form == Form::Peer && quantity == Some(Quantity::Displacement) {
            return refuse("--drive displacement", "PEER .AT2 holds acceleration; name a .csv or .rpc file");
        }
        let usual = if form == Form::Peer { Quantity::Acceleration } else { Quantity::Displacement };
        let quantity = quantity.unwrap_or(usual);
        if let Some(rate) = self.shape.rate {
            within("--rate", rate, 10.0, 20_000.0)?;
        }
        let rate = self.shape.rate.or((form != Form::Peer).then_some(RATE));
        Ok(Some(Plan { form, quantity, unit: self.unit_of(form, quantity)?, rate }))
    }

    fn unit_of(&self, form: Form, quantity: Quantity) -> Result<DriveUnit, Failure> {
        let refuse = |why: String| Err(Failure::Input(why));
        let of_table = self.unit.as_deref().filter(|unit| unit.parse::<shakedown::motion::AccelerationUnit>().is_err());
        let asked = self.shape.drive_unit.as_deref().or(of_table);
        let usual = match (form, quantity) {
            (Form::Peer, _) => "g",
            (_, Quantity::Displacement) => "mm",
            (_, Quantity::Acceleration) => "m/s2",
        };
        let symbol = asked.unwrap_or(usual);
        if form == Form::Peer && symbol != "g" {
            return refuse(format!(
                "--drive-unit {symbol}: PEER .AT2 is in g; name a .csv or .rpc file, or leave it out"
            ));
        }
        if self.shape.volts_per_metre.is_some() && symbol != "V" {
            return refuse("--volts-per-metre: is for a drive in V; add --drive-unit V, or leave it out".into());
        }
        match (symbol, quantity) {
            ("%", Quantity::Displacement) => Ok(DriveUnit { symbol: "%".into(), in_si: self.stroke() / 100.0 }),
            ("V", Quantity::Displacement) => {
                let Some(volts) = self.shape.volts_per_metre else {
                    return refuse("--drive-unit V: say the controller's scale with --volts-per-metre".into());
                };
                within("--volts-per-metre", volts, 1e-3, 1e5)?;
                Ok(DriveUnit { symbol: "V".into(), in_si: 1.0 / volts })
            }
            _ => DriveUnit::fixed(symbol, quantity).map_or_else(
                || {
                    let known = match quantity {
                        Quantity::Displacement => "m, cm, mm, in, V or %",
                        Quantity::Acceleration => "m/s2, cm/s2, mm/s2 or g",
                    };
                    refuse(format!("unit {symbol}: expected {known} for a drive in {}", quantity.name()))
                },
                Ok,
            ),
        }
    }
}

/// Writes the drive; gives what the page and the JSON say of it.
pub(super) fn write(
    args: &Args,
    plan: &Plan,
    record: &Record,
    answer: &Answer,
    inputs: &[PathBuf],
) -> Result<Vec<(String, String)>, Failure> {
    let Some(path) = &args.out else { return Ok(Vec::new()) };
    let mut drive = Drive::of(&answer.modified.motion, plan.quantity, plan.unit.clone(), plan.rate);
    drive.facts = provenance(args, record, answer, inputs)?;
    announce(path);
    drive.write(path, plan.form).map_err(|e| {
        let text = format!("modify: {e}");
        if e.is_io() { Failure::Work(text) } else { Failure::Input(text) }
    })?;
    if plan.form == Form::Rpc {
        let (step, noise) = drive.rpc_resolution();
        tell(&format!(
            "note: {}: sixteen bits over the peak are steps of {step:.3e} {}{}",
            path.display(),
            if plan.quantity == Quantity::Displacement { "m" } else { "m/s2" },
            if plan.quantity == Quantity::Displacement {
                format!(", {noise:.2} m/s2 RMS of acceleration at its rate")
            } else {
                String::new()
            },
        ));
    }
    let mut facts = vec![
        ("file".to_owned(), path.display().to_string()),
        ("quantity".into(), plan.quantity.name().into()),
        ("unit".into(), plan.unit.symbol.clone()),
        ("rate_hz".into(), format!("{:.6}", 1.0 / drive.dt).trim_end_matches('0').trim_end_matches('.').to_owned()),
    ];
    facts.extend(drive.facts);
    Ok(facts)
}

/// Where a drive comes from and what it is.
fn provenance(
    args: &Args,
    record: &Record,
    answer: &Answer,
    inputs: &[PathBuf],
) -> Result<Vec<(String, String)>, Failure> {
    let mut facts: Vec<(String, String)> = Vec::new();
    let mut put = |key: &str, value: String| facts.push((key.to_owned(), value));
    if let Some(path) = inputs.first() {
        put("source", path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()));
        put("source_sha256", sha256(path)?);
    } else {
        put("source", format!("generated {}", record.name));
        put("seed", args.seed.unwrap_or(1).to_string());
    }
    if !record.component.is_empty() {
        put("component", record.component.clone());
    }
    put("conditioning", answer.conditioning.clone());
    put("method", answer.method_name());
    for (name, limit) in answer.limits.named() {
        if let Some(limit) = limit {
            put(&format!("limit_{name}"), format!("{limit}"));
        }
    }
    let (_, _, a) = answer.modified.motion.peaks();
    let (x, v) = answer.modified.motion.peaks_between();
    put("peak_displacement_m", format!("{x:.6}"));
    put("peak_velocity_m_per_s", format!("{v:.6}"));
    put("peak_acceleration_m_per_s2", format!("{a:.6}"));
    put("e_a", format!("{:.6}", answer.compared.fitted.e_a.ratio));
    put("command_line", asked::line());
    put("version", env!("CARGO_PKG_VERSION").into());
    put("written", asked::utc());
    Ok(facts)
}
