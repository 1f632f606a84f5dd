//! The reference of a device: a file with one, at the device's rate.

use super::Failure;
use super::output::tell;
use crate::motion::drive::{Drive as MotionDrive, Quantity};
use crate::recording::file;
use crate::recording::unit::{Dimension, Unit};
use std::path::Path;

/// Times, s, and the reference, m: of a drive, or of the columns with the units that their header states.
fn in_si(path: &Path, column: &str) -> Result<(Vec<f64>, Vec<f64>), Failure> {
    let refuse = |why: String| Failure::Input(format!("{}: {why}", path.display()));
    if let Some(drive) = MotionDrive::read(path).map_err(|e| Failure::Input(e.to_string()))? {
        if drive.quantity != Quantity::Displacement {
            return Err(refuse(
                "is a drive in acceleration, and the device plays displacement: write it with --drive displacement"
                    .into(),
            ));
        }
        let time = (0..drive.values.len()).map(|k| k as f64 * drive.dt).collect();
        return Ok((time, drive.values));
    }
    let table = file::read(path, &["time", column]).map_err(|e| Failure::Input(e.to_string()))?;
    for note in &table.notes {
        tell(&format!("note: {}: {note}", path.display()));
    }
    let factor = |i: usize, dimension: Dimension| {
        let Some(stated) = table.headings.get(i).and_then(|h| h.unit.as_deref()) else { return Ok(1.0) };
        let unit = Unit::in_header(stated).filter(|unit| unit.dimension == dimension);
        let expected = if dimension == Dimension::Time { "s or ms" } else { "m, mm, um or in" };
        unit.map(|unit| unit.factor).ok_or_else(|| refuse(format!("unit [{stated}]: expected {expected}")))
    };
    let (seconds, metres) = (factor(0, Dimension::Time)?, factor(1, Dimension::Length)?);
    let [time, reference] = table.columns.as_slice() else {
        return Err(refuse(format!("no columns `time` and `{column}`")));
    };
    let scaled = |values: &[f64], factor: f64| values.iter().map(|v| v * factor).collect();
    Ok((scaled(time, seconds), scaled(reference, metres)))
}

/// The reference at the device's rate, m, by straight lines between its samples.
pub(crate) fn resampled(path: &Path, column: &str, rate: f64) -> Result<Vec<f32>, Failure> {
    let (time, reference) = in_si(path, column)?;
    let rising = time.windows(2).all(|pair| pair[0] < pair[1]);
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else {
        return Err(Failure::Input(format!("{}: no samples", path.display())));
    };
    if !rising || !reference.iter().all(|x| x.is_finite()) {
        let why = "its time must rise from sample to sample, and its reference be numbers";
        return Err(Failure::Input(format!("{}: {why}", path.display())));
    }
    let ticks = ((last - first) * rate).round() as usize + 1;
    let mut at = 0;
    let points = (0..ticks).map(|tick| {
        let t = (first + tick as f64 / rate).min(last);
        while at + 2 < time.len() && time[at + 1] <= t {
            at += 1;
        }
        let Some((&after, &to)) = time.get(at + 1).zip(reference.get(at + 1)) else { return reference[at] as f32 };
        let share = (t - time[at]) / (after - time[at]);
        (reference[at] + share * (to - reference[at])) as f32
    });
    Ok(points.collect())
}
