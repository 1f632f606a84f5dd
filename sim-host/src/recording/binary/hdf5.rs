//! HDF5 and MATLAB 7.3: the one file that knows the library which reads them.
//!
//! Every set of numbers becomes a column: a vector under its path (`run.x`), a matrix as `x(:,2)`. MATLAB stores the transpose of
//! what it shows, and text as numbers, which is passed over. An attribute `unit` or `units` names the unit.

use super::bytes::Flaw;
use super::{Column, Content};
use crate::recording::table::MAX_VALUES;
use hdf5_pure::{AttrValue, DType, Dataset, File, Group};

/// Groups within groups that are followed.
const DEPTH: usize = 8;
/// Most columns of a file.
const MAX_COLUMNS: usize = 10_000;

/// What was found so far.
struct Walk {
    columns: Vec<Column>,
    kept: usize,
    passed_over: Vec<String>,
}

/// Reads a file.
pub fn parse(bytes: Vec<u8>) -> Result<Content, Flaw> {
    let matlab = bytes.starts_with(b"MATLAB 7.3");
    let file = File::from_bytes(bytes).map_err(flaw)?;
    let mut walk = Walk { columns: Vec::new(), kept: 0, passed_over: Vec::new() };
    walk.group(&file.root(), "", 0)?;
    if walk.columns.is_empty() {
        return Err("is HDF5 without a set of numbers".to_owned());
    }
    let mut notes = vec![if matlab { "MATLAB 7.3" } else { "HDF5" }.to_owned()];
    if !walk.passed_over.is_empty() {
        let first = walk.passed_over.iter().take(5).cloned().collect::<Vec<_>>().join(", ");
        notes.push(format!("{} sets that are no numbers were passed over ({first})", walk.passed_over.len()));
    }
    Ok(Content { columns: walk.columns, notes })
}

fn flaw(error: impl std::fmt::Display) -> Flaw {
    let text = error.to_string();
    let text = text.strip_prefix("HDF5 format error: ").unwrap_or(&text);
    format!("is HDF5 that cannot be read ({text}): save it again, or as text")
}

impl Walk {
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Flaw> {
        if depth > DEPTH {
            return Err(format!("is HDF5 with groups nested more than {DEPTH} deep"));
        }
        for name in sorted(group.datasets().map_err(flaw)?) {
            let set = group.dataset(&name).map_err(flaw)?;
            let full = joined(path, &name);
            match self.set(&set, &full) {
                Ok(true) => {}
                Ok(false) => self.passed_over.push(full),
                Err(reason) => return Err(format!("{reason} (`{full}`)")),
            }
        }
        for name in sorted(group.groups().map_err(flaw)?) {
            // MATLAB keeps there what cells point to.
            if !name.starts_with('#') {
                self.group(&group.group(&name).map_err(flaw)?, &joined(path, &name), depth + 1)?;
            }
        }
        Ok(())
    }

    /// Takes a set of numbers; false for everything else.
    fn set(&mut self, set: &Dataset, path: &str) -> Result<bool, Flaw> {
        use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
        let numeric = matches!(set.dtype().map_err(flaw)?, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64);
        let attributes = set.attrs().map_err(flaw)?;
        let text = |key: &str| attributes.get(key).and_then(text_of);
        let class = text("MATLAB_class");
        let empty = attributes.contains_key("MATLAB_empty");
        if !numeric || empty || class.as_deref().is_some_and(|c| matches!(c, "char" | "cell" | "struct")) {
            return Ok(false);
        }
        let shape = set.shape().map_err(flaw)?;
        let count = shape.iter().try_fold(1u64, |n, d| n.checked_mul(*d)).unwrap_or(u64::MAX);
        self.kept = self.kept.saturating_add(usize::try_from(count).unwrap_or(usize::MAX));
        if self.kept > MAX_VALUES {
            return Err(format!("holds more than {MAX_VALUES} values"));
        }
        let unit = text("unit").or_else(|| text("units")).unwrap_or_default();
        let values = numbers(set)?;
        self.columns(path, &unit, &shape, values, class.is_some());
        if self.columns.len() > MAX_COLUMNS {
            return Err(format!("holds more than {MAX_COLUMNS} columns"));
        }
        Ok(true)
    }

    fn columns(&mut self, path: &str, unit: &str, shape: &[u64], values: Vec<f64>, matlab: bool) {
        let long: Vec<usize> = shape.iter().filter(|d| **d > 1).map(|d| *d as usize).collect();
        let [outer, inner] = long[..] else {
            self.columns.push(Column::new(path, unit, values));
            return;
        };
        // MATLAB's columns lie one after the other; elsewhere a row of the set is a sample.
        let count = if matlab { outer } else { inner };
        for k in 0..count.min(MAX_COLUMNS + 1) {
            let part = if matlab {
                values.get(k * inner..(k + 1) * inner).unwrap_or_default().to_vec()
            } else {
                values.iter().skip(k).step_by(inner).copied().collect()
            };
            self.columns.push(Column::new(&format!("{path}(:,{})", k + 1), unit, part));
        }
    }
}

/// The values of a set, whatever their type.
fn numbers(set: &Dataset) -> Result<Vec<f64>, Flaw> {
    fn cast<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(Into::into).collect()
    }
    Ok(match set.dtype().map_err(flaw)? {
        DType::F32 => cast(set.read_f32().map_err(flaw)?),
        DType::I8 => cast(set.read_i8().map_err(flaw)?),
        DType::I16 => cast(set.read_i16().map_err(flaw)?),
        DType::I32 => cast(set.read_i32().map_err(flaw)?),
        DType::U8 => cast(set.read_u8().map_err(flaw)?),
        DType::U16 => cast(set.read_u16().map_err(flaw)?),
        DType::U32 => cast(set.read_u32().map_err(flaw)?),
        DType::I64 => set.read_i64().map_err(flaw)?.into_iter().map(|v| v as f64).collect(),
        DType::U64 => set.read_u64().map_err(flaw)?.into_iter().map(|v| v as f64).collect(),
        _ => set.read_f64().map_err(flaw)?,
    })
}

fn text_of(value: &AttrValue) -> Option<String> {
    match value {
        AttrValue::String(text)
        | AttrValue::AsciiString(text)
        | AttrValue::StringSized { value: text, .. }
        | AttrValue::AsciiStringSized { value: text, .. } => Some(text.trim_end_matches('\0').to_owned()),
        _ => None,
    }
}

fn joined(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}

fn sorted(mut names: Vec<String>) -> Vec<String> {
    names.sort();
    names
}

#[cfg(test)]
mod tests;
