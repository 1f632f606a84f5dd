//! A rehearsal: the paper's table in place of a device's converters.
//!
//! The device runs the same image, streamed record, guard and telemetry; what its converters would read comes from
//! [`Rehearsal::codes`], and what they would write goes to [`Rehearsal::advance`]. Device and host run this crate, so that both
//! compute the same bits: `f32`, no allocation, no mathematical function but `libm`'s.
#![no_std]

mod table;

pub use table::{Table, VELOCITY_LIMIT};

use shakedown_core::link::Scale;
use shakedown_core::settings::InnerLoop;
use shakedown_core::{Mode, Settings};

/// Proportional gain of the existing position controller, in guard and modifier mode, 1/1: the paper's.
const EXISTING_GAIN: f32 = 3.7;

/// What lies between the device's output and the valve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behind {
    /// Nothing: the output is the valve command, m.
    Valve,
    /// A hard-wired loop that subtracts the LVDT (Fig. 2): valve command = output - displacement.
    HardwiredLoop,
    /// An existing position controller: valve command = gain (output - displacement).
    ExistingLoop,
}

impl Behind {
    /// What a device under `settings` is wired to.
    pub fn of(settings: &Settings) -> Self {
        match (settings.mode, settings.inner_loop) {
            (Mode::Modifier, _) => Self::ExistingLoop,
            (_, InnerLoop::Hardwired) => Self::HardwiredLoop,
            (_, InnerLoop::Absent) => Self::Valve,
        }
    }
}

/// The scales of a device's inputs, and the largest code of its converters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inputs {
    /// Reference, m.
    pub reference: Scale,
    /// LVDT, m.
    pub displacement: Scale,
    /// Accelerometer, m/s2.
    pub acceleration: Scale,
    /// Existing controller's command, m.
    pub external: Scale,
    /// Largest code.
    pub full_scale: u16,
}

/// The table and what is wired to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rehearsal {
    table: Table,
    behind: Behind,
}

impl Rehearsal {
    /// The table at rest in its middle, moved on in steps of 1 / `rate` (Hz).
    pub fn new(rate: f32, behind: Behind) -> Self {
        Self { table: Table::new(rate), behind }
    }

    /// Wires the table to another loop, as it moves.
    pub const fn rewire(&mut self, behind: Behind) {
        self.behind = behind;
    }

    /// The table.
    pub const fn table(&self) -> &Table {
        &self.table
    }

    /// The codes that converters on `inputs` read now: reference at zero, displacement, acceleration, and the command of an
    /// existing controller that follows `reference` (m).
    pub fn codes(&self, inputs: &Inputs, reference: f32) -> [u16; 4] {
        let existing = EXISTING_GAIN * (reference - self.table.displacement());
        [
            nearest(inputs.reference, 0.0, inputs.full_scale),
            nearest(inputs.displacement, self.table.displacement(), inputs.full_scale),
            nearest(inputs.acceleration, self.table.acceleration(), inputs.full_scale),
            nearest(inputs.external, existing, inputs.full_scale),
        ]
    }

    /// One tick with `output` (m) held. Without `oil`, which is to say with the relay open, the table does not move.
    pub fn advance(&mut self, output: f32, oil: bool) {
        let command = match self.behind {
            Behind::Valve => output,
            Behind::HardwiredLoop => output - self.table.displacement(),
            Behind::ExistingLoop => EXISTING_GAIN * (output - self.table.displacement()),
        };
        if oil { self.table.advance(command) } else { self.table.stand() }
    }
}

/// The code of a converter up to `full_scale` nearest to `value` (the scale's SI unit); its end where it reaches no further.
pub fn nearest(scale: Scale, value: f32, full_scale: u16) -> u16 {
    let code = value / scale.per_code + scale.zero + 0.5;
    // `as` saturates at both ends and gives zero for what is not a number.
    (code as u16).min(full_scale)
}

#[cfg(test)]
mod tests;
