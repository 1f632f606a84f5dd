//! The serial link between a host and a device: versioned frames, the same code at both ends.
//!
//! One frame on the wire is `COBS(version, postcard(frame), CRC-32/ISO-HDLC little endian), 0x00`. The zero byte ends
//! a frame and occurs nowhere inside one, so a receiver that joins late or loses bytes is in step again at the next
//! zero. A frame is taken whole or not at all: wrong length, wrong check sum, wrong version and wrong content each
//! leave the receiver as it was, and are counted.
//!
//! The host speaks [`HostRequest`], the device answers and reports with [`Report`].

mod arming;
mod frame;
mod request;
mod wiring;

pub use crate::units::Scale;
pub use arming::{Challenge, answer};
pub use frame::{
    Batch, Clock, DeviceHealth, Identity, MAX_BATCH, MAX_OPTIONS, OptionByte, OptionPurpose, Record, RefusedBecause,
    Report, StopCause,
};
pub use request::{HostRequest, MAX_POINTS, Points};
pub use wiring::{Setup, SetupError, Source, Wiring};

use serde::{Serialize, de::DeserializeOwned};

/// The version of frames and settings; a device and a host of different versions refuse each other. Whatever changes their
/// shape changes this: a test holds the shape of each version.
pub const VERSION: u8 = 7;

/// Longest frame on the wire, byte, the closing zero included.
pub const MAX_FRAME: usize = 640;

const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// Why a frame could not be written or read.
///
/// ```
/// use shakedown_core::link::{HostRequest, LinkError, MAX_FRAME, decode, encode};
///
/// let mut frame = [0; MAX_FRAME];
/// let length = encode(&HostRequest::Stop, &mut frame)?;
/// frame[1] ^= 1; // a bit falls over on the way
/// assert_eq!(decode::<HostRequest>(&mut frame[..length - 1]), Err(LinkError::Garbled));
/// # Ok::<(), LinkError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinkError {
    /// The frame does not fit [`MAX_FRAME`] or the buffer given.
    TooLong,
    /// The bytes are no COBS frame, or their check sum is wrong: garbled on the way.
    Garbled,
    /// The frame is whole but of another version.
    Version {
        /// The version it carries; this end speaks [`VERSION`].
        theirs: u8,
    },
    /// The frame is whole and of this version, but its content is none of the frames known.
    Unknown,
}

/// CRC-32/ISO-HDLC of `bytes`, which frames and the settings in flash carry.
pub fn checksum(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// Writes `frame` to the front of `buffer` as it goes on the wire, closing zero included. Returns its length, byte.
///
/// In three passes rather than byte by byte through all three: a fifth fewer instructions on the target.
///
/// ```
/// use shakedown_core::link::{HostRequest, MAX_FRAME, decode, encode};
///
/// let mut frame = [0; MAX_FRAME];
/// let length = encode(&HostRequest::Identify, &mut frame)?;
/// let without_end = &mut frame[..length - 1];
/// assert_eq!(decode::<HostRequest>(without_end)?, HostRequest::Identify);
/// # Ok::<(), shakedown_core::link::LinkError>(())
/// ```
pub fn encode<T: Serialize>(frame: &T, buffer: &mut [u8]) -> Result<usize, LinkError> {
    let mut plain = [0; MAX_FRAME];
    let content = postcard::to_slice(&(VERSION, frame), &mut plain).map_err(|_| LinkError::TooLong)?;
    let (length, check) = (content.len(), checksum(content));
    plain.get_mut(length..length + 4).ok_or(LinkError::TooLong)?.copy_from_slice(&check.to_le_bytes());
    let checked = plain.get(..length + 4).ok_or(LinkError::TooLong)?;
    if buffer.len() < cobs::max_encoding_length(checked.len()) + 1 {
        return Err(LinkError::TooLong);
    }
    let written = cobs::encode(checked, buffer);
    *buffer.get_mut(written).ok_or(LinkError::TooLong)? = 0;
    Ok(written + 1)
}

/// Reads one frame from `bytes`, without its closing zero; `bytes` are overwritten on the way.
pub fn decode<T: DeserializeOwned>(bytes: &mut [u8]) -> Result<T, LinkError> {
    let length = cobs::decode_in_place(bytes).map_err(|_| LinkError::Garbled)?;
    let body = bytes.get(..length).ok_or(LinkError::Garbled)?;
    let (content, check) = body.split_last_chunk::<4>().ok_or(LinkError::Garbled)?;
    if checksum(content) != u32::from_le_bytes(*check) {
        return Err(LinkError::Garbled);
    }
    match content.split_first() {
        Some((&VERSION, frame)) => match postcard::take_from_bytes(frame) {
            Ok((frame, [])) => Ok(frame),
            _ => Err(LinkError::Unknown),
        },
        Some((&theirs, _)) => Err(LinkError::Version { theirs }),
        None => Err(LinkError::Garbled),
    }
}

/// Gathers bytes as they come into frames.
///
/// ```
/// use shakedown_core::link::{Assembler, HostRequest, MAX_FRAME, encode};
///
/// let mut frame = [0; MAX_FRAME];
/// let length = encode(&HostRequest::Stop, &mut frame)?;
/// let mut assembler = Assembler::new();
/// let received = frame[..length].iter().find_map(|&byte| assembler.push(byte));
/// assert_eq!(received, Some(Ok(HostRequest::Stop)));
/// # Ok::<(), shakedown_core::link::LinkError>(())
/// ```
#[derive(Debug)]
pub struct Assembler {
    bytes: [u8; MAX_FRAME],
    length: usize,
    overflowed: bool,
}

impl Default for Assembler {
    fn default() -> Self {
        Self::new()
    }
}

impl Assembler {
    /// An assembler that waits for the first byte.
    pub const fn new() -> Self {
        Self { bytes: [0; MAX_FRAME], length: 0, overflowed: false }
    }

    /// Takes one byte. A closing zero yields the frame it ends, or why there is none; an empty frame yields nothing,
    /// so that a sender may open with a zero to put both ends in step.
    #[inline]
    pub fn push<T: DeserializeOwned>(&mut self, byte: u8) -> Option<Result<T, LinkError>> {
        if self.gather(byte) { self.frame() } else { None }
    }

    /// The first half of [`Self::push`]: takes one byte. True where it is the closing zero.
    #[inline]
    pub fn gather(&mut self, byte: u8) -> bool {
        if byte == 0 {
            return true;
        }
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        } else {
            self.overflowed = true;
        }
        false
    }

    /// The other half: what was gathered, as a frame.
    pub fn frame<T: DeserializeOwned>(&mut self) -> Option<Result<T, LinkError>> {
        let (length, overflowed) = (self.length, self.overflowed);
        self.length = 0;
        self.overflowed = false;
        if overflowed {
            return Some(Err(LinkError::TooLong));
        }
        match self.bytes.get_mut(..length) {
            Some([]) | None => None,
            Some(bytes) => Some(decode(bytes)),
        }
    }
}

#[cfg(test)]
mod tests;
