//! NI TDMS files, as LabVIEW writes them: segments of metadata and raw data.
//!
//! A segment begins with `TDSm`, a mask (1 metadata, 2 new object list, 3 raw data, 5 interleaved, 6 big-endian, 7 DAQmx), the version
//! and the offsets of the next segment and of its raw data. Objects keep their raw index from segment to segment; a segment
//! holds as many chunks as its raw data have room for. Strings and timestamps are passed over, what `NI_Scale` states is applied.

use super::bytes::{Bytes, Flaw, Order};
use super::{Column, Content};
use objects::{Object, Objects, Raw};
use std::collections::BTreeMap;

mod objects;
mod scale;

/// Most objects of a file.
const MAX_OBJECTS: usize = 10_000;

/// A property's value, as far as it is used.
#[derive(Debug, Clone, PartialEq)]
enum Value {
    Number(f64),
    Text(String),
    /// Seconds since 1904.
    Time(f64),
}

impl Value {
    fn number(&self) -> Option<f64> {
        match self {
            Self::Number(value) | Self::Time(value) => Some(*value),
            Self::Text(_) => None,
        }
    }
}

/// Bits of a segment's mask.
struct Mask(u32);

impl Mask {
    fn has(&self, bit: u32) -> bool {
        self.0 & (1 << bit) != 0
    }
}

/// What a file holds, object by object in the order they came.
#[derive(Default)]
struct Content0 {
    /// Values of each channel.
    values: BTreeMap<usize, Vec<f64>>,
    notes: Vec<String>,
}

/// Reads a file.
pub fn parse(bytes: &[u8]) -> Result<Content, Flaw> {
    let mut objects = Objects::default();
    let mut content = Content0::default();
    let mut at = 0;
    while at < bytes.len() {
        at = segment(bytes, at, &mut objects, &mut content)?;
    }
    columns(&objects, content)
}

/// Reads the segment at a place; gives where the next one begins.
fn segment(bytes: &[u8], at: usize, objects: &mut Objects, content: &mut Content0) -> Result<usize, Flaw> {
    let mut lead = Bytes::new(bytes, Order::Little);
    lead.seek(at)?;
    if lead.take(4)? != b"TDSm" {
        return Err(format!("is no TDMS file, or a damaged one: no segment begins at byte {at}"));
    }
    let mask = Mask(lead.u32()?);
    let order = if mask.has(6) { Order::Big } else { Order::Little };
    let mut lead = lead.ordered(order);
    let version = lead.u32()?;
    if !(4712..=4713).contains(&version) {
        return Err(format!("is TDMS version {version}: expected 4712 or 4713"));
    }
    let (next, raw) = (lead.u64()?, lead.u64()?);
    let start = lead.position();
    let end = if next == u64::MAX {
        Some(bytes.len())
    } else {
        usize::try_from(next).ok().and_then(|n| start.checked_add(n))
    };
    let data = usize::try_from(raw).ok().and_then(|n| start.checked_add(n));
    let (Some(end), Some(data)) = (end, data.filter(|d| *d <= bytes.len())) else {
        return Err(format!("is TDMS with a segment at byte {at} that lies beyond its end"));
    };
    if end > bytes.len() || next == u64::MAX {
        content.notes.push("the last segment was cut off while it was written: whole chunks of it are read".to_owned());
    }
    let end = end.min(bytes.len());
    if mask.has(1) {
        objects.read(&mut lead, mask.has(2))?;
    }
    if mask.has(3) && data <= end {
        chunks(&bytes[data..end], &mask, order, objects, content)?;
    }
    // A segment never ends before its own lead-in.
    Ok(end.max(start))
}

/// Reads every chunk of a segment's raw data.
fn chunks(raw: &[u8], mask: &Mask, order: Order, objects: &Objects, content: &mut Content0) -> Result<(), Flaw> {
    let listed: Vec<(usize, &Object, &Raw)> =
        objects.listed.iter().filter_map(|&i| objects.all.get(i).and_then(|o| Some((i, o, o.raw.as_ref()?)))).collect();
    let daqmx = listed.iter().any(|(_, _, raw)| raw.daqmx.is_some());
    let size = if daqmx {
        objects::daqmx_chunk(&listed)
    } else {
        listed.iter().try_fold(0, |n, (_, _, raw)| raw.bytes()?.checked_add(n))
    };
    let Some(size) = size.filter(|n| *n > 0) else { return Ok(()) };
    for chunk in raw.chunks_exact(size) {
        if daqmx {
            objects::daqmx(chunk, &listed, order, &mut content.values)?;
        } else if mask.has(5) {
            objects::interleaved(chunk, &listed, order, &mut content.values)?;
        } else {
            objects::contiguous(chunk, &listed, order, &mut content.values);
        }
    }
    if !raw.len().is_multiple_of(size) {
        content.notes.push(format!("{} bytes after the last whole chunk are left out", raw.len() % size));
    }
    Ok(())
}

/// The channels as columns, with the time that their waveforms state.
fn columns(objects: &Objects, mut content: Content0) -> Result<Content, Flaw> {
    let mut found = Content { columns: Vec::new(), notes: vec!["TDMS".to_owned()] };
    let mut times: Vec<(f64, f64, Option<f64>, usize)> = Vec::new();
    for (i, object) in objects.all.iter().enumerate() {
        let Some(values) = content.values.remove(&i).filter(|v| !v.is_empty()) else { continue };
        let Some((group, channel)) = object.path.split_once('/') else { continue };
        let values = scale::apply(object, values, &mut found.notes)?;
        if let Some(step) = object.number("wf_increment").filter(|dt| *dt > 0.0) {
            let offset = object.number("wf_start_offset").unwrap_or(0.0);
            let clock = (step, offset, object.number("wf_start_time"), values.len());
            if !times.contains(&clock) {
                times.push(clock);
                let name = if times.len() == 1 { "time".to_owned() } else { format!("time of {channel}") };
                let time = (0..values.len()).map(|k| offset + k as f64 * step).collect();
                found.columns.push(Column::new(&name, "s", time));
            }
        }
        let mut column = Column::new(channel, object.text("unit_string").unwrap_or_default(), values);
        column.heading.text = format!("{group}/{channel}");
        found.columns.push(column);
    }
    if found.columns.is_empty() {
        return Err("is TDMS without a channel of numbers".to_owned());
    }
    if times.is_empty() {
        found.notes.push("no channel states its sampling interval (wf_increment)".to_owned());
    }
    if times.len() > 1 {
        found.notes.push("channels differ in interval, start or length: each has a time of its own".to_owned());
    }
    found.notes.append(&mut content.notes);
    Ok(found)
}

#[cfg(test)]
mod tests;
