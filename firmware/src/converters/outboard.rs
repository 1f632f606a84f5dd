//! A 16-bit pair over +/-10 V on two SPI devices: an ADS8688-class converter in, an AD5761R-class converter out.
//!
//! Input (Texas Instruments ADS8684/ADS8688, SBAS582): a frame is 32 clocks; the command goes out in the first 16 while
//! the sample of the channel selected by the *previous* frame comes back in the last 16. `MAN_Ch_n` is `0xC000 + n * 0x400`.
//! The range register of channel n is at `0x05 + n`; 0 selects +/-2.5 Vref = +/-10.24 V. A register is written by
//! `(address << 1 | 1) << 8 | value`, echoed in the next byte.
//!
//! Output (Analog Devices AD5761R): a frame is 24 clocks, the command in bits 19 to 16: 3 writes and updates the DAC,
//! 4 writes the control register, 15 resets. The control register's fields, from the top (AD5761/AD5721 data sheet, table of
//! the control register): `CV` in bits 10 and 9, overrange 8, braking 7, thermal shutdown 6, internal reference 5, `PV` in 4 and 3, range
//! in 2 to 0. `CV` and `PV` are what a clear and a power-up give: 00 zero scale, which is -10 V, 01 mid-scale, which is 0 V.

use embedded_hal::spi::{Operation, SpiDevice};

use super::{Converters, INPUTS};
use crate::control_loop::Codes;

const RANGE_REGISTER: u8 = 0x05;
const RANGE_10V: u8 = 0x00;
const SELECT_CHANNEL: u16 = 0xC000;
const CHANNEL_STEP: u16 = 0x0400;

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
    /// A register of the input converter reads back as something else: it is not there, or not this part.
    ReadBack {
        /// The register's address.
        register: u8,
        /// What it read.
        read: u8,
    },
}

/// The pair.
#[derive(Debug)]
pub struct Outboard<A, D> {
    input: A,
    output: D,
}

impl<A: SpiDevice, D: SpiDevice> Outboard<A, D> {
    /// Sets both converters to +/-10 V and checks that the input converter heard it.
    pub fn new(mut input: A, mut output: D) -> Result<Self, Error<A::Error, D::Error>> {
        set_ranges(&mut input)?;
        output.write(&dac_frame(DAC_RESET, 0)).map_err(Error::Output)?;
        output.write(&dac_frame(DAC_CONTROL, DAC_SETTING)).map_err(Error::Output)?;
        Ok(Self { input, output })
    }

    /// One frame: selects `channel` for the next and returns the sample of the one selected before.
    fn exchange(&mut self, channel: u16) -> Result<u16, Error<A::Error, D::Error>> {
        let [high, low] = (SELECT_CHANNEL + channel * CHANNEL_STEP).to_be_bytes();
        let mut frame = [high, low, 0, 0];
        self.input.transaction(&mut [Operation::TransferInPlace(&mut frame)]).map_err(Error::Input)?;
        let [_, _, high, low] = frame;
        Ok(u16::from_be_bytes([high, low]))
    }
}

impl<A: SpiDevice, D: SpiDevice> Converters for Outboard<A, D> {
    type Error = Error<A::Error, D::Error>;

    const FULL_SCALE: u16 = u16::MAX;

    fn read(&mut self) -> Result<Codes, Self::Error> {
        let mut codes = [0; INPUTS];
        self.exchange(0)?;
        for (channel, code) in (1..).zip(&mut codes) {
            *code = self.exchange(channel % INPUTS as u16)?;
        }
        Ok(codes.into())
    }

    fn write(&mut self, code: u16) -> Result<(), Self::Error> {
        self.output.write(&dac_frame(DAC_WRITE, code)).map_err(Error::Output)
    }

    /// The inputs' ranges anew. The output converter is left as it is: a reset of it would let go of the last code.
    fn recover(&mut self) {
        let _ = set_ranges::<A, D::Error>(&mut self.input);
    }
}

/// Sets every input to +/-10 V and checks that the converter heard it.
fn set_ranges<A: SpiDevice, D>(input: &mut A) -> Result<(), Error<A::Error, D>> {
    for channel in 0..INPUTS as u8 {
        let register = RANGE_REGISTER + channel;
        let mut frame = [register << 1 | 1, RANGE_10V, 0];
        input.transaction(&mut [Operation::TransferInPlace(&mut frame)]).map_err(Error::Input)?;
        let [_, _, read] = frame;
        if read != RANGE_10V {
            return Err(Error::ReadBack { register, read });
        }
    }
    Ok(())
}

const fn dac_frame(command: u8, value: u16) -> [u8; 3] {
    let [high, low] = value.to_be_bytes();
    [command, high, low]
}

#[cfg(test)]
mod tests;
