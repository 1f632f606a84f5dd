//! What the firmware asks of a pair of converters.

pub mod outboard;

use crate::control_loop::Codes;

/// Inputs of a tick, in order: reference, displacement, acceleration, the existing controller's command.
pub const INPUTS: usize = 4;

/// Scans of a tick that on-chip converters of 12 bits sum up to a code of 16.
pub const SCANS: usize = 16;

/// What an output converter of 12 bits takes for `code`, which is of the scale of such a sum: the nearest it has.
pub const fn twelve_bits(code: u16) -> u16 {
    let nearest = (code as u32 + SCANS as u32 / 2) / SCANS as u32;
    if nearest < 0xFFF { nearest as u16 } else { 0xFFF }
}

/// An analog-to-digital converter of four inputs and a digital-to-analog converter of one output.
///
/// An implementation promises:
/// - all inputs of a tick are sampled within the same 100 microseconds, started by the timer and not by a program;
/// - codes are unsigned with zero at the bottom of the range and `full_scale` at its top;
/// - `read` and `write` take bounded time, allocate nothing and never wait for an event that may not come;
/// - a failure is reported at the tick in which it is noticed, and the output then stays at the last code written.
pub trait Converters {
    /// Why a conversion failed.
    type Error;

    /// Largest code of inputs and output.
    const FULL_SCALE: u16;

    /// The codes sampled for this tick.
    fn read(&mut self) -> Result<Codes, Self::Error>;

    /// Puts `code` on the output.
    fn write(&mut self, code: u16) -> Result<(), Self::Error>;

    /// Sets the converters up again after a failure, so that a later tick may read.
    fn recover(&mut self);
}
