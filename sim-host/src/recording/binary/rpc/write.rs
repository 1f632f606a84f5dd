//! Writing RPC III: single precision, or short integers, each channel scaled to its peak.

use super::{BLOCK, KEY, RECORD};

/// Raw number of the full scale.
const FULL_SCALE: f64 = 32_752.0;
/// Points of a frame and of a group.
const FRAME: usize = 1024;

/// How points are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Points {
    /// Single precision (`FLOATING_POINT`), which RPC III has but its releases 5.0x do not read.
    #[default]
    Float,
    /// Sixteen bits over the channel's peak (`SHORT_INTEGER`), which every release reads.
    Short,
}

/// One channel of a file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RpcChannel {
    /// What it is.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// Why a file cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum RpcError {
    /// What fills the last frame would be a step.
    #[error(
        "channel `{name}` ends at {value:.3e} {unit} of {peak:.3e}: RPC III fills its last frame with zeros, which would be a step \
         of the table; let the drive end at rest at zero"
    )]
    Step {
        /// The channel.
        name: String,
        /// Its last value.
        value: f64,
        /// Its unit.
        unit: String,
        /// Its peak.
        peak: f64,
    },
    /// Nothing to write, or channels of different length, or values that are no numbers.
    #[error("an RPC III file needs channels of one length, at least one value in each, all finite")]
    Unfit,
}

/// A file with these channels every `dt` s; `facts` are further records of the header, each cut to its field.
pub(crate) fn render(
    dt: f64,
    channels: &[RpcChannel],
    facts: &[(String, String)],
    stored: Points,
) -> Result<Vec<u8>, RpcError> {
    let points = channels.first().map_or(0, |c| c.values.len());
    let sound = |c: &RpcChannel| c.values.len() == points && c.values.iter().all(|v| v.is_finite());
    if points == 0 || !channels.iter().all(sound) || !(dt > 0.0 && dt.is_finite()) {
        return Err(RpcError::Unfit);
    }
    let steps = channels.iter().map(step).collect::<Result<Vec<f64>, RpcError>>()?;
    let frames = points.div_ceil(FRAME);
    let records = records(dt, channels, &steps, frames, facts, stored);
    let mut bytes = header(&records);
    for frame in 0..frames {
        for (channel, step) in channels.iter().zip(&steps) {
            let value = |k: usize| channel.values.get(k).copied().unwrap_or(0.0);
            let frame = frame * FRAME..(frame + 1) * FRAME;
            match stored {
                Points::Float => bytes.extend(frame.flat_map(|k| (value(k) as f32).to_le_bytes())),
                Points::Short => bytes.extend(frame.flat_map(|k| ((value(k) / step).round() as i16).to_le_bytes())),
            }
        }
    }
    Ok(bytes)
}

/// The header's keys and values, as many blocks as they take among them.
fn records(
    dt: f64,
    channels: &[RpcChannel],
    steps: &[f64],
    frames: usize,
    facts: &[(String, String)],
    stored: Points,
) -> Vec<(String, String)> {
    let mut records: Vec<(String, String)> = vec![
        ("FORMAT".into(), "BINARY_IEEE_LITTLE_END".into()),
        ("NUM_HEADER_BLOCKS".into(), String::new()),
        ("NUM_PARAMS".into(), String::new()),
    ];
    let mut put = |key: &str, value: String| records.push((key.to_owned(), value));
    put("FILE_TYPE", "TIME_HISTORY".into());
    put("TIME_TYPE", "DRIVE".into());
    put("DATA_TYPE", if stored == Points::Float { "FLOATING_POINT" } else { "SHORT_INTEGER" }.into());
    put("DELTA_T", format!("{dt:.9e}"));
    put("CHANNELS", channels.len().to_string());
    put("PTS_PER_FRAME", FRAME.to_string());
    put("PTS_PER_GROUP", FRAME.to_string());
    put("FRAMES", frames.to_string());
    put("INT_FULL_SCALE", format!("{FULL_SCALE:.0}"));
    put("BYPASS_FILTER", "0".into());
    put("HALF_FRAMES", "0".into());
    put("REPEATS", "1".into());
    put("PARTITIONS", "1".into());
    put("PART.CHAN_1", "1".into());
    put("PART.NCHAN_1", channels.len().to_string());
    for (n, (channel, step)) in channels.iter().zip(steps).enumerate().map(|(i, c)| (i + 1, c)) {
        let full = step * FULL_SCALE;
        put(&format!("DESC.CHAN_{n}"), channel.name.clone());
        put(&format!("UNITS.CHAN_{n}"), channel.unit.clone());
        // Of single precision readers take the values as they are, whatever the scale.
        let scale = if stored == Points::Float { 1.0 } else { *step };
        put(&format!("SCALE.CHAN_{n}"), format!("{scale:.17e}"));
        put(&format!("MAP.CHAN_{n}"), n.to_string());
        put(&format!("LOWER_LIMIT.CHAN_{n}"), format!("{:.9e}", -full));
        put(&format!("UPPER_LIMIT.CHAN_{n}"), format!("{full:.9e}"));
    }
    records.extend(facts.iter().cloned());
    records[1].1 = (records.len() * RECORD).div_ceil(BLOCK).to_string();
    records[2].1 = records.len().to_string();
    records
}

/// A channel's size of one step of sixteen bits; an end away from zero is refused.
fn step(channel: &RpcChannel) -> Result<f64, RpcError> {
    let peak = channel.values.iter().fold(0.0_f64, |p, v| p.max(v.abs()));
    let value = channel.values.last().copied().unwrap_or(0.0);
    let step = if peak > 0.0 { peak / FULL_SCALE } else { 1.0 / FULL_SCALE };
    // Below that it is no step that a table makes.
    let fills = !channel.values.len().is_multiple_of(FRAME);
    if fills && value.abs() > 1.5 * step {
        return Err(RpcError::Step { name: channel.name.clone(), value, unit: channel.unit.clone(), peak });
    }
    Ok(step)
}

fn header(records: &[(String, String)]) -> Vec<u8> {
    let blocks = (records.len() * RECORD).div_ceil(BLOCK);
    let mut bytes = Vec::with_capacity(blocks * BLOCK);
    let mut field = |text: &str, width: usize| {
        // One byte a character, the last one NUL.
        let ascii = text.chars().map(|c| if c.is_ascii() && !c.is_ascii_control() { c as u8 } else { b'?' });
        let mut part: Vec<u8> = ascii.take(width - 1).collect();
        part.resize(width, 0);
        bytes.extend(part);
    };
    for (key, value) in records {
        field(key, KEY);
        field(value, RECORD - KEY);
    }
    bytes.resize(blocks * BLOCK, 0);
    bytes
}
