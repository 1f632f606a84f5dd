//! Recordings as MATLAB v5 files (`save` up to `-v7`), the form of the EMPS data and of `dSPACE` recorders.
//!
//! Every numeric variable becomes a column: a vector under its name, a matrix as `name(:,2)`, a field of a structure as
//! `rec.Y(3).Data`, which may also be called by the `Name` that stands beside it, as `dSPACE` writes it. Own code, because
//! the crates at hand read no structures and set no limit on what a compressed variable may unfold to; memory is
//! bounded here by [`MAX_VALUES`] values and [`MAX_ELEMENT`] bytes for one variable.
//!
//! Source: The `MathWorks`, "MAT-File Format", the Level 5 chapters.

use super::binary::{Column, pick};
use super::error::{Place, Problem, RecordingError};
use super::table::{Heading, MAX_BYTES, MAX_VALUES, Table};
use super::unit::Unit;
use element::Order;
use flate2::read::ZlibDecoder;
use matrix::{Node, Values};
use std::io::{BufReader, Read};
use std::path::Path;

mod element;
mod matrix;

/// Largest variable that is read, bytes once decompressed.
const MAX_ELEMENT: usize = 8 * MAX_VALUES + (1 << 16);

/// Most columns that a file may unfold to.
const MAX_COLUMNS: usize = 10_000;

/// What is wrong with a file's bytes, in words.
type Flaw = String;

/// Reads the names of all columns.
pub fn headings(input: impl Read, path: &Path) -> Result<Vec<Heading>, RecordingError> {
    Ok(columns(input, path)?.into_iter().map(|c| c.heading).collect())
}

/// Reads the wanted columns, each named as the module describes; `path` is for messages.
pub fn read(input: impl Read, path: &Path, wanted: &[&str]) -> Result<Table, RecordingError> {
    pick(columns(input, path)?, Vec::new(), path, wanted)
}

fn columns(input: impl Read, path: &Path) -> Result<Vec<Column>, RecordingError> {
    let mut input = BufReader::new(input.take(MAX_BYTES as u64));
    let malformed = |flaw: Flaw| Place::file(path).refuse(Problem::Malformed(flaw));
    let order = header(&mut input).map_err(malformed)?;
    let mut columns = Vec::new();
    let mut kept = 0;
    while let Some(variable) = next_variable(&mut input, order).map_err(malformed)? {
        let (name, node) = variable;
        unfold(&name, &node, &mut columns);
        kept += node.len();
        if kept > MAX_VALUES {
            return Err(Place::file(path).refuse(Problem::TooLarge { what: "values", limit: MAX_VALUES }));
        }
        if columns.len() > MAX_COLUMNS {
            return Err(Place::file(path).refuse(Problem::TooLarge { what: "columns", limit: MAX_COLUMNS }));
        }
    }
    Ok(columns)
}

/// The 128 bytes at the start; gives the order of bytes.
fn header(input: &mut impl Read) -> Result<Order, Flaw> {
    let mut bytes = [0; 128];
    input.read_exact(&mut bytes).map_err(|_| "is no MATLAB v5 file: it ends within its header".to_owned())?;
    match &bytes[126..128] {
        b"IM" => Ok(Order::Little),
        b"MI" => Ok(Order::Big),
        _ => Err("is no MATLAB v5 file; save it with `-v7`".to_owned()),
    }
}

/// The next variable of the file, with its name; none at the end.
fn next_variable(input: &mut impl Read, order: Order) -> Result<Option<(String, Node)>, Flaw> {
    loop {
        let mut tag = [0; 8];
        if !filled(input, &mut tag)? {
            return Ok(None);
        }
        let (kind, size) = (order.u32(&tag[..4]), order.u32(&tag[4..]) as usize);
        let bytes = match kind {
            element::COMPRESSED => decompressed(input, size, order)?,
            element::MATRIX => exactly(input, size)?,
            // Nothing else stands outside a variable; it is passed over.
            _ => {
                exactly(input, size)?;
                continue;
            }
        };
        return matrix::parse(&bytes, order).map(Some);
    }
}

/// Fills the buffer; false where the file ends before it, which may only be at its first byte.
fn filled(input: &mut impl Read, buffer: &mut [u8]) -> Result<bool, Flaw> {
    let mut bytes = Vec::new();
    let limit = buffer.len();
    input.take(limit as u64).read_to_end(&mut bytes).map_err(|e| format!("cannot be read: {e}"))?;
    match bytes.len() {
        0 => Ok(false),
        n if n == limit => {
            buffer.copy_from_slice(&bytes);
            Ok(true)
        }
        _ => Err("is cut off in the middle of a variable".to_owned()),
    }
}

fn exactly(input: &mut impl Read, size: usize) -> Result<Vec<u8>, Flaw> {
    if size > MAX_ELEMENT {
        return Err(format!("holds a variable of {size} bytes; at most {MAX_ELEMENT} are read"));
    }
    // The buffer grows with what is there, not with what the tag claims.
    let mut bytes = Vec::new();
    input.take(size as u64).read_to_end(&mut bytes).map_err(|e| format!("cannot be read: {e}"))?;
    if bytes.len() < size {
        return Err("is cut off in the middle of a variable".to_owned());
    }
    Ok(bytes)
}

/// A compressed element holds one matrix, tag and all; gives the matrix's bytes without the tag.
fn decompressed(input: &mut impl Read, size: usize, order: Order) -> Result<Vec<u8>, Flaw> {
    let packed = exactly(input, size)?;
    let mut bytes = Vec::new();
    let unpacked = ZlibDecoder::new(packed.as_slice()).take(MAX_ELEMENT as u64 + 1).read_to_end(&mut bytes);
    unpacked.map_err(|e| format!("holds a variable that cannot be decompressed: {e}"))?;
    if bytes.len() > MAX_ELEMENT {
        return Err(format!("holds a variable of more than {MAX_ELEMENT} bytes"));
    }
    if bytes.len() < 8 || order.u32(&bytes[..4]) != element::MATRIX {
        return Err("holds a compressed variable that is no array".to_owned());
    }
    Ok(bytes.split_off(8))
}

/// Turns a variable into columns.
fn unfold(name: &str, node: &Node, columns: &mut Vec<Column>) {
    match node {
        Node::Numbers(values) => unfold_numbers(name, None, values, columns),
        Node::Text(_) | Node::Other => {}
        Node::Cells(cells) => {
            for (i, cell) in cells.iter().enumerate() {
                unfold(&format!("{name}{{{}}}", i + 1), cell, columns);
            }
        }
        Node::Structures(elements) => {
            for (i, fields) in elements.iter().enumerate() {
                let path = if elements.len() == 1 { name.to_owned() } else { format!("{name}({})", i + 1) };
                unfold_fields(&path, fields, columns);
            }
        }
    }
}

fn unfold_fields(path: &str, fields: &[(String, Node)], columns: &mut Vec<Column>) {
    let text = |key: &str| {
        fields.iter().find_map(|(name, node)| match node {
            Node::Text(text) if name.eq_ignore_ascii_case(key) => Some(text.trim().to_owned()),
            _ => None,
        })
    };
    for (field, node) in fields {
        let full = format!("{path}.{field}");
        match (node, text("name").filter(|n| !n.is_empty())) {
            (Node::Numbers(values), Some(name)) if field.eq_ignore_ascii_case("data") => {
                let unit = text("unit").filter(|u| Unit::in_header(u).is_some());
                unfold_numbers(&full, Some((name, unit)), values, columns);
            }
            _ => unfold(&full, node, columns),
        }
    }
}

fn unfold_numbers(path: &str, called: Option<(String, Option<String>)>, values: &Values, columns: &mut Vec<Column>) {
    let (name, unit) = called.unwrap_or_else(|| (path.to_owned(), None));
    let vector = values.rows <= 1 || values.columns <= 1;
    if vector {
        let heading = Heading { text: path.to_owned(), name, unit };
        columns.push(Column { heading, values: values.data.clone() });
        return;
    }
    for (k, column) in values.data.chunks_exact(values.rows).enumerate().take(MAX_COLUMNS + 1) {
        let part = |of: &str| format!("{of}(:,{})", k + 1);
        let heading = Heading { text: part(path), name: part(&name), unit: unit.clone() };
        columns.push(Column { heading, values: column.to_vec() });
    }
}

#[cfg(test)]
mod tests;
