//! The setup in flash: two slots, written in turn, so that one whole setup is there at every instant.
//!
//! A slot holds `length, sequence, postcard(version, setup), CRC-32` and, programmed last, a mark. A slot without its
//! mark, with a wrong check sum, of another version or with a setup that does not hold is as good as empty; of two good
//! ones the later sequence counts. A write goes to the other slot, so power that fails anywhere in it leaves the old
//! setup in force.

mod in_memory;

pub use in_memory::{InMemory, OutOfRange};

use shakedown_core::link::{Setup, VERSION, checksum};

use crate::defaults;
use crate::limits::Limits;

/// Longest slot content, byte.
pub const SLOT: usize = 512;

const MARK: [u8; 4] = *b"shkd";
/// Mark, length, sequence.
const HEAD: usize = 12;

/// Two erasable slots. Bytes read 0xFF after an erase, and a program may be done once.
pub trait Slots {
    /// Why the flash refused.
    type Error;

    /// The first [`SLOT`] bytes of slot 0 or 1.
    fn read(&self, slot: usize, bytes: &mut [u8; SLOT]);

    /// Erases slot 0 or 1. May stall the processor for its whole length.
    fn erase(&mut self, slot: usize) -> Result<(), Self::Error>;

    /// Programs `bytes` at `offset` of slot 0 or 1.
    fn program(&mut self, slot: usize, offset: usize, bytes: &[u8]) -> Result<(), Self::Error>;
}

/// A setup found in flash.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// The setup, validated.
    pub setup: Setup,
    slot: usize,
    sequence: u32,
}

/// The setup in force; none when neither slot holds a good one.
pub fn load(slots: &impl Slots) -> Option<Found> {
    let later = match (sequence(slots, 0), sequence(slots, 1)) {
        (Some(a), Some(b)) if b.wrapping_sub(a).cast_signed() > 0 => 1,
        (None, Some(_)) => 1,
        _ => 0,
    };
    // One at a time: the stack holds one.
    read(slots, later).or_else(|| read(slots, 1 - later))
}

/// The setup in flash, and whether there is one that a board of these `limits` takes; else the defaults.
#[inline(never)]
pub fn load_or_default(slots: &impl Slots, limits: Limits) -> (Setup, bool) {
    match load(slots).filter(|found| limits.check(&found.setup).is_ok()) {
        Some(found) => (found.setup, true),
        None => (defaults::setup_of(limits), false),
    }
}

/// The sequence of a slot that is whole, whatever it holds.
#[inline(never)]
fn sequence(slots: &impl Slots, slot: usize) -> Option<u32> {
    let mut bytes = [0; SLOT];
    slots.read(slot, &mut bytes);
    whole(&bytes).map(|(sequence, _)| sequence)
}

/// Sequence and content of a slot with its mark and the right check sum.
fn whole(bytes: &[u8; SLOT]) -> Option<(u32, &[u8])> {
    let (head, rest) = bytes.split_first_chunk::<HEAD>()?;
    let (mark, numbers) = head.split_first_chunk::<4>()?;
    let (length, sequence) = numbers.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let sequence = u32::from_le_bytes(*sequence.first_chunk::<4>()?);
    let body = rest.get(..length)?;
    let check = u32::from_le_bytes(*rest.get(length..)?.first_chunk::<4>()?);
    (*mark == MARK && checksum(body) ^ sequence == check).then_some((sequence, body))
}

#[inline(never)]
fn read(slots: &impl Slots, slot: usize) -> Option<Found> {
    let mut bytes = [0; SLOT];
    slots.read(slot, &mut bytes);
    let (sequence, body) = whole(&bytes)?;
    decoded(body).map(|setup| Found { setup, slot, sequence })
}

/// Not part of what is made anew for every flash: the format is the same, and so is the code.
#[inline(never)]
fn decoded(body: &[u8]) -> Option<Setup> {
    match postcard::from_bytes::<(u8, Setup)>(body) {
        Ok((VERSION, setup)) if setup.validate().is_ok() => Some(setup),
        _ => None,
    }
}

/// Fills a slot with `setup`, its mark included, which is programmed last; how many bytes. None where it does not fit.
#[inline(never)]
fn encoded(setup: &Setup, sequence: u32, bytes: &mut [u8; SLOT]) -> Option<usize> {
    let (head, rest) = bytes.split_first_chunk_mut::<HEAD>()?;
    let body = postcard::to_slice(&(VERSION, setup), rest).ok()?;
    let (length, check) = (body.len(), checksum(body) ^ sequence);
    rest.get_mut(length..length + 4)?.copy_from_slice(&check.to_le_bytes());
    let (mark, numbers) = head.split_at_mut(4);
    let (first, second) = numbers.split_at_mut(4);
    mark.copy_from_slice(&MARK);
    first.copy_from_slice(&u32::try_from(length).ok()?.to_le_bytes());
    second.copy_from_slice(&sequence.to_le_bytes());
    Some(HEAD + length + 4)
}

/// Why a setup was not saved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "log", derive(defmt::Format))]
pub enum SaveError<E> {
    /// It does not fit a slot.
    TooLong,
    /// The flash refused.
    Flash(E),
    /// What was written reads back as something else.
    ReadBack,
}

/// Writes `setup` to the slot that is not in force, and reads it back.
pub fn save<S: Slots>(slots: &mut S, setup: &Setup) -> Result<(), SaveError<S::Error>> {
    let (slot, sequence) = match load(slots) {
        Some(found) => (1 - found.slot, found.sequence.wrapping_add(1)),
        None => (0, 0),
    };
    let mut bytes = [0; SLOT];
    let end = encoded(setup, sequence, &mut bytes).ok_or(SaveError::TooLong)?;
    slots.erase(slot).map_err(SaveError::Flash)?;
    slots.program(slot, 4, bytes.get(4..end).ok_or(SaveError::TooLong)?).map_err(SaveError::Flash)?;
    slots.program(slot, 0, &MARK).map_err(SaveError::Flash)?;
    match load(slots) {
        Some(found) if found.slot == slot && found.setup == *setup => Ok(()),
        _ => Err(SaveError::ReadBack),
    }
}

#[cfg(test)]
mod tests;
