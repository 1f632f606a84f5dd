//! Records in a zipped folder, as databases send them.
//!
//! Read is what the format's central directory lists: stored and deflated files, sizes and check sums held against what comes out.
//! Parts, encryption and 64-bit sizes are refused by name. The libraries for it bring more than the whole of what this tool needs.

use super::error::{Problem, ReadError};
use super::{Channel, SIZE_LIMIT};
use flate2::{Crc, read::DeflateDecoder};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A file of a zipped folder.
pub(super) struct Entry {
    /// Folder and file, for messages.
    pub(super) name: PathBuf,
    /// Its content.
    pub(super) bytes: Vec<u8>,
    /// What of it is wanted still.
    pub(super) channel: Channel,
}

/// A line of the central directory.
#[derive(Debug, Clone)]
struct Listed {
    name: String,
    flags: u16,
    method: u16,
    check: u32,
    packed: u32,
    whole: u32,
    start: u32,
}

/// Extensions that records have.
const KINDS: [&str; 13] = ["at2", "v2", "v2a", "v2c", "cv2", "ns", "ew", "ud", "ns2", "ew2", "ud2", "acc", "smc"];
/// Names that a message lists.
const SHOWN: usize = 20;
/// Bytes of a line of the directory before its name, of a file's own head, and of the end of the directory.
const SIZES: (usize, usize, usize) = (46, 30, 22);

/// The record of a zipped folder that a channel names, the only one where it names none; none where the file is no zipped folder.
pub(super) fn entry(path: &Path, channel: &Channel) -> Result<Option<Entry>, ReadError> {
    let error = |problem| ReadError { file: path.to_owned(), line: None, column: None, problem: Box::new(problem) };
    let refuse = |text: String| error(Problem::Archive(text));
    let Ok(mut file) = File::open(path) else { return Ok(None) };
    let mut start = [0; 4];
    // A pipe or a short file is read as text, which says what is wrong with it.
    let Some(size) = file.metadata().ok().filter(std::fs::Metadata::is_file).map(|m| m.len()) else { return Ok(None) };
    if file.read_exact(&mut start).is_err() || start != *b"PK\x03\x04" {
        return Ok(None);
    }
    if size > SIZE_LIMIT {
        return Err(error(Problem::TooLarge { bytes: size, limit: SIZE_LIMIT }));
    }
    let mut bytes = start.to_vec();
    file.take(SIZE_LIMIT).read_to_end(&mut bytes).map_err(|e| error(Problem::Unreadable(e)))?;
    let broken = |why: &str| refuse(format!("is a zipped folder that cannot be read ({why}): unpack it"));
    let mut all = directory(&bytes).map_err(broken)?;
    all.retain(|listed| is_record(&listed.name));
    all.sort_by(|a, b| a.name.cmp(&b.name));
    let (chosen, channel) = choose(&all, channel).map_err(refuse)?;
    if u64::from(chosen.whole) > SIZE_LIMIT {
        return Err(error(Problem::TooLarge { bytes: chosen.whole.into(), limit: SIZE_LIMIT }));
    }
    let content = unpacked(&bytes, chosen).map_err(|why| {
        refuse(format!("{} of the zipped folder cannot be unpacked ({why}): download it again", chosen.name))
    })?;
    Ok(Some(Entry { name: path.join(&chosen.name), bytes: content, channel }))
}

fn is_record(name: &str) -> bool {
    let path = Path::new(name);
    let hidden = name.starts_with("__MACOSX") || path.file_name().is_none_or(|n| n.to_string_lossy().starts_with('.'));
    let kind = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    !hidden && kind.is_some_and(|kind| KINDS.contains(&kind.as_str()))
}

/// The file that a channel names, and what of it is wanted still.
fn choose<'a>(all: &'a [Listed], channel: &Channel) -> Result<(&'a Listed, Channel), String> {
    let listed = || {
        let names: Vec<String> =
            all.iter().take(SHOWN).enumerate().map(|(i, l)| format!("{} ({})", i + 1, l.name)).collect();
        let more = if all.len() > SHOWN { format!(", ... {} in all", all.len()) } else { String::new() };
        names.join(", ") + &more
    };
    match (channel, all) {
        (_, []) => {
            Err("is a zipped folder without a record (.AT2, .V2, .V2A, .V2c, K-NET): unpack it and name the file"
                .into())
        }
        (channel, [only]) => Ok((only, channel.clone())),
        (Channel::Number(n), _) if (1..=all.len()).contains(n) => Ok((&all[n - 1], Channel::First)),
        (Channel::Name(part), _) => {
            let part = part.to_lowercase();
            let fits: Vec<&Listed> = all.iter().filter(|l| l.name.to_lowercase().contains(&part)).collect();
            match fits[..] {
                [one] => Ok((one, Channel::First)),
                _ => Err(format!(
                    "{} records of the zipped folder fit `{part}`: name one of {} with --channel",
                    fits.len(),
                    listed()
                )),
            }
        }
        _ => Err(format!("is a zipped folder of {} records: name one with --channel: {}", all.len(), listed())),
    }
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?))
}

/// What the central directory lists; its end is looked for from the back, where a comment may follow it.
fn directory(bytes: &[u8]) -> Result<Vec<Listed>, &'static str> {
    let earliest = bytes.len().saturating_sub(SIZES.2 + usize::from(u16::MAX));
    let end = (earliest..=bytes.len().saturating_sub(SIZES.2)).rev().find(|&at| bytes[at..].starts_with(b"PK\x05\x06"));
    let end = end.ok_or("it is cut off: its directory is missing")?;
    let of = || Some((u16_at(bytes, end + 4)?, u16_at(bytes, end + 10)?, u32_at(bytes, end + 16)?));
    let (part, count, start) = of().ok_or("its directory is cut off")?;
    if part != 0 || count == u16::MAX || start == u32::MAX {
        return Err("it is one of several parts, or in the 64-bit form");
    }
    let mut at = start as usize;
    let mut all = Vec::with_capacity(usize::from(count));
    for _ in 0..count {
        let listed = line(bytes, at).ok_or("its directory is damaged")?;
        at = listed.1;
        all.push(listed.0);
    }
    Ok(all)
}

/// A line of the directory and where the next begins.
fn line(bytes: &[u8], at: usize) -> Option<(Listed, usize)> {
    if !bytes.get(at..)?.starts_with(b"PK\x01\x02") {
        return None;
    }
    let lengths = [28, 30, 32].map(|k| u16_at(bytes, at + k).map(usize::from));
    let [Some(name), Some(extra), Some(comment)] = lengths else { return None };
    let text = bytes.get(at + SIZES.0..at + SIZES.0 + name)?;
    let listed = Listed {
        name: String::from_utf8_lossy(text).into_owned(),
        flags: u16_at(bytes, at + 8)?,
        method: u16_at(bytes, at + 10)?,
        check: u32_at(bytes, at + 16)?,
        packed: u32_at(bytes, at + 20)?,
        whole: u32_at(bytes, at + 24)?,
        start: u32_at(bytes, at + 42)?,
    };
    Some((listed, at + SIZES.0 + name + extra + comment))
}

/// A file's content, its size and check sum as the directory states them.
fn unpacked(bytes: &[u8], listed: &Listed) -> Result<Vec<u8>, String> {
    if listed.flags & 1 == 1 {
        return Err("it is encrypted".into());
    }
    let head = listed.start as usize;
    let data = || {
        let own = bytes.get(head..)?;
        let (name, extra) = (u16_at(own, 26)?, u16_at(own, 28)?);
        let from = SIZES.1 + usize::from(name) + usize::from(extra);
        own.starts_with(b"PK\x03\x04").then_some(())?;
        own.get(from..from + listed.packed as usize)
    };
    let data = data().ok_or("it is cut off")?;
    let whole = listed.whole as usize;
    let content = match listed.method {
        0 => data.to_vec(),
        8 => {
            let mut content = Vec::new();
            // The size that a folder states is its own word: what comes out is bounded whatever it says.
            let limit = whole as u64 + 1;
            DeflateDecoder::new(data).take(limit).read_to_end(&mut content).map_err(|e| e.to_string())?;
            content
        }
        other => return Err(format!("it is packed by method {other}, expected 0 or 8")),
    };
    if content.len() != whole {
        return Err(format!("{whole} bytes are stated and {} are there", content.len()));
    }
    let mut check = Crc::new();
    check.update(&content);
    if check.sum() != listed.check {
        return Err("its check sum is wrong".into());
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::super::{Options, record};
    use super::*;
    use crate::motion::generate::NEAR_FIELD_MODERATE;
    use flate2::{Compression, write::DeflateEncoder};
    use std::io::Write as _;

    fn peer(seed: u64) -> String {
        let record = NEAR_FIELD_MODERATE.generate(seed).unwrap();
        let mut text = format!(
            "PEER NGA STRONG MOTION DATABASE RECORD\nmade, {seed}\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= {}, DT= {:.4} SEC\n",
            record.acceleration.len(),
            record.dt
        );
        for row in record.acceleration.chunks(5) {
            text += &row.iter().map(|a| format!("  {:.7E}", a / 9.80665)).collect::<String>();
            text.push('\n');
        }
        text
    }

    /// A zipped folder, every second file stored, the others deflated.
    fn zipped(files: &[(&str, &str)]) -> Vec<u8> {
        let (mut out, mut list) = (Vec::new(), Vec::new());
        for (k, (name, text)) in files.iter().enumerate() {
            let mut check = Crc::new();
            check.update(text.as_bytes());
            let mut packer = DeflateEncoder::new(Vec::new(), Compression::default());
            packer.write_all(text.as_bytes()).unwrap();
            let (method, packed) =
                if k % 2 == 0 { (8u16, packer.finish().unwrap()) } else { (0, text.as_bytes().to_vec()) };
            let start = out.len() as u32;
            let mut head = [20u16, 0, method, 0, 0].map(u16::to_le_bytes).concat();
            head.extend([check.sum(), packed.len() as u32, text.len() as u32].map(u32::to_le_bytes).concat());
            head.extend([name.len() as u16, 0].map(u16::to_le_bytes).concat());
            out.extend(b"PK\x03\x04");
            out.extend(&head);
            out.extend(name.as_bytes());
            out.extend(packed);
            list.extend(b"PK\x01\x02\x14\x00");
            list.extend(&head);
            // Comment, part and attributes: with the start, 46 bytes come before the name.
            list.extend([0u8; 10]);
            list.extend(start.to_le_bytes());
            list.extend(name.as_bytes());
        }
        let (start, count) = (out.len() as u32, files.len() as u16);
        out.extend(&list);
        out.extend(b"PK\x05\x06");
        out.extend([0, 0, count, count].map(u16::to_le_bytes).concat());
        out.extend([list.len() as u32, start].map(u32::to_le_bytes).concat());
        out.extend([0, 0]);
        out
    }

    fn read(bytes: &[u8], channel: &str) -> Result<crate::motion::Record, String> {
        let file = tempfile::Builder::new().suffix(".zip").tempfile().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        let Ok(channel) = channel.parse();
        record(file.path(), &Options { channel, ..Options::default() }).map_err(|e| e.to_string())
    }

    #[test]
    fn a_zipped_folder_gives_the_record_that_is_named() {
        let (a, b) = (peer(1), peer(2));
        let both = zipped(&[
            ("kobe/RSN1_A.AT2", &a),
            ("kobe/RSN1_B.AT2", &b),
            ("kobe/readme.txt", "hello"),
            ("__MACOSX/x.AT2", ""),
        ]);
        let only = read(&zipped(&[("x.AT2", &b)]), "").unwrap();
        assert_eq!(read(&both, "_b").unwrap().acceleration, only.acceleration);
        assert_eq!(read(&both, "2").unwrap().acceleration, only.acceleration);
        assert_ne!(read(&both, "1").unwrap().acceleration, only.acceleration);
        let several = read(&both, "").unwrap_err();
        assert!(several.contains("of 2 records") && several.contains("RSN1_A.AT2"), "{several}");
        assert!(read(&both, "rsn1").unwrap_err().contains("2 records of the zipped folder fit"));
        assert!(read(&zipped(&[("readme.txt", "hello")]), "").unwrap_err().contains("without a record"));
    }

    #[test]
    fn a_damaged_folder_is_refused_by_what_is_wrong_with_it() {
        let whole = zipped(&[("x.AT2", &peer(1))]);
        assert!(read(&whole[..whole.len() / 2], "").unwrap_err().contains("directory is missing"));
        let mut broken = whole.clone();
        broken[200] ^= 0x55;
        assert!(read(&broken, "").unwrap_err().contains("cannot be unpacked"));
        // No byte changed makes it crash.
        for at in (0..whole.len()).step_by(37).chain(whole.len() - 100..whole.len()) {
            let mut bytes = whole.clone();
            bytes[at] = bytes[at].wrapping_add(101);
            let _ = read(&bytes, "");
        }
    }
}
