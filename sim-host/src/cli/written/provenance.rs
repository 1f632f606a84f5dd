//! What a written drive says of itself, so that nobody mistakes it for the record: where it comes from, what it keeps, what it is true
//! for, and which program made it when.

use super::super::output::sha256;
use super::super::places::file_name;
use super::super::{Failure, asked};
use crate::motion::fit::Limits;
use std::path::Path;

/// A fact: its key and its value.
pub(crate) type Fact = (String, String);

/// Where it comes from: a file, by its name and its digest, or what was made from a seed, 1 where none is stated.
pub(crate) fn source(file: Option<&Path>, made: String, seed: Option<u64>) -> Result<Vec<Fact>, Failure> {
    let Some(path) = file else {
        return Ok(vec![("source".into(), made), ("seed".into(), seed.unwrap_or(1).to_string())]);
    };
    Ok(vec![("source".into(), file_name(path)), ("source_sha256".into(), sha256(path)?)])
}

/// The limits that it keeps, SI.
pub(crate) fn limits(limits: &Limits) -> impl Iterator<Item = Fact> + '_ {
    limits.named().into_iter().filter_map(|(name, limit)| Some((format!("limit_{name}"), limit?.to_string())))
}

/// The table and the controller that a learnt drive was learnt on.
pub(crate) fn learnt_on(table: Option<&Path>, controller: &str, rate: f64) -> Result<[Fact; 2], Failure> {
    let table = table.map_or_else(|| Ok("the paper's table".to_owned()), sha256)?;
    Ok([("model_sha256".into(), table), ("controller".into(), format!("{controller} at {rate} Hz"))])
}

/// Which program wrote it, asked what, and when.
pub(super) fn made() -> [Fact; 3] {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    [("command_line".into(), asked::line()), ("version".into(), version), ("written".into(), asked::utc())]
}
