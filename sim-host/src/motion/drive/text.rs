//! Drives as text: CSV with a header of facts, PEER AT2 with a title that says what it is, and the facts alone as TOML.

use super::{Drive, DriveError, DriveUnit, Quantity};
use crate::motion::STANDARD_GRAVITY;
use crate::motion::read;
use std::fmt::Write as _;
use std::path::Path;

/// The fact that says how many values there are.
const SAMPLES: &str = "samples";

/// Facts with which a file can be read back, before those of its provenance.
fn facts(drive: &Drive) -> Vec<(String, String)> {
    let own = [
        ("quantity", drive.quantity.name().to_owned()),
        ("unit", drive.unit.symbol.clone()),
        ("unit_in_si", drive.unit.in_si.to_string()),
        ("dt_s", drive.dt.to_string()),
        (SAMPLES, drive.values.len().to_string()),
    ];
    let own = own.map(|(key, value)| (key.to_owned(), value));
    let others = drive.facts.iter().filter(|(key, _)| !own.iter().any(|(k, _)| k == key));
    own.iter().cloned().chain(others.cloned()).collect()
}

/// One line of it.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

pub(super) fn csv(drive: &Drive) -> String {
    let mut text = String::from("# shakedown drive 1: not a recorded ground motion; played as it is\n");
    for (key, value) in facts(drive) {
        let _ = writeln!(text, "# {key} = {}", one_line(&value));
    }
    let _ = writeln!(text, "time [s],{} [{}]", drive.quantity.name(), drive.unit.symbol);
    for (k, value) in drive.values.iter().enumerate() {
        let _ = writeln!(text, "{:.9},{}", k as f64 * drive.dt, value / drive.unit.in_si);
    }
    text
}

pub(super) fn toml(drive: &Drive) -> String {
    let mut text = String::from("# Facts of the drive beside this file, which cannot be read without them.\n");
    for (key, value) in facts(drive) {
        let _ = writeln!(text, "{key} = {}", toml::Value::String(one_line(&value)));
    }
    text
}

pub(super) fn read_toml(text: &str) -> Result<Vec<(String, String)>, String> {
    let table: toml::Table = toml::from_str(text).map_err(|e| e.message().to_owned())?;
    Ok(table.into_iter().filter_map(|(key, value)| Some((key, value.as_str()?.to_owned()))).collect())
}

/// PEER: five values a line in g, one line of facts, one title.
pub(super) fn peer(drive: &Drive) -> String {
    let facts: Vec<String> = drive.facts.iter().map(|(key, value)| format!("{key} = {}", one_line(value))).collect();
    let mut text = format!("SHAKEDOWN DRIVE, NOT A RECORDED GROUND MOTION; {}\n", facts.join("; "));
    let _ = writeln!(text, "drive from {}", one_line(drive.fact("source").unwrap_or("a motion")));
    text.push_str("ACCELERATION TIME SERIES IN UNITS OF G\n");
    let _ = writeln!(text, "NPTS= {:6}, DT= {:.9} SEC,", drive.values.len(), drive.dt);
    for (k, value) in drive.values.iter().enumerate() {
        let end = if k % 5 == 4 || k + 1 == drive.values.len() { "\n" } else { "" };
        let _ = write!(text, "{:>15}{end}", format!("{:.7E}", value / STANDARD_GRAVITY));
    }
    text
}

/// What the facts say of the values.
pub(super) fn stated(facts: &[(String, String)]) -> Result<(Quantity, DriveUnit), String> {
    let of = |key: &str| {
        let found = facts.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str());
        found.ok_or_else(|| format!("`{key}` is missing among the drive's facts: write the drive again"))
    };
    let quantity = Quantity::named(of("quantity")?)
        .ok_or_else(|| "`quantity` is neither displacement nor acceleration: write the drive again".to_owned())?;
    let in_si = of("unit_in_si")?.parse::<f64>().ok().filter(|v| v.is_finite() && *v > 0.0);
    let in_si = in_si.ok_or_else(|| "`unit_in_si` is no positive number: write the drive again".to_owned())?;
    let unit = DriveUnit { symbol: of("unit")?.to_owned(), in_si };
    // A unit that everybody knows cannot have another size.
    match DriveUnit::fixed(&unit.symbol, quantity) {
        Some(known) if (known.in_si / in_si - 1.0).abs() > 1e-9 => {
            Err(format!("`unit_in_si` is {in_si}, but one {} is {}: correct it", unit.symbol, known.in_si))
        }
        _ => Ok((quantity, unit)),
    }
}

/// How many values are the drive's; what follows them fills a frame.
pub(super) fn count(facts: &[(String, String)]) -> Result<usize, String> {
    let stated = facts.iter().find(|(key, _)| key == SAMPLES).and_then(|(_, value)| value.parse().ok());
    stated.ok_or_else(|| format!("`{SAMPLES}` is missing among the drive's facts: write the drive again"))
}

pub(super) fn read_csv(path: &Path, bytes: &[u8]) -> Result<Drive, DriveError> {
    let at = |line: usize, problem: String| DriveError::content(path, format!("line {line}: {problem}"));
    let text =
        std::str::from_utf8(bytes).map_err(|_| DriveError::content(path, "is no UTF-8: write the drive again"))?;
    let mut facts = Vec::new();
    let mut values = Vec::new();
    let mut described = None;
    for (number, line) in text.lines().enumerate().map(|(i, line)| (i + 1, line.trim())) {
        if let Some(comment) = line.strip_prefix('#') {
            facts.extend(comment.split_once(" = ").map(|(k, v)| (k.trim().to_owned(), v.trim().to_owned())));
            continue;
        }
        let Some((quantity, unit)) = &described else {
            let (quantity, unit) = stated(&facts).map_err(|e| at(number, e))?;
            let header = format!("time [s],{} [{}]", quantity.name(), unit.symbol);
            if line != header {
                return Err(at(number, format!("expected the header `{header}`, which the facts above it state")));
            }
            described = Some((quantity, unit));
            continue;
        };
        let (time, value) = line.split_once(',').unwrap_or((line, ""));
        let read = |field: &str| field.parse::<f64>().ok().filter(|v| v.is_finite());
        let (Some(time), Some(value)) = (read(time), read(value)) else {
            return Err(at(number, format!("expected a time in s and a {} in {}", quantity.name(), unit.symbol)));
        };
        values.push((time, value * unit.in_si));
    }
    let (quantity, unit) = described.ok_or_else(|| DriveError::content(path, "holds no row: write the drive again"))?;
    let dt = facts.iter().find(|(k, _)| k == "dt_s").and_then(|(_, v)| v.parse::<f64>().ok()).filter(|dt| *dt > 0.0);
    let dt = dt.ok_or_else(|| DriveError::content(path, "`dt_s` is missing among the facts: write the drive again"))?;
    if let Some(k) = values.iter().enumerate().position(|(k, (t, _))| (t - k as f64 * dt).abs() > 1e-3 * dt + 1e-9) {
        return Err(DriveError::content(
            path,
            format!("row {}: time {} s does not follow dt_s = {dt} s", k + 1, values[k].0),
        ));
    }
    if let Some((_, stated)) = facts.iter().find(|(key, _)| key == SAMPLES)
        && stated.parse() != Ok(values.len())
    {
        let found = values.len();
        return Err(DriveError::content(
            path,
            format!("holds {found} rows, but `{SAMPLES} = {stated}`: write the drive again"),
        ));
    }
    Ok(Drive { quantity, dt, values: values.into_iter().map(|(_, v)| v).collect(), unit, facts })
}

pub(super) fn read_peer(path: &Path, bytes: Vec<u8>) -> Result<Drive, DriveError> {
    let record = read::drive_from_bytes(path, bytes).map_err(|e| DriveError::content(path, e.problem.to_string()))?;
    let first = record.fact("database").unwrap_or_default().to_owned();
    let facts = first.split("; ").skip(1).filter_map(|part| part.split_once(" = "));
    Ok(Drive {
        quantity: Quantity::Acceleration,
        dt: record.dt,
        values: record.acceleration,
        unit: DriveUnit { symbol: "g".into(), in_si: STANDARD_GRAVITY },
        facts: facts.map(|(key, value)| (key.to_owned(), value.to_owned())).collect(),
    })
}
