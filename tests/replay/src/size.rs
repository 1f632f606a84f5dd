//! What an image is made of, from its headers, so that no tool need be installed: how much of the target's memories it takes, and
//! the code that a fault meets first.

use std::path::Path;

use crate::ReplayError;

/// Sizes, byte.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Flash: code, constants, and the initial values of variables.
    pub flash: u64,
    /// RAM without the stack: variables.
    pub ram: u64,
}

const RAM: std::ops::Range<u32> = 0x2000_0000..0x2002_0000;
/// Section types: symbols; no bits in the file; and the flag of what is there at run time.
const SYMBOLS: u32 = 2;
const NOBITS: u32 = 8;
const ALLOC: u32 = 2;

/// Reads the ELF file at `path`.
pub fn size(path: &Path) -> Result<Size, ReplayError> {
    let fail = |reason: String| ReplayError::Image { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(|error| fail(error.to_string()))?;
    sections(&bytes).ok_or_else(|| fail("it is no 32-bit little-endian ELF file".into()))
}

fn sections(bytes: &[u8]) -> Option<Size> {
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    if bytes.get(..6)? != b"\x7fELF\x01\x01" {
        return None;
    }
    let (table, entry, count) = (word(0x20)? as usize, usize::from(half(0x2E)?), usize::from(half(0x30)?));
    let mut size = Size { flash: 0, ram: 0 };
    for number in 0..count {
        let at = table + number * entry;
        let (kind, flags, address, length) = (word(at + 4)?, word(at + 8)?, word(at + 12)?, word(at + 20)?);
        if flags & ALLOC == 0 {
            continue;
        }
        if RAM.contains(&address) {
            size.ram += u64::from(length);
        }
        if kind != NOBITS {
            size.flash += u64::from(length);
        }
    }
    Some(size)
}

/// Where the flash begins, and in it the vector of a fault.
const FLASH: u32 = 0x0800_0000;
const FAULT: u32 = FLASH + 3 * 4;
/// Half words of code that are read.
const HALVES: u32 = 7;

/// The first half words of the handler that the vector table of the ELF file at `path` names for a fault.
pub fn fault_handler(path: &Path) -> Result<Vec<u16>, ReplayError> {
    let fail = |reason: String| ReplayError::Image { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(|error| fail(error.to_string()))?;
    let handler = loaded(&bytes, FAULT, 4).and_then(|word| Some(u32::from_le_bytes(word.try_into().ok()?) & !1));
    let code = handler.and_then(|handler| loaded(&bytes, handler, 2 * HALVES));
    let code = code.ok_or_else(|| fail("it has no vector table at the start of the flash".into()))?;
    Ok(code.chunks_exact(2).map(|half| u16::from_le_bytes([half[0], half[1]])).collect())
}

/// From the start of the log's control block to the offset at which its next byte goes (defmt-rtt; SEGGER's RTT: 16 bytes of mark, two
/// counts, then of the first channel name, buffer, size, offset).
const LOG_OFFSET: u32 = 16 + 2 * 4 + 3 * 4;

/// Where the ELF file at `path` keeps how far its log is written.
pub fn log(path: &Path) -> Result<u64, ReplayError> {
    let fail = |reason: String| ReplayError::Image { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(|error| fail(error.to_string()))?;
    let block = symbol(&bytes, b"_SEGGER_RTT").ok_or_else(|| fail("it has no log".into()))?;
    Ok(u64::from(block + LOG_OFFSET))
}

/// The value of a symbol of a 32-bit little-endian ELF file.
fn symbol(bytes: &[u8], name: &[u8]) -> Option<u32> {
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (table, entry, count) = (word(0x20)? as usize, usize::from(half(0x2E)?), usize::from(half(0x30)?));
    let section = |number: usize| table + number * entry;
    let symbols = (0..count).map(section).find(|&at| word(at + 4) == Some(SYMBOLS))?;
    let (from, length) = (word(symbols + 16)? as usize, word(symbols + 20)? as usize);
    let names = word(section(word(symbols + 24)? as usize) + 16)? as usize;
    (from..from + length).step_by(16).find_map(|at| {
        let text = bytes.get(names + word(at)? as usize..)?;
        (text.starts_with(name) && text.get(name.len()) == Some(&0)).then(|| word(at + 4))?
    })
}

/// The bytes that a 32-bit little-endian ELF file loads to `address`.
fn loaded(bytes: &[u8], address: u32, length: u32) -> Option<&[u8]> {
    let half = |at: usize| Some(u16::from_le_bytes(bytes.get(at..at + 2)?.try_into().ok()?));
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let (table, entry, count) = (word(0x1C)? as usize, usize::from(half(0x2A)?), usize::from(half(0x2C)?));
    (0..count).map(|number| table + number * entry).find_map(|at| {
        let (offset, from, size) = (word(at + 4)?, word(at + 12)?, word(at + 16)?);
        let within = address.checked_sub(from).filter(|into| into + length <= size)?;
        let start = (offset + within) as usize;
        bytes.get(start..start + length as usize)
    })
}
