//! Converters on the board's SPI, as their data sheets have them: an AD7606 in, an AD5761R out.

use std::sync::{Arc, Mutex, PoisonError};

use rigless::chip::Timeline;
use rigless::chip::spi::Peer;
use rigless::device::Level;
use rigless::snapshot::Store;
use rigless::soc::stm32f427::peripherals::gpio::Pin;
use rigless::soc::stm32f427::peripherals::spi::Select;

/// Two's complement to codes from the bottom, and 2.5 V of 10.
const SIGN: u16 = 0x8000;
const REFERENCE: u16 = SIGN + 8192;
/// Commands of the output converter.
const WRITE: u32 = 0x03;
const CONTROL: u32 = 0x04;
/// Its control word's bits for range, and the one for +/-10 V.
const RANGE: u32 = 0b111;

/// What is on the analog side.
#[derive(Debug, Default)]
pub(super) struct Analog {
    /// Codes of the conversion that ended last: reference, displacement, acceleration, existing command; none before the first.
    pub(super) inputs: Option<[u16; 4]>,
    /// The output's code.
    pub(super) output: Option<u16>,
}

/// The analog side, in both chips' hands and the driver's.
pub(super) type Wires = Arc<Mutex<Analog>>;

/// The select of a chip at an active-low pin.
pub(super) fn select(port: &'static str, pin: u8) -> Option<Select> {
    Pin::new(pin).map(|pin| Select { port, pin, active: Level::Low })
}

/// The input converter: from the select on, the channels' bits.
#[derive(Debug)]
pub(super) struct Ad7606 {
    wires: Wires,
    sent: usize,
}

impl Ad7606 {
    pub(super) const fn new(wires: Wires) -> Self {
        Self { wires, sent: 0 }
    }
}

impl Store for Ad7606 {}

impl Peer for Ad7606 {
    fn transfer(&mut self, _: u32, bits: u8, _: &mut Timeline<'_, '_>) -> u32 {
        let analog = self.wires.lock().unwrap_or_else(PoisonError::into_inner);
        (0..bits).fold(0, |word, _| {
            let (channel, place) = (self.sent / 16, 15 - self.sent % 16);
            self.sent += 1;
            let code = analog.inputs.map_or(0, |inputs| match channel {
                0..=3 => inputs[channel] ^ SIGN,
                4 => REFERENCE ^ SIGN,
                _ => 0,
            });
            word << 1 | u32::from(code >> place & 1)
        })
    }

    fn select(&mut self, _: &mut Timeline<'_, '_>) {
        self.sent = 0;
    }
}

/// The output converter: 24 bits a frame, which counts when the select is let go.
#[derive(Debug)]
pub(super) struct Ad5761r {
    wires: Wires,
    frame: u32,
    bits: u32,
    ranged: bool,
}

impl Ad5761r {
    pub(super) const fn new(wires: Wires) -> Self {
        Self { wires, frame: 0, bits: 0, ranged: false }
    }
}

impl Store for Ad5761r {}

impl Peer for Ad5761r {
    fn transfer(&mut self, word: u32, bits: u8, _: &mut Timeline<'_, '_>) -> u32 {
        self.frame = self.frame << bits | word;
        self.bits += u32::from(bits);
        0
    }

    fn select(&mut self, _: &mut Timeline<'_, '_>) {
        (self.frame, self.bits) = (0, 0);
    }

    fn deselect(&mut self, _: &mut Timeline<'_, '_>) {
        if self.bits != 24 {
            return;
        }
        match self.frame >> 16 & 0xF {
            CONTROL => self.ranged = self.frame & RANGE == 0,
            WRITE if self.ranged => {
                let mut analog = self.wires.lock().unwrap_or_else(PoisonError::into_inner);
                analog.output = Some(self.frame as u16);
            }
            _ => {}
        }
    }
}
