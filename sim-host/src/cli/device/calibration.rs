//! Calibration of LVDT and accelerometer against a reference of the operator's, kept with its date; and whether one is overdue.

use super::asking::{means, prompted};
use super::failed;
use crate::cli::Failure;
use crate::cli::asked::{seconds, utc};
use crate::cli::output::{print, write_whole};
use crate::device::{Port, Session};
use serde::{Deserialize, Serialize};
use shakedown_core::link::{Scale, Wiring};
use std::path::Path;

/// Where it is kept, in the folder that the tool is called from: one folder a table.
pub(super) const FILE: &str = "calibration.toml";
/// How long it holds, s: a year.
const HOLDS: u64 = 365 * 86_400;
/// Least change of the code between the outermost points, as a share of the converter's range: a twentieth of it tells the scale to 0.2 %
/// with a code read to 8 of 65536.
const SPREAD: f64 = 0.05;
/// Codes nearer to a rail than this share of the range are no reading (`docs/commissioning.md`, step 5).
const RAIL: f64 = 1.0 / 4096.0;
/// What scale of setup and calibration may differ by, as a share of the converter's range.
const SAME: f64 = 1e-3;

/// A sensor that is calibrated.
struct Sensor {
    key: &'static str,
    /// Its place among the converter's inputs.
    input: usize,
    /// Unit of what is typed, and how many SI units one of it is.
    unit: (&'static str, f64),
    points: &'static [&'static str],
    scale: fn(&Wiring) -> Scale,
}

const SENSORS: [Sensor; 2] = [
    Sensor {
        key: "displacement",
        input: 1,
        unit: ("mm", 1e-3),
        points: &["LVDT at its negative end", "LVDT in the middle", "LVDT at its positive end"],
        scale: |wiring| wiring.displacement,
    },
    Sensor {
        key: "acceleration",
        input: 2,
        unit: ("m/s2", 1.0),
        points: &[
            "accelerometer upright, its axis up",
            "accelerometer lying, its axis level",
            "accelerometer turned over",
        ],
        scale: |wiring| wiring.acceleration,
    },
];

/// What is kept of a sensor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Kept {
    /// Code at zero.
    zero: f64,
    /// SI units a code.
    per_code: f64,
    /// Largest distance of a point from the line, SI.
    nonlinearity: f64,
    date: String,
    /// Seconds since 1970.
    seconds: u64,
    /// The operator's instrument.
    reference: String,
    /// Reading of the reference (SI) and mean code, point by point.
    points: Vec<(f64, f64)>,
}

/// The file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
struct Calibration {
    displacement: Option<Kept>,
    acceleration: Option<Kept>,
}

impl Calibration {
    fn read(text: Option<&str>) -> Result<Self, &'static str> {
        text.map_or(Ok(Self::default()), |text| toml::from_str(text).map_err(|_| "left a file that cannot be read"))
    }

    const fn of(&mut self, sensor: &Sensor) -> &mut Option<Kept> {
        if sensor.input == 1 { &mut self.displacement } else { &mut self.acceleration }
    }
}

/// Walks through it and writes `file`. A sensor at which it is ended stays as it was.
pub(super) fn walk(session: &mut Session<Port>, file: &Path) -> Result<(), Failure> {
    let before = std::fs::read_to_string(file).ok();
    let refuse = |why| Failure::Input(format!("{}: {why}; move it away", file.display()));
    let mut calibration = Calibration::read(before.as_deref()).map_err(refuse)?;
    print("Calibration: hydraulics off. `stop` ends, and keeps the sensors that are done.\n");
    let named = prompted("0", "Reference instrument and its certificate?")?.filter(|typed| !typed.is_empty());
    let Some(reference) = named else {
        return Err(Failure::Input("a calibration without a reference is none".into()));
    };
    let wiring = session.setup().map_err(failed)?.wiring;
    for sensor in &SENSORS {
        let Some(points) = measured(session, sensor)? else { break };
        let kept = fitted(sensor, points, wiring.full_scale, &reference)?;
        let (unit, si) = sensor.unit;
        print(&format!(
            "wiring.{} = {{ zero = {:.2}, per_code = {:e} }}, linear within {:.3} {unit}\n",
            sensor.key,
            kept.zero,
            kept.per_code,
            kept.nonlinearity / si
        ));
        *calibration.of(sensor) = Some(kept);
        let text = toml::to_string(&calibration).map_err(|e| Failure::Work(e.to_string()))?;
        write_whole(file, text.as_bytes())?;
    }
    let open = due(std::fs::read_to_string(file).ok().as_deref(), seconds(), &wiring);
    print(&open.iter().fold(format!("{} has what was calibrated.\n", file.display()), |text, line| text + line + "\n"));
    Ok(())
}

/// Readings of the reference, SI, and codes; none where it was ended.
fn measured(session: &mut Session<Port>, sensor: &Sensor) -> Result<Option<Vec<(f64, f64)>>, Failure> {
    let (unit, si) = sensor.unit;
    let mut points = Vec::new();
    for (number, place) in (1..).zip(sensor.points) {
        let ask = format!("{place}: the reference reads [{unit}]?");
        let Some(typed) = prompted(&format!("{} {number}", sensor.key), &ask)? else { return Ok(None) };
        let wrong = || Failure::Input(format!("`{typed}` is no reading in {unit}"));
        let reading: f64 = typed.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(wrong)?;
        let codes = means(session)?;
        points.push((si * reading, codes.get(sensor.input).copied().unwrap_or(f64::NAN)));
    }
    Ok(Some(points))
}

/// The line through `points` by least squares: code over reading, for the code is what scatters.
fn fitted(sensor: &Sensor, points: Vec<(f64, f64)>, full_scale: u16, reference: &str) -> Result<Kept, Failure> {
    let range = f64::from(full_scale);
    let refuse = |why: &str| Err(Failure::Work(format!("{}: {why}", sensor.key)));
    if points.iter().any(|&(_, code)| !(RAIL * range..=(1.0 - RAIL) * range).contains(&code)) {
        return refuse("a code at a rail is no reading: look for a broken wire or a saturated amplifier");
    }
    let count = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (reading, code) = (mean(|p| p.0), mean(|p| p.1));
    let square: f64 = points.iter().map(|p| (p.0 - reading).powi(2)).sum();
    let both: f64 = points.iter().map(|p| (p.0 - reading) * (p.1 - code)).sum();
    let slope = both / square;
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.1), high.max(p.1)));
    if !slope.is_finite() || slope == 0.0 || high - low < SPREAD * range {
        return refuse("the code hardly changed between the points: does the sensor move, and is it on this input?");
    }
    let zero = code - slope * reading;
    let nonlinearity = points.iter().map(|p| ((p.1 - zero) / slope - p.0).abs()).fold(0.0, f64::max);
    let (date, seconds) = (utc(), seconds());
    Ok(Kept { zero, per_code: 1.0 / slope, nonlinearity, date, seconds, reference: reference.into(), points })
}

/// Says what of the calibration is overdue.
pub(super) fn say_overdue(session: &mut Session<Port>) -> Result<(), Failure> {
    let wiring = session.setup().map_err(failed)?.wiring;
    for line in due(std::fs::read_to_string(FILE).ok().as_deref(), seconds(), &wiring) {
        print(&format!("note: {line}\n"));
    }
    Ok(())
}

/// What is to be said of a calibration kept as `text`, beside the `wiring` in force; nothing where it holds. `now` is in seconds since 1970.
fn due(text: Option<&str>, now: u64, wiring: &Wiring) -> Vec<String> {
    let mut calibration = match Calibration::read(text) {
        Ok(calibration) => calibration,
        Err(why) => return vec![format!("calibration {why}: {FILE}")],
    };
    let of = |sensor: &Sensor| {
        let key = sensor.key;
        let Some(kept) = calibration.of(sensor) else {
            return Some(format!("{key} was never calibrated here: `device commission --calibrate`"));
        };
        if kept.seconds > now || now - kept.seconds > HOLDS {
            return Some(format!(
                "the calibration of {key} is overdue, of {}: `device commission --calibrate`",
                kept.date
            ));
        }
        let (scale, range) = ((sensor.scale)(wiring), f64::from(wiring.full_scale));
        // In the middle and at the end of the range, in codes.
        let off = |code: f64| {
            ((code - kept.zero) * kept.per_code / f64::from(scale.per_code) + f64::from(scale.zero) - code).abs()
        };
        let same = off(kept.zero).max(off(0.0)).max(off(range)) <= SAME * range;
        (!same).then(|| format!("{key}: the setup in force has another scale than {FILE}"))
    };
    SENSORS.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests;
