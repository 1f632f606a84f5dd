//! The drive that a command writes: its quantity, unit and rate from the options, its form from the file's name.

pub(crate) mod provenance;

use super::Failure;
use super::failure::{first_given, within};
use super::output::{announce, tell};
use crate::motion::Motion;
use crate::motion::drive::{Drive, DriveUnit, Form, Quantity};
use crate::recording::Described;
use crate::recording::binary::rpc::Points;
use std::path::Path;

/// What the drive is, as options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Shape {
    /// What the drive is written as: displacement or acceleration [default: displacement; acceleration in .AT2].
    #[arg(long, value_name = "WHAT", value_parser = clap::builder::PossibleValuesParser::new(["displacement", "acceleration"]))]
    drive: Option<String>,
    /// Unit of the drive: m, cm, mm, in, V or % of the stroke; m/s2, cm/s2, mm/s2 or g for acceleration [default: the table's, else
    /// mm; m/s2; g in .AT2].
    #[arg(long, value_name = "UNIT")]
    drive_unit: Option<String>,
    /// Volts of the controller for one metre, where the drive is in V [default: the table's].
    #[arg(long, value_name = "V/M")]
    volts_per_metre: Option<f64>,
    /// Rate of the drive, Hz [default: 1000; the motion's own in .AT2].
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// RPC III with 16 bits over the drive's peak, for software that reads no floating point (RPC III 5.0x) [default: floating point].
    #[arg(long)]
    sixteen_bit: bool,
}

impl Shape {
    /// The first option given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        first_given([
            ("--drive", self.drive.is_some()),
            ("--drive-unit", self.drive_unit.is_some()),
            ("--volts-per-metre", self.volts_per_metre.is_some()),
            ("--rate", self.rate.is_some()),
            ("--sixteen-bit", self.sixteen_bit),
        ])
    }
}

/// What is written where.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    form: Form,
    quantity: Quantity,
    unit: DriveUnit,
    rate: Option<f64>,
}

/// Rate of a drive where none is asked for, Hz.
const RATE: f64 = 1000.0;

fn refuse<T>(option: &str, why: &str) -> Result<T, Failure> {
    Err(Failure::Input(format!("{option}: {why}")))
}

impl Shape {
    /// Refuses what describes a drive where none is written; `out` is the option that would write one.
    pub(crate) fn only_with(&self, out: &str) -> Result<(), Failure> {
        let all = [
            ("--drive", self.drive.is_some()),
            ("--drive-unit", self.drive_unit.is_some()),
            ("--volts-per-metre", self.volts_per_metre.is_some()),
            ("--rate", self.rate.is_some()),
            ("--sixteen-bit", self.sixteen_bit),
        ];
        match first_given(all) {
            Some(option) => {
                refuse(option, &format!("describes the drive that {out} writes: add that, or leave it out"))
            }
            None => Ok(()),
        }
    }

    /// The table's unit of drives, where a displacement is written and nothing else is asked for.
    pub(crate) fn described(&mut self, out: &Path, table: &Described) {
        let displacement =
            self.drive.as_deref() != Some("acceleration") && Form::of(out).is_ok_and(|form| form != Form::Peer);
        if displacement && self.drive_unit.is_none() {
            self.drive_unit.clone_from(&table.drive_unit);
        }
        if self.drive_unit.as_deref() == Some("V") {
            self.volts_per_metre = self.volts_per_metre.or(table.volts_per_metre);
        }
    }

    /// The same for a unit that another option states.
    pub(crate) fn or_unit(&mut self, unit: Option<&str>) {
        self.drive_unit = self.drive_unit.take().or_else(|| unit.map(str::to_owned));
    }

    /// What is to be written to `path` by the option `out`, judged before the work; `stroke` is the table's, m.
    pub(crate) fn plan(&self, out: &str, path: &Path, stroke: f64) -> Result<Plan, Failure> {
        // A device takes any form.
        let device = std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir());
        let form = match Form::of(path) {
            Ok(form) => form,
            Err(_) if device => Form::Csv,
            Err(why) => return refuse(&format!("{out} {}", path.display()), &why),
        };
        let form = match form {
            Form::Rpc(_) if self.sixteen_bit => Form::Rpc(Points::Short),
            _ if self.sixteen_bit => {
                return refuse("--sixteen-bit", "is for RPC III; name a .rpc file, or leave it out");
            }
            other => other,
        };
        let quantity = self.drive.as_deref().and_then(Quantity::named);
        if form == Form::Peer && quantity == Some(Quantity::Displacement) {
            return refuse("--drive displacement", "PEER .AT2 holds acceleration; name a .csv or .rpc file");
        }
        let usual = if form == Form::Peer { Quantity::Acceleration } else { Quantity::Displacement };
        let quantity = quantity.unwrap_or(usual);
        if let Some(rate) = self.rate {
            within("--rate", rate, 10.0, 20_000.0, "Hz")?;
        }
        let rate = self.rate.or((form != Form::Peer).then_some(RATE));
        Ok(Plan { form, quantity, unit: self.unit_of(form, quantity, stroke)?, rate })
    }

    fn unit_of(&self, form: Form, quantity: Quantity, stroke: f64) -> Result<DriveUnit, Failure> {
        let usual = match (form, quantity) {
            (Form::Peer, _) => "g",
            (_, Quantity::Displacement) => "mm",
            (_, Quantity::Acceleration) => "m/s2",
        };
        let symbol = self.drive_unit.as_deref().unwrap_or(usual);
        if form == Form::Peer && symbol != "g" {
            let option = format!("--drive-unit {symbol}");
            return refuse(&option, "PEER .AT2 is in g; name a .csv or .rpc file, or leave it out");
        }
        if self.volts_per_metre.is_some() && symbol != "V" {
            return refuse("--volts-per-metre", "is for a drive in V; add --drive-unit V, or leave it out");
        }
        match (symbol, quantity) {
            ("%", Quantity::Displacement) => Ok(DriveUnit { symbol: "%".into(), in_si: stroke / 100.0 }),
            ("V", Quantity::Displacement) => {
                let Some(volts) = self.volts_per_metre else {
                    return refuse("--drive-unit V", "say the controller's scale with --volts-per-metre");
                };
                within("--volts-per-metre", volts, 1e-3, 1e5, "V/m")?;
                Ok(DriveUnit { symbol: "V".into(), in_si: 1.0 / volts })
            }
            _ => DriveUnit::fixed(symbol, quantity).map_or_else(
                || {
                    let known = match quantity {
                        Quantity::Displacement => "m, cm, mm, in, V or %",
                        Quantity::Acceleration => "m/s2, cm/s2, mm/s2 or g",
                    };
                    refuse(&format!("unit {symbol}"), &format!("expected {known} for a drive in {}", quantity.name()))
                },
                Ok,
            ),
        }
    }
}

impl Plan {
    /// Writes the drive that a motion is, with these facts and what made it; gives what a page and the JSON say of it.
    pub(crate) fn write(
        &self,
        command: &str,
        path: &Path,
        motion: &Motion,
        facts: Vec<(String, String)>,
    ) -> Result<Vec<(String, String)>, Failure> {
        let mut drive = Drive::of(motion, self.quantity, self.unit.clone(), self.rate);
        drive.facts = facts;
        if matches!(self.form, Form::Rpc(_))
            && let Some(time) = drive.return_to_zero()
        {
            tell(&format!(
                "note: {}: returns to zero over {time:.1} s, for RPC III fills up with zeros",
                path.display()
            ));
            drive.facts.push(("return_to_zero_s".into(), format!("{time:.3}")));
        }
        drive.facts.extend(provenance::made());
        announce(path);
        drive.write(path, self.form).map_err(|e| {
            let text = format!("{command}: {e}");
            if e.is_io() { Failure::Work(text) } else { Failure::Input(text) }
        })?;
        if self.form == Form::Rpc(Points::Short) {
            self.say_resolution(path, &drive);
        }
        let mut facts = vec![
            ("file".to_owned(), path.display().to_string()),
            ("quantity".into(), self.quantity.name().into()),
            ("unit".into(), self.unit.symbol.clone()),
            ("rate_hz".into(), format!("{:.6}", 1.0 / drive.dt).trim_end_matches('0').trim_end_matches('.').to_owned()),
        ];
        facts.extend(drive.facts);
        Ok(facts)
    }

    /// What sixteen bits make of it.
    fn say_resolution(&self, path: &Path, drive: &Drive) {
        let (step, noise) = drive.rpc_resolution();
        let (unit, more) = match self.quantity {
            Quantity::Displacement => ("m", format!(", {noise:.2} m/s2 RMS of acceleration at its rate")),
            Quantity::Acceleration => ("m/s2", String::new()),
        };
        tell(&format!("note: {}: sixteen bits over the peak are steps of {step:.3e} {unit}{more}", path.display()));
    }
}
