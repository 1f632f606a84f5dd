//! Writing a record back in the format family it came from, whole or not at all.
//!
//! What is written reads back through [`super::read`] with the same interval, and values within the resolution of the
//! format's columns. Header peaks and counts are those of the values written.

mod cosmos;
mod csmip;
mod geonet;
mod knet;
mod peer;

pub(super) use knet::NO_OFFSET;

use super::{Format, Motion, Record, peak};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Why a record cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A value that the format's columns cannot hold.
    #[error("{format} has columns {width} wide, which cannot hold a {what} of {value}: write columns of text instead")]
    TooWide {
        /// The format.
        format: Format,
        /// What the value is.
        what: &'static str,
        /// The value in the format's unit.
        value: f64,
        /// Characters in a column.
        width: usize,
    },
    /// Nothing to write, or something that is no number.
    #[error("a record needs at least two samples, all finite, and a positive interval: nothing was written")]
    Unfit,
    /// The file system refuses.
    #[error("{}: cannot write: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it says.
        source: std::io::Error,
    },
}

/// Writes a record in its own format family, generated ones as columns; whole or not at all, through links and devices.
pub fn write(path: &Path, record: &Record) -> Result<(), WriteError> {
    let text = render(record)?;
    let fail = |source: std::io::Error| WriteError::Io { path: path.to_owned(), source };
    crate::files::write_whole(path, text.as_bytes()).map_err(fail)
}

/// The text of a record in its own format family.
pub(crate) fn render(record: &Record) -> Result<String, WriteError> {
    let fit = record.dt > 0.0 && record.acceleration.len() > 1 && record.acceleration.iter().all(|a| a.is_finite());
    if !fit {
        return Err(WriteError::Unfit);
    }
    match record.format {
        Format::Peer => Ok(peer::render(record)),
        Format::Csmip => csmip::render(record),
        Format::Cosmos => Ok(cosmos::render(record)),
        Format::GeoNet => geonet::render(record),
        Format::KNet => Ok(knet::render(record)),
        Format::Columns | Format::Generated => Ok(columns(record)),
    }
}

/// Time and acceleration with their units, every digit of the acceleration kept.
fn columns(record: &Record) -> String {
    let mut text = String::from("time [s],acceleration [m/s2]\n");
    for (k, a) in record.acceleration.iter().enumerate() {
        let _ = writeln!(text, "{:.9},{a}", k as f64 * record.dt);
    }
    text
}

/// What the header says under a key, cut to one line of a width; a stand-in where it says nothing.
fn stated<'a>(record: &'a Record, key: &str, otherwise: &'a str) -> &'a str {
    record.fact(key).filter(|v| !v.is_empty()).unwrap_or(otherwise)
}

/// A decimal number without trailing zeros, three decimals at least.
fn trimmed(value: f64) -> String {
    let text = format!("{value:.12}");
    let keep = text.trim_end_matches('0').len();
    let point = text.find('.').unwrap_or(0);
    text[..keep.max(point + 4).min(text.len())].to_owned()
}

/// Values so many a line.
fn rows(text: &mut String, values: impl Iterator<Item = String>, a_line: usize) {
    let mut count = 0;
    for value in values {
        text.push_str(&value);
        count += 1;
        if count % a_line == 0 {
            text.push('\n');
        }
    }
    if count % a_line != 0 {
        text.push('\n');
    }
}

/// A block of values in columns, with as many decimals as its largest leaves room for.
struct Fixed {
    values: Vec<f64>,
    decimals: usize,
    width: usize,
}

impl Fixed {
    fn new(values: &[f64], scale: f64, width: usize, most: usize) -> Option<Self> {
        let values: Vec<f64> = values.iter().map(|x| x * scale).collect();
        let largest = peak(&values);
        // A sign or a blank before the number.
        let decimals = (0..=most).rev().find(|&d| format!("{largest:.d$}").len() < width)?;
        Some(Self { values, decimals, width })
    }

    fn put(&self, text: &mut String, a_line: usize) {
        let (width, decimals) = (self.width, self.decimals);
        rows(text, self.values.iter().map(|v| format!("{v:width$.decimals$}")), a_line);
    }

    /// The value of largest magnitude and when it comes, s.
    fn peak(&self, dt: f64) -> (String, f64) {
        let at = (0..self.values.len()).max_by(|&a, &b| self.values[a].abs().total_cmp(&self.values[b].abs()));
        let at = at.unwrap_or(0);
        (format!("{:.*}", self.decimals, self.values[at]), at as f64 * dt)
    }
}

/// Acceleration, velocity and displacement of a record in a format's columns, in units of `per_metre` to the metre.
fn blocks(record: &Record, per_metre: f64, width: usize, most: usize) -> Result<[Fixed; 3], WriteError> {
    let motion: Motion = record.motion();
    let fixed = |signal: &[f64], what| {
        Fixed::new(signal, per_metre, width, most).ok_or_else(|| WriteError::TooWide {
            format: record.format,
            what,
            value: peak(signal) * per_metre,
            width,
        })
    };
    Ok([
        fixed(&motion.acceleration, "acceleration")?,
        fixed(&motion.velocity, "velocity")?,
        fixed(&motion.displacement, "displacement")?,
    ])
}

#[cfg(test)]
mod tests;
