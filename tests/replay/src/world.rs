//! What surrounds the board.

use std::collections::VecDeque;

/// The serial line as its far end sees it.
#[derive(Debug, Default)]
pub struct Line {
    /// Bytes that the firmware has sent; the world takes them.
    pub from_device: VecDeque<u8>,
    /// Bytes for the firmware; they go out at the line's pace.
    pub to_device: VecDeque<u8>,
}

/// Scans that on-chip converters sum up to a code.
pub const SCANS: usize = 16;

/// The converters that the board is built with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fitted {
    /// Its own: a code is the sum of 16 scans of 12 bits, and the output has 12.
    OnChip,
    /// Of 16 bits, on its SPI.
    Outboard,
}

impl Fitted {
    /// The code that the output gives for `code`: of 12 bits on the chip, on the scale of 16.
    pub fn at_the_output(self, code: u16) -> u16 {
        match self {
            Self::OnChip => shakedown_firmware::converters::twelve_bits(code) * SCANS as u16,
            Self::Outboard => code,
        }
    }

    /// The converters whose largest code is `full_scale`.
    pub const fn of(full_scale: u16) -> Self {
        if full_scale == u16::MAX { Self::Outboard } else { Self::OnChip }
    }
}

/// One update of the sampling timer.
#[derive(Debug)]
pub struct Tick<'a> {
    /// Updates since the firmware last started its timer.
    pub index: u64,
    /// Virtual time, ns.
    pub time: u64,
    /// Instructions retired since power-on.
    pub instructions: u64,
    /// Code last written to the converter's output; none before the first.
    pub output: Option<u16>,
    /// Whether the relay of the hydraulic block is closed.
    pub relay: bool,
    /// Resets since power-on.
    pub resets: usize,
    /// Codes that this update samples: reference, displacement, acceleration, existing command. Kept from tick to tick.
    pub inputs: &'a mut [u16; 4],
    /// Whether the emergency-stop circuit is closed. Kept from tick to tick.
    pub circuit_closed: &'a mut bool,
    /// Supply, mV. Kept from tick to tick.
    pub supply: &'a mut u32,
    /// The serial line.
    pub line: &'a mut Line,
}

/// What is on the pins of the crystal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Oscillator {
    /// A crystal that starts.
    Crystal,
    /// An external clock, which runs where the oscillator is bypassed.
    External,
    /// Nothing, or a crystal that does not start.
    Dead,
}

/// What closes the loop around the image.
pub trait World: Send + 'static {
    /// The sampling timer's update. False ends the run.
    fn tick(&mut self, tick: Tick<'_>) -> bool;

    /// The converters that the image under test expects.
    fn fitted(&self) -> Fitted {
        Fitted::OnChip
    }

    /// The scans of on-chip converters whose sums are `inputs`, 12 bits each.
    fn scans(&mut self, inputs: [u16; 4]) -> [[u16; 4]; SCANS] {
        spread(inputs)
    }

    /// Whether a conversion follows this update; a converter that is dead says no.
    fn converts(&self) -> bool {
        true
    }

    /// What is on the pins of the crystal.
    fn oscillator(&self) -> Oscillator {
        Oscillator::Crystal
    }

    /// Frequency of the watchdog's clock, Hz: 17,000 to 47,000.
    fn watchdog_clock(&self) -> u64 {
        32_000
    }

    /// The chip's option bytes, as its register of them says: a factory's, unless this says another.
    fn option_bytes(&self) -> u32 {
        0x0FFF_AAED
    }

    /// How long the core stands where a tick puts its code out, ns; none where it does not.
    fn stands(&self) -> Option<u64> {
        None
    }

    /// Whether this update's sample is lost: the DMA is off when the conversion ends, so that the converter overruns; an outboard one is
    /// still busy.
    fn overruns(&self) -> bool {
        false
    }
}

/// Scans without noise whose sums are `inputs`.
pub(crate) fn spread(inputs: [u16; 4]) -> [[u16; 4]; SCANS] {
    let mut scans = [[0; 4]; SCANS];
    for (number, scan) in scans.iter_mut().enumerate() {
        *scan = inputs.map(|code| (code / 16 + u16::from(usize::from(code % 16) > number)).min(4095));
    }
    scans
}
