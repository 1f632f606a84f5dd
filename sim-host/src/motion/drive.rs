//! Drives: what a table is told to do, written for a controller and played as it is.
//!
//! A drive carries its provenance (source and its SHA-256, limits, options, version), and a file of one can not be treated as a
//! record: the record readers refuse it by its first line. Forms: CSV (`# key = value`, then `time [s],displacement [mm]`), RPC III
//! with the facts in a TOML file beside it, and PEER AT2 for acceleration.

pub(super) mod form;
mod rest;
mod text;

pub(crate) use form::{DriveUnit, Form, Quantity};
use form::{OPERATION, is_first_line};

use super::record::central_difference;
use super::{Motion, peak, read};
use crate::files::bounded;
use crate::recording::binary::rpc::{self, RpcChannel, RpcError};
use std::path::{Path, PathBuf};

/// What a table is told to do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drive {
    /// What its values are.
    pub quantity: Quantity,
    /// Sampling interval, s.
    pub dt: f64,
    /// Displacement, m, or acceleration, m/s2.
    pub values: Vec<f64>,
    /// The unit that the file's values are in.
    pub unit: DriveUnit,
    /// Where it comes from: keys and values in the order they were written.
    pub facts: Vec<(String, String)>,
}

/// Why a drive was not written or not read.
#[derive(Debug, thiserror::Error)]
pub(crate) enum DriveError {
    /// The file system refuses.
    #[error("{}: {cause}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What it says.
        cause: std::io::Error,
    },
    /// The form does not hold it.
    #[error("{}: {problem}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong and the remedy.
        problem: String,
    },
}

impl DriveError {
    fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), problem: problem.into() }
    }

    /// True where the file system is to blame and not the file.
    pub(crate) fn is_io(&self) -> bool {
        matches!(self, Self::Io { .. })
    }
}

impl Drive {
    /// The drive that a fitted motion is, at `rate_hz`, or at its own rate. Its acceleration is linear between samples, so a
    /// displacement between them is exact.
    pub(crate) fn of(motion: &Motion, quantity: Quantity, unit: DriveUnit, rate_hz: Option<f64>) -> Self {
        let dt = rate_hz.map_or(motion.dt, |rate| 1.0 / rate);
        let last = motion.len().saturating_sub(1);
        let count = (motion.duration() / dt + 1e-9).floor() as usize + 1;
        let at = |k: usize| {
            let t = k as f64 * dt / motion.dt;
            let i = ((t + 1e-9).floor() as usize).min(last);
            let (share, next) = ((t - i as f64).max(0.0), (i + 1).min(last));
            (i, next, share)
        };
        let displacement = |k: usize| {
            let (i, next, share) = at(k);
            // Acceleration is linear between samples, as `Motion` has it.
            let (tau, a, b) = (share * motion.dt, motion.acceleration[i], motion.acceleration[next]);
            motion.displacement[i] + tau * (motion.velocity[i] + tau * (a / 2.0 + share * (b - a) / 6.0))
        };
        let acceleration = |k: usize| {
            let (i, next, share) = at(k);
            motion.acceleration[i] + share * (motion.acceleration[next] - motion.acceleration[i])
        };
        let values = match quantity {
            Quantity::Displacement => (0..count).map(displacement).collect(),
            Quantity::Acceleration => (0..count).map(acceleration).collect(),
        };
        Self { quantity, dt, values, unit, facts: Vec::new() }
    }

    /// The motion that it asks for.
    pub(crate) fn motion(&self) -> Motion {
        match self.quantity {
            Quantity::Acceleration => Motion::from_acceleration(self.dt, self.values.clone()),
            Quantity::Displacement => {
                let velocity = central_difference(&self.values, self.dt);
                let x = |k: usize| self.values.get(k).copied().unwrap_or(0.0);
                let second = |k: usize| {
                    let k = k.clamp(1, self.values.len().saturating_sub(2).max(1));
                    (x(k + 1) - 2.0 * x(k) + x(k - 1)) / (self.dt * self.dt)
                };
                let acceleration = (0..self.values.len()).map(second).collect();
                Motion { dt: self.dt, displacement: self.values.clone(), velocity, acceleration }
            }
        }
    }

    /// A fact by its key.
    pub(crate) fn fact(&self, key: &str) -> Option<&str> {
        self.facts.iter().find(|(k, _)| k == key).map(|(_, value)| value.as_str())
    }

    /// The size of one step of sixteen bits in RPC III, m or m/s2, and the RMS of what it adds to the second difference, m/s2.
    pub(crate) fn rpc_resolution(&self) -> (f64, f64) {
        let step = peak(&self.values) / 32_752.0;
        (step, step / 12f64.sqrt() * 6f64.sqrt() / (self.dt * self.dt))
    }

    /// Writes it in the form that the file's name says; whole or not at all.
    pub(crate) fn write(&self, path: &Path, form: Form) -> Result<(), DriveError> {
        let io = |path: &Path, bytes: &[u8]| {
            crate::files::write_whole(path, bytes).map_err(|cause| DriveError::Io { path: path.to_owned(), cause })
        };
        if self.values.len() < 2 || self.values.iter().any(|v| !v.is_finite()) {
            return Err(DriveError::content(
                path,
                "a drive needs at least two values, all finite: nothing was written",
            ));
        }
        match form {
            Form::Csv => io(path, text::csv(self).as_bytes()),
            Form::Peer => io(path, text::peer(self).as_bytes()),
            Form::Rpc(stored) => {
                let values = self.values.iter().map(|v| v / self.unit.in_si).collect();
                let channel = RpcChannel { name: self.quantity.name().into(), unit: self.unit.symbol.clone(), values };
                let facts = [("OPERATION", OPERATION), ("PARENT_1", self.fact("source").unwrap_or_default())];
                let facts = facts.map(|(key, value)| (key.to_owned(), value.to_owned()));
                let bytes = rpc::render(self.dt, &[channel], &facts, stored)
                    .map_err(|e: RpcError| DriveError::content(path, e.to_string()))?;
                io(&beside(path), text::toml(self).as_bytes())?;
                io(path, &bytes)
            }
        }
    }

    /// Reads a drive; none where the file is something else.
    pub(crate) fn read(path: &Path) -> Result<Option<Self>, DriveError> {
        let Ok(bytes) = bounded::bytes(path, read::SIZE_LIMIT) else { return Ok(None) };
        if bytes.starts_with(b"FORMAT\0") {
            return from_rpc(path, &bytes);
        }
        let line = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
        let line = String::from_utf8_lossy(line);
        if !is_first_line(&line) {
            return Ok(None);
        }
        let drive = if line.starts_with('#') { text::read_csv(path, &bytes)? } else { text::read_peer(path, bytes)? };
        Ok(Some(drive))
    }
}

/// The file of facts beside an RPC III drive.
fn beside(path: &Path) -> PathBuf {
    path.with_extension("toml")
}

fn from_rpc(path: &Path, bytes: &[u8]) -> Result<Option<Drive>, DriveError> {
    let content = rpc::parse(bytes).map_err(|flaw| DriveError::content(path, flaw))?;
    if !content.notes.iter().any(|note| note.contains(OPERATION)) {
        return Ok(None);
    }
    let facts = bounded::text(&beside(path), bounded::BY_HAND).map_err(|e| {
        DriveError::content(
            path,
            format!("its facts in {} cannot be read ({e}): keep both files together", beside(path).display()),
        )
    })?;
    let facts = text::read_toml(&facts).map_err(|e| DriveError::content(&beside(path), e))?;
    let [time, values] = &content.columns[..] else {
        return Err(DriveError::content(path, "holds several channels: a drive has one"));
    };
    let dt = time.values.get(1).copied().unwrap_or(0.0);
    let (quantity, unit) = text::stated(&facts).map_err(|e| DriveError::content(&beside(path), e))?;
    if values.heading.unit.as_deref() != Some(unit.symbol.as_str()) {
        let problem = format!("is not in the unit that {} states ({})", beside(path).display(), unit.symbol);
        return Err(DriveError::content(path, problem));
    }
    let mut values: Vec<f64> = values.values.iter().map(|v| v * unit.in_si).collect();
    // What fills the last frame is none of the drive.
    values.truncate(text::count(&facts).map_err(|e| DriveError::content(&beside(path), e))?);
    Ok(Some(Drive { quantity, dt, values, unit, facts }))
}

#[cfg(test)]
mod tests;
