//! A 16-bit pair over +/-10 V on two SPI devices: an AD7606 in, an AD5761R out.
//!
//! Input (Analog Devices AD7606, serial interface): a rising edge at CONVST samples all channels at once; the timer makes it, and no
//! program. When BUSY has fallen, the falling edge of the select puts the first bit of V1 on DOUTA, and each rising edge of the clock
//! the next: the channels in order, 16 bits of two's complement each, most significant first. The bus is in mode 2. Strapped, not
//! set: RANGE high for +/-10 V, OS2 to OS0 100 for a mean of 16 scans within the conversion.
//!
//! A line that is stuck reads 0 V, the middle of the table, and so does one with no converter behind it. So a fifth channel is read: V5 is wired
//! to the converter's own reference of 2.5 V, and where it reads anything else there is no sample.
//!
//! Output (Analog Devices AD5761R): a frame is 24 clocks, the command in bits 19 to 16: 3 writes and updates the DAC,
//! 4 writes the control register, 15 resets. The control register's fields, from the top (AD5761/AD5721 data sheet, table of
//! the control register): `CV` in bits 10 and 9, overrange 8, braking 7, thermal shutdown 6, internal reference 5, `PV` in 4 and 3, range
//! in 2 to 0. `CV` and `PV` are what a clear and a power-up give: 00 zero scale, which is -10 V, 01 mid-scale, which is 0 V.

use embedded_hal::spi::SpiDevice;

use super::{Converters, INPUTS};
use crate::control_loop::Codes;

/// Channels that are read: the inputs, and the reference.
const CHANNELS: usize = INPUTS + 1;
/// From two's complement to codes with zero at the bottom.
const SIGN: u16 = 0x8000;
/// Code of 2.5 V of +/-10 V, and how far off it may read: 1 %, the reference's own tolerance (0.4 %) and the gain error's (0.1 %) with room.
const WITNESS: u16 = SIGN + 8192;
const WITNESS_OFF: u16 = 82;

const DAC_WRITE: u8 = 0x03;
const DAC_CONTROL: u8 = 0x04;
const DAC_RESET: u8 = 0x0F;
/// `CV` and `PV`: mid-scale.
const MID_SCALE: u16 = 0b01;
const CLEAR_AT: u16 = 9;
const POWER_UP_AT: u16 = 3;
const INTERNAL_REFERENCE: u16 = 1 << 5;
/// The range of +/-10 V.
const BIPOLAR_10V: u16 = 0b000;
/// Clear and power-up at mid-scale, internal reference on, range +/-10 V.
const DAC_SETTING: u16 = MID_SCALE << CLEAR_AT | INTERNAL_REFERENCE | MID_SCALE << POWER_UP_AT | BIPOLAR_10V;

/// Why the pair failed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Error<A, D> {
    /// The bus of the input converter.
    Input(A),
    /// The bus of the output converter.
    Output(D),
    /// The channel that reads the reference reads this code: the converter is not there, or its data line is broken or stuck.
    Witness(u16),
}

/// The pair.
#[derive(Debug)]
pub struct Outboard<A, D> {
    input: A,
    output: D,
}

impl<A: SpiDevice, D: SpiDevice> Outboard<A, D> {
    /// Sets the output converter to +/-10 V, at 0 V; the input converter is strapped, and [`Converters::read`] finds out whether it is
    /// there.
    pub fn new(input: A, mut output: D) -> Result<Self, Error<A::Error, D::Error>> {
        output.write(&dac_frame(DAC_RESET, 0)).map_err(Error::Output)?;
        output.write(&dac_frame(DAC_CONTROL, DAC_SETTING)).map_err(Error::Output)?;
        Ok(Self { input, output })
    }
}

impl<A: SpiDevice, D: SpiDevice> Converters for Outboard<A, D> {
    type Error = Error<A::Error, D::Error>;

    const FULL_SCALE: u16 = u16::MAX;

    /// After the conversion.
    fn read(&mut self) -> Result<Codes, Self::Error> {
        let mut bytes = [0; 2 * CHANNELS];
        self.input.read(&mut bytes).map_err(Error::Input)?;
        let mut codes = [0; CHANNELS];
        for (code, two) in codes.iter_mut().zip(bytes.as_chunks::<2>().0) {
            *code = u16::from_be_bytes(*two) ^ SIGN;
        }
        let [reference, displacement, acceleration, external, witness] = codes;
        if witness.abs_diff(WITNESS) > WITNESS_OFF {
            return Err(Error::Witness(witness));
        }
        Ok([reference, displacement, acceleration, external].into())
    }

    fn write(&mut self, code: u16) -> Result<(), Self::Error> {
        self.output.write(&dac_frame(DAC_WRITE, code)).map_err(Error::Output)
    }

    /// Nothing is set that could be lost; a reset of the output converter would let go of the last code.
    fn recover(&mut self) {}
}

/// What writes `code` to the output converter: for the end of a program that has failed, which owns no device.
pub const fn last_frame(code: u16) -> [u8; 3] {
    dac_frame(DAC_WRITE, code)
}

const fn dac_frame(command: u8, value: u16) -> [u8; 3] {
    let [high, low] = value.to_be_bytes();
    [command, high, low]
}

#[cfg(test)]
mod tests;
