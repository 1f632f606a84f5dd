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
/// Section types: no bits in the file; and the flag of what is there at run time.
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
