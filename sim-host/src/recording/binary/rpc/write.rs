//! Writing RPC III: short integers, each channel scaled to its peak.

use super::{BLOCK, KEY, RECORD};

/// Raw number of the full scale.
const FULL_SCALE: f64 = 32_752.0;
/// Points of a frame and of a group.
const FRAME: usize = 1024;

/// One channel of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct RpcChannel {
    /// What it is.
    pub name: String,
    /// Unit of its values.
    pub unit: String,
    /// Its values.
    pub values: Vec<f64>,
}

/// Why a file cannot be written.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RpcError {
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
pub fn render(dt: f64, channels: &[RpcChannel], facts: &[(String, String)]) -> Result<Vec<u8>, RpcError> {
    let points = channels.first().map_or(0, |c| c.values.len());
    let sound = |c: &RpcChannel| c.values.len() == points && c.values.iter().all(|v| v.is_finite());
    if points == 0 || !channels.iter().all(sound) || !(dt > 0.0 && dt.is_finite()) {
        return Err(RpcError::Unfit);
    }
    let scales = channels.iter().map(scale).collect::<Result<Vec<f64>, RpcError>>()?;
    let frames = points.div_ceil(FRAME);
    let mut records: Vec<(String, String)> = vec![
        ("FORMAT".into(), "BINARY_IEEE_LITTLE_END".into()),
        ("NUM_HEADER_BLOCKS".into(), String::new()),
        ("NUM_PARAMS".into(), String::new()),
    ];
    let mut put = |key: &str, value: String| records.push((key.to_owned(), value));
    put("FILE_TYPE", "TIME_HISTORY".into());
    put("TIME_TYPE", "DRIVE".into());
    put("DATA_TYPE", "SHORT_INTEGER".into());
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
    for (n, (channel, scale)) in channels.iter().zip(&scales).enumerate().map(|(i, c)| (i + 1, c)) {
        let full = scale * FULL_SCALE;
        put(&format!("DESC.CHAN_{n}"), channel.name.clone());
        put(&format!("UNITS.CHAN_{n}"), channel.unit.clone());
        put(&format!("SCALE.CHAN_{n}"), format!("{scale:.17e}"));
        put(&format!("MAP.CHAN_{n}"), n.to_string());
        put(&format!("LOWER_LIMIT.CHAN_{n}"), format!("{:.9e}", -full));
        put(&format!("UPPER_LIMIT.CHAN_{n}"), format!("{full:.9e}"));
    }
    records.extend(facts.iter().cloned());
    let blocks = (records.len() * RECORD).div_ceil(BLOCK);
    records[1].1 = blocks.to_string();
    records[2].1 = records.len().to_string();
    let mut bytes = header(&records, blocks);
    for frame in 0..frames {
        for (channel, scale) in channels.iter().zip(&scales) {
            let raw = |k: usize| channel.values.get(k).map_or(0.0, |v| (v / scale).round());
            bytes.extend((frame * FRAME..(frame + 1) * FRAME).flat_map(|k| (raw(k) as i16).to_le_bytes()));
        }
    }
    Ok(bytes)
}

/// A channel's size of one raw step; an end away from zero is refused.
fn scale(channel: &RpcChannel) -> Result<f64, RpcError> {
    let peak = channel.values.iter().fold(0.0_f64, |p, v| p.max(v.abs()));
    let value = channel.values.last().copied().unwrap_or(0.0);
    let step = if peak > 0.0 { peak / FULL_SCALE } else { 1.0 / FULL_SCALE };
    // Below one raw step it is zero in the file.
    let fills = !channel.values.len().is_multiple_of(FRAME);
    if fills && value.abs() > 1.5 * step {
        return Err(RpcError::Step { name: channel.name.clone(), value, unit: channel.unit.clone(), peak });
    }
    Ok(step)
}

fn header(records: &[(String, String)], blocks: usize) -> Vec<u8> {
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
