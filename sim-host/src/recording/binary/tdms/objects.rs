//! Objects of a TDMS file: their properties, their raw index, and their values in a chunk.

use super::super::bytes::{Bytes, Flaw, Order, u16_of, u32_of, u64_of};
use super::{MAX_OBJECTS, Value};
use std::collections::BTreeMap;

/// Every object so far, and those whose data the current segment holds.
#[derive(Default)]
pub(super) struct Objects {
    pub(super) all: Vec<Object>,
    pub(super) listed: Vec<usize>,
}

/// A channel, a group or the file.
#[derive(Debug, Clone)]
pub(super) struct Object {
    /// `group/channel`, `group`, or nothing for the file.
    pub(super) path: String,
    pub(super) properties: BTreeMap<String, Value>,
    pub(super) raw: Option<Raw>,
}

/// Where a channel's values lie in a chunk.
#[derive(Debug, Clone)]
pub(super) struct Raw {
    kind: Kind,
    count: usize,
    /// Bytes of strings, which have no size of their own.
    total: Option<usize>,
    pub(super) daqmx: Option<Daqmx>,
}

/// A value's place in a row of a DAQmx buffer.
#[derive(Debug, Clone)]
pub(super) struct Daqmx {
    kind: Kind,
    buffer: usize,
    offset: usize,
    /// One bit of a byte: a digital line.
    bit: Option<usize>,
    widths: Vec<usize>,
}

/// Types of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
    Text,
    Time,
}

impl Kind {
    fn of(code: u32) -> Result<Self, Flaw> {
        Ok(match code {
            1 => Self::I8,
            2 => Self::I16,
            3 => Self::I32,
            4 => Self::I64,
            5 | 0x21 => Self::U8,
            6 => Self::U16,
            7 => Self::U32,
            8 => Self::U64,
            9 | 0x19 => Self::F32,
            10 | 0x1a => Self::F64,
            0x20 => Self::Text,
            0x44 => Self::Time,
            other => return Err(format!("is TDMS with values of type {other:#x}, which are not read")),
        })
    }

    /// Bytes of a value; none for text.
    fn size(self) -> Option<usize> {
        Some(match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
            Self::Time => 16,
            Self::Text => return None,
        })
    }

    fn is_number(self) -> bool {
        !matches!(self, Self::Text | Self::Time)
    }

    fn value(self, bytes: &[u8], order: Order) -> f64 {
        match self {
            Self::I8 => f64::from(bytes.first().copied().unwrap_or(0) as i8),
            Self::U8 => f64::from(bytes.first().copied().unwrap_or(0)),
            Self::I16 => f64::from(u16_of(bytes, order) as i16),
            Self::U16 => f64::from(u16_of(bytes, order)),
            Self::I32 => f64::from(u32_of(bytes, order) as i32),
            Self::U32 => f64::from(u32_of(bytes, order)),
            Self::I64 => u64_of(bytes, order) as i64 as f64,
            Self::U64 => u64_of(bytes, order) as f64,
            Self::F32 => f64::from(f32::from_bits(u32_of(bytes, order))),
            Self::F64 => f64::from_bits(u64_of(bytes, order)),
            Self::Text | Self::Time => f64::NAN,
        }
    }
}

impl Raw {
    /// Bytes of its values in a chunk.
    pub(super) fn bytes(&self) -> Option<usize> {
        match self.kind.size() {
            Some(size) => self.count.checked_mul(size),
            None => self.total,
        }
    }
}

impl Object {
    pub(super) fn number(&self, key: &str) -> Option<f64> {
        self.properties.get(key).and_then(Value::number)
    }

    pub(super) fn text(&self, key: &str) -> Option<&str> {
        match self.properties.get(key) {
            Some(Value::Text(text)) => Some(text),
            _ => None,
        }
    }
}

impl Objects {
    /// Reads a segment's metadata.
    pub(super) fn read(&mut self, bytes: &mut Bytes<'_>, anew: bool) -> Result<(), Flaw> {
        if anew {
            self.listed.clear();
        }
        for _ in 0..bytes.u32()? {
            let path = plain(&text(bytes)?);
            let index = self.all.iter().position(|o| o.path == path);
            let index = index.unwrap_or_else(|| {
                self.all.push(Object { path, properties: BTreeMap::new(), raw: None });
                self.all.len() - 1
            });
            if self.all.len() > MAX_OBJECTS {
                return Err(format!("is TDMS with more than {MAX_OBJECTS} objects"));
            }
            match index_of(bytes)? {
                Index::None => self.listed.retain(|i| *i != index),
                Index::Same => self.list(index),
                Index::New(raw) => {
                    self.all[index].raw = Some(raw);
                    self.list(index);
                }
            }
            for _ in 0..bytes.u32()? {
                let (key, value) = property(bytes)?;
                if let Some(value) = value {
                    self.all[index].properties.insert(key, value);
                }
            }
        }
        Ok(())
    }

    fn list(&mut self, index: usize) {
        if !self.listed.contains(&index) {
            self.listed.push(index);
        }
    }
}

/// A text with its length before it.
fn text(bytes: &mut Bytes<'_>) -> Result<String, Flaw> {
    let length = bytes.u32()? as usize;
    Ok(String::from_utf8_lossy(bytes.take(length)?).into_owned())
}

/// `/'group'/'channel'` without slashes and quotation marks at its ends.
fn plain(path: &str) -> String {
    let path = path.trim_start_matches('/');
    let path = path.strip_prefix('\'').and_then(|p| p.strip_suffix('\'')).unwrap_or(path);
    path.split("'/'").map(|part| part.replace("''", "'")).collect::<Vec<_>>().join("/")
}

/// An object's raw index in a segment.
enum Index {
    None,
    Same,
    New(Raw),
}

fn index_of(bytes: &mut Bytes<'_>) -> Result<Index, Flaw> {
    let length = bytes.u32()?;
    match length {
        0xffff_ffff => return Ok(Index::None),
        0 => return Ok(Index::Same),
        _ => {}
    }
    let code = bytes.u32()?;
    if bytes.u32()? != 1 {
        return Err("is TDMS with values of several dimensions, which are not read".to_owned());
    }
    let count = bytes.u64()?;
    let count = usize::try_from(count).map_err(|_| format!("is TDMS with {count} values in a chunk"))?;
    if length == 0x1269 || length == 0x126a {
        let daqmx = daqmx_index(bytes, length == 0x126a)?;
        return Ok(Index::New(Raw { kind: daqmx.kind, count, total: None, daqmx: Some(daqmx) }));
    }
    let kind = Kind::of(code)?;
    let total = if kind == Kind::Text { usize::try_from(bytes.u64()?).ok() } else { None };
    Ok(Index::New(Raw { kind, count, total, daqmx: None }))
}

/// The scalers of a DAQmx channel, of which there must be one, and the widths of the buffers' rows.
fn daqmx_index(bytes: &mut Bytes<'_>, digital: bool) -> Result<Daqmx, Flaw> {
    let scalers = bytes.u32()?;
    if scalers != 1 {
        return Err(format!(
            "is TDMS with a DAQmx channel of {scalers} scalers: one is read; export it as TDMS without raw DAQmx data"
        ));
    }
    let (code, buffer, offset) = (bytes.u32()?, bytes.u32()? as usize, bytes.u32()? as usize);
    bytes.take(if digital { 1 } else { 4 })?;
    bytes.u32()?;
    let kind = match code {
        0 => Kind::U8,
        1 => Kind::I8,
        2 => Kind::U16,
        3 => Kind::I16,
        4 => Kind::U32,
        5 => Kind::I32,
        other => return Err(format!("is TDMS with DAQmx values of type {other}, which are not read")),
    };
    let buffers = bytes.u32()?;
    let widths = (0..buffers).map(|_| Ok(bytes.u32()? as usize)).collect::<Result<Vec<usize>, Flaw>>()?;
    let (offset, bit) = if digital { (offset / 8, Some(offset % 8)) } else { (offset, None) };
    let size = kind.size().unwrap_or(0);
    if widths.get(buffer).is_none_or(|width| offset + size > *width) {
        return Err("is TDMS with a DAQmx channel beyond its buffer".to_owned());
    }
    Ok(Daqmx { kind, buffer, offset, bit, widths })
}

/// A property; none where its kind is of no use here.
fn property(bytes: &mut Bytes<'_>) -> Result<(String, Option<Value>), Flaw> {
    let key = text(bytes)?;
    let kind = Kind::of(bytes.u32()?)?;
    if kind == Kind::Text {
        return Ok((key, Some(Value::Text(text(bytes)?))));
    }
    if kind == Kind::Time {
        // Little-endian: the fraction first; the other way round: the seconds first.
        let (first, second) = (bytes.u64()?, bytes.u64()?);
        let (fraction, seconds) = if bytes.order() == Order::Little { (first, second) } else { (second, first) };
        return Ok((key, Some(Value::Time(seconds as i64 as f64 + fraction as f64 / 2f64.powi(64)))));
    }
    let order = bytes.order();
    let raw = bytes.take(kind.size().unwrap_or(0))?;
    Ok((key, Some(Value::Number(kind.value(raw, order)))))
}

/// Channel after channel.
pub(super) fn contiguous(
    chunk: &[u8],
    listed: &[(usize, &Object, &Raw)],
    order: Order,
    values: &mut BTreeMap<usize, Vec<f64>>,
) {
    let mut at = 0;
    for (index, _, raw) in listed {
        let length = raw.bytes().unwrap_or(0);
        let bytes = chunk.get(at..at + length).unwrap_or_default();
        at += length;
        if let Some(size) = raw.kind.size().filter(|_| raw.kind.is_number()) {
            values.entry(*index).or_default().extend(bytes.chunks_exact(size).map(|b| raw.kind.value(b, order)));
        }
    }
}

/// A value of each channel in turn.
pub(super) fn interleaved(
    chunk: &[u8],
    listed: &[(usize, &Object, &Raw)],
    order: Order,
    values: &mut BTreeMap<usize, Vec<f64>>,
) -> Result<(), Flaw> {
    let sizes: Option<Vec<usize>> = listed.iter().map(|(_, _, raw)| raw.kind.size()).collect();
    let sizes = sizes.ok_or_else(|| "is TDMS with interleaved text, which is not read".to_owned())?;
    let width: usize = sizes.iter().sum();
    for row in chunk.chunks_exact(width.max(1)) {
        let mut at = 0;
        for ((index, _, raw), size) in listed.iter().zip(&sizes) {
            if raw.kind.is_number() {
                values.entry(*index).or_default().push(raw.kind.value(&row[at..at + size], order));
            }
            at += size;
        }
    }
    Ok(())
}

/// Bytes of a chunk of DAQmx buffers.
pub(super) fn daqmx_chunk(listed: &[(usize, &Object, &Raw)]) -> Option<usize> {
    let first = listed.first()?.2;
    let widths = &first.daqmx.as_ref()?.widths;
    widths.iter().try_fold(0usize, |n, width| n.checked_add(width.checked_mul(first.count)?))
}

/// Rows of DAQmx buffers, each row with a value of every channel.
pub(super) fn daqmx(
    chunk: &[u8],
    listed: &[(usize, &Object, &Raw)],
    order: Order,
    values: &mut BTreeMap<usize, Vec<f64>>,
) -> Result<(), Flaw> {
    let mixed = || "is TDMS with DAQmx channels of several lengths in one segment, which are not read".to_owned();
    let count = listed.first().map_or(0, |(_, _, raw)| raw.count);
    for (index, _, raw) in listed {
        let at = raw.daqmx.as_ref().filter(|_| raw.count == count).ok_or_else(mixed)?;
        let start: usize = at.widths.iter().take(at.buffer).map(|width| width * count).sum();
        let width = at.widths.get(at.buffer).copied().unwrap_or(1);
        let buffer = chunk.get(start..start + width * count).ok_or_else(mixed)?;
        let value = |row: &[u8]| {
            let value = at.kind.value(row.get(at.offset..).unwrap_or_default(), order);
            at.bit.map_or(value, |bit| f64::from((value as i64 >> bit & 1) as i32))
        };
        values.entry(*index).or_default().extend(buffer.chunks_exact(width).map(value));
    }
    Ok(())
}
