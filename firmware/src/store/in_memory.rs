//! Two slots in memory, for tools and tests on the host: what a flash does, without one.

use super::{SLOT, Slots};

/// Two slots, as their bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InMemory(pub [[u8; SLOT]; 2]);

/// There is no such place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OutOfRange {
    /// The slot asked for.
    pub slot: usize,
    /// The offset in it, byte.
    pub offset: usize,
    /// How many bytes from there.
    pub length: usize,
}

impl InMemory {
    /// Both slots erased.
    pub const fn erased() -> Self {
        Self([[0xFF; SLOT]; 2])
    }
}

impl Slots for InMemory {
    type Error = OutOfRange;

    fn read(&self, slot: usize, bytes: &mut [u8; SLOT]) {
        if let Some(content) = self.0.get(slot) {
            *bytes = *content;
        }
    }

    fn erase(&mut self, slot: usize) -> Result<(), OutOfRange> {
        let content = self.0.get_mut(slot).ok_or(OutOfRange { slot, offset: 0, length: SLOT })?;
        *content = [0xFF; SLOT];
        Ok(())
    }

    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), OutOfRange> {
        let length = bytes.len();
        let place = self.0.get_mut(slot).and_then(|content| content.get_mut(offset..offset.checked_add(length)?));
        place.ok_or(OutOfRange { slot, offset, length })?.copy_from_slice(bytes);
        Ok(())
    }
}
