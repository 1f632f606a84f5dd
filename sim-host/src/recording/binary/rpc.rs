//! MTS RPC III time histories (`.rpc .rsp .tim .drv`), read and written.
//!
//! Source: MTS, "RPC File Formats". A header of blocks of 512 bytes, four records each: a key of 32 bytes and a value of 96, both
//! ended by NUL. Then, group by group and channel by channel, `PTS_PER_GROUP` points; the last group is whole, filled up. A value
//! is the raw number times the channel's `SCALE`. How many points are true is not stored.

use super::bytes::{Flaw, Order, u16_of, u32_of};
use super::{Column, Content};
use std::collections::BTreeMap;

mod write;

pub(crate) use write::{Points, RpcChannel, RpcError, render};

/// Bytes of a record of the header: a key of [`KEY`] bytes and a value.
const RECORD: usize = 128;
/// Bytes of a key.
const KEY: usize = 32;
/// Bytes of a block of the header.
const BLOCK: usize = 512;
/// Most blocks of a header that are believed.
const MAX_BLOCKS: usize = 256;
/// Most channels that are believed.
const MAX_CHANNELS: usize = 256;

/// A header's values by key.
struct Header {
    values: BTreeMap<String, String>,
    /// Where the data begin, bytes.
    data: usize,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Flaw> {
        let second = record(bytes, 1)?;
        if second.0 != "NUM_HEADER_BLOCKS" {
            return Err("is no RPC III file: its second record is not NUM_HEADER_BLOCKS".to_owned());
        }
        let blocks = whole(&second.1, "NUM_HEADER_BLOCKS")?;
        if !(1..=MAX_BLOCKS).contains(&blocks) {
            return Err(format!("is RPC III with NUM_HEADER_BLOCKS = {blocks}: expected 1 to {MAX_BLOCKS}"));
        }
        let records = blocks * BLOCK / RECORD;
        let mut values = BTreeMap::new();
        for i in 0..records {
            let (key, value) = record(bytes, i)?;
            if !key.is_empty() {
                values.entry(key).or_insert(value);
            }
        }
        Ok(Self { values, data: blocks * BLOCK })
    }

    fn text(&self, key: &str) -> Option<&str> {
        self.values.get(key).map(String::as_str).filter(|v| !v.is_empty())
    }

    fn required(&self, key: &str) -> Result<&str, Flaw> {
        self.text(key).ok_or_else(|| format!("is RPC III without {key}: write the file again"))
    }

    fn whole(&self, key: &str) -> Result<usize, Flaw> {
        whole(self.required(key)?, key)
    }

    fn number(&self, key: &str) -> Result<f64, Flaw> {
        let text = self.required(key)?;
        let value = text.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| format!("is RPC III with {key} = `{text}`: expected a number"))
    }

    /// Refuses a key whose value is none of these.
    fn one_of(&self, key: &str, otherwise: &'static str, known: &[&'static str]) -> Result<&'static str, Flaw> {
        let value = self.text(key).unwrap_or(otherwise);
        let found = known.iter().find(|k| k.eq_ignore_ascii_case(value));
        found.copied().ok_or_else(|| format!("is RPC III with {key} = `{value}`: expected {}", known.join(", ")))
    }
}

fn whole(text: &str, key: &str) -> Result<usize, Flaw> {
    text.trim().parse().map_err(|_| format!("is RPC III with {key} = `{text}`: expected a whole number"))
}

/// One record of the header; Windows-1252, ended by NUL.
fn record(bytes: &[u8], index: usize) -> Result<(String, String), Flaw> {
    let record = bytes.get(index * RECORD..(index + 1) * RECORD);
    let record = record.ok_or_else(|| "is cut off within its RPC III header".to_owned())?;
    let text = |part: &[u8]| {
        let end = part.iter().position(|b| *b == 0).unwrap_or(part.len());
        crate::files::layout::decode(&part[..end], crate::files::layout::Encoding::Windows1252).trim().to_owned()
    };
    Ok((text(&record[..KEY]), text(&record[KEY..])))
}

/// How the points lie in the file.
struct Shape {
    order: Order,
    float: bool,
    channels: usize,
    points: usize,
    per_group: usize,
    dt: f64,
}

impl Shape {
    fn read(header: &Header) -> Result<Self, Flaw> {
        const FORMATS: [&str; 4] = ["BINARY_IEEE_LITTLE_END", "BINARY", "BINARY_IEEE_BIG_END", "ASCII"];
        let format = header.one_of("FORMAT", "", &FORMATS)?;
        if format == "ASCII" {
            return Err("is RPC III in ASCII: write it as BINARY_IEEE_LITTLE_END".to_owned());
        }
        header.one_of("FILE_TYPE", "TIME_HISTORY", &["TIME_HISTORY"])?;
        let float =
            header.one_of("DATA_TYPE", "SHORT_INTEGER", &["SHORT_INTEGER", "FLOATING_POINT"])? == "FLOATING_POINT";
        if header.text("HALF_FRAMES").is_some_and(|v| v != "0") {
            return Err("is RPC III with HALF_FRAMES: write it without them".to_owned());
        }
        let dt = header.number("DELTA_T")?;
        if !(1e-7..=10.0).contains(&dt) {
            return Err(format!("is RPC III with DELTA_T = {dt:e} s: expected 1e-7 to 10"));
        }
        let (frame, frames) = (header.whole("PTS_PER_FRAME")?, header.whole("FRAMES")?);
        let per_group = if header.text("PTS_PER_GROUP").is_some() { header.whole("PTS_PER_GROUP")? } else { frame };
        let channels = header.whole("CHANNELS")?;
        if !(1..=MAX_CHANNELS).contains(&channels) {
            return Err(format!("is RPC III with CHANNELS = {channels}: expected 1 to {MAX_CHANNELS}"));
        }
        let points = frame.checked_mul(frames).filter(|n| *n > 0 && per_group > 0);
        let points = points
            .ok_or_else(|| "is RPC III without points: PTS_PER_FRAME, PTS_PER_GROUP or FRAMES is 0".to_owned())?;
        let order = if format == "BINARY_IEEE_BIG_END" { Order::Big } else { Order::Little };
        Ok(Self { order, float, channels, points, per_group, dt })
    }

    /// Bytes of a point.
    fn size(&self) -> usize {
        if self.float { 4 } else { 2 }
    }

    /// The raw points of a channel, from 0.
    fn raw(&self, data: &[u8], channel: usize) -> Result<Vec<f64>, Flaw> {
        let groups = self.points.div_ceil(self.per_group);
        let bytes = self.per_group.checked_mul(self.size()).and_then(|n| n.checked_mul(self.channels * groups));
        if bytes.is_none_or(|n| n > data.len()) {
            let expected = bytes.map_or_else(|| "more".to_owned(), |n| n.to_string());
            return Err(format!("is RPC III cut off: {expected} bytes of data are expected, {} are there", data.len()));
        }
        let length = self.per_group * self.size();
        let starts = (0..groups).map(|group| (group * self.channels + channel) * length);
        let points = starts.flat_map(|start| data[start..start + length].chunks_exact(self.size()));
        let value = |bytes: &[u8]| {
            if self.float {
                f64::from(f32::from_bits(u32_of(bytes, self.order)))
            } else {
                f64::from(u16_of(bytes, self.order) as i16)
            }
        };
        Ok(points.take(self.points).map(value).collect())
    }
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Content, Flaw> {
    let header = Header::read(bytes)?;
    let shape = Shape::read(&header)?;
    let data = bytes.get(header.data..).unwrap_or_default();
    let time = (0..shape.points).map(|k| k as f64 * shape.dt).collect();
    let mut columns = vec![Column::new("time", "s", time)];
    for n in 1..=shape.channels {
        let scale = if shape.float && header.text(&format!("SCALE.CHAN_{n}")).is_none() {
            1.0
        } else {
            header.number(&format!("SCALE.CHAN_{n}"))?
        };
        let mut values = shape.raw(data, n - 1)?;
        for v in &mut values {
            *v *= scale;
        }
        let name = header.text(&format!("DESC.CHAN_{n}")).map_or_else(|| format!("channel {n}"), str::to_owned);
        let taken = columns.iter().any(|c: &Column| c.heading.name == name);
        let name = if taken { format!("{name} (channel {n})") } else { name };
        columns.push(Column::new(&name, header.text(&format!("UNITS.CHAN_{n}")).unwrap_or_default(), values));
    }
    let kind = header.text("TIME_TYPE").unwrap_or("time history");
    let mut notes = vec![format!(
        "RPC III, {kind}: {} points every {} s; how many of the last frame are true is not stored",
        shape.points, shape.dt
    )];
    notes.extend(header.text("PARENT_1").map(|parent| format!("made from {parent}")));
    notes.extend(header.text("OPERATION").map(|what| format!("operation: {what}")));
    Ok(Content { columns, notes })
}

#[cfg(test)]
mod tests;
