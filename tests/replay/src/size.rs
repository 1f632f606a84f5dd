//! How much of the target's memories an image takes: from its section headers, so that no tool need be installed.

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
