//! What passes between a host and the image: first the setup, then one [`Given`] and one [`Done`] a tick.
#![no_std]

use shakedown_core::OperatorRequest;

/// Name of the file or pipe that the image reads.
pub const TO_DEVICE: &str = "to-device";
/// Name of the one that it writes.
pub const FROM_DEVICE: &str = "from-device";
/// Bytes for the setup, as postcard writes it, filled up with zeros.
pub const SETUP: usize = 512;

/// What a tick is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given {
    /// Codes of reference, displacement, acceleration and existing command.
    pub inputs: [u16; 4],
    /// The next point of the streamed reference, m; no number is its end.
    pub point: Option<f32>,
    /// What is asked of the core before the tick.
    pub request: Option<OperatorRequest>,
}

/// Requests by the byte that stands for them; 0 is none.
const REQUESTS: [OperatorRequest; 4] =
    [OperatorRequest::Arm, OperatorRequest::Start, OperatorRequest::Off, OperatorRequest::Trip];

impl Given {
    /// Bytes on the way.
    pub const LENGTH: usize = 14;

    /// On the way. A request that has no byte is left out.
    pub fn to_bytes(&self) -> [u8; Self::LENGTH] {
        let mut bytes = [0; Self::LENGTH];
        for (two, code) in bytes.chunks_exact_mut(2).zip(self.inputs) {
            two.copy_from_slice(&code.to_le_bytes());
        }
        let place = REQUESTS.iter().position(|&request| Some(request) == self.request);
        let request = place.map_or(0, |place| place as u8 + 1);
        let [.., a, b, c, d, has, asked] = &mut bytes;
        [*a, *b, *c, *d] = self.point.unwrap_or(0.0).to_le_bytes();
        (*has, *asked) = (u8::from(self.point.is_some()), request);
        bytes
    }

    /// From the way.
    pub fn from_bytes(bytes: [u8; Self::LENGTH]) -> Self {
        let [c0, c1, c2, c3, c4, c5, c6, c7, a, b, c, d, has, asked] = bytes;
        let code = |low, high| u16::from_le_bytes([low, high]);
        Self {
            inputs: [code(c0, c1), code(c2, c3), code(c4, c5), code(c6, c7)],
            point: (has != 0).then_some(f32::from_le_bytes([a, b, c, d])),
            request: REQUESTS.get(usize::from(asked).wrapping_sub(1)).copied(),
        }
    }
}

/// What a tick did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Done {
    /// Output code.
    pub output: u16,
    /// Whether the relay is closed.
    pub relay: bool,
}

impl Done {
    /// Bytes on the way.
    pub const LENGTH: usize = 3;

    /// On the way.
    pub fn to_bytes(self) -> [u8; Self::LENGTH] {
        let [low, high] = self.output.to_le_bytes();
        [low, high, u8::from(self.relay)]
    }

    /// From the way.
    pub fn from_bytes([low, high, relay]: [u8; Self::LENGTH]) -> Self {
        Self { output: u16::from_le_bytes([low, high]), relay: relay != 0 }
    }
}
