//! What goes into a tick and what comes out.

use shakedown_core::Relay;

use crate::SHAKEDOWN_NAME;

/// What sensors and reference say at one tick, in SI. What the settings do not read may hold anything.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Sample {
    /// Reference displacement, m.
    pub reference: f32,
    /// Table displacement from the LVDT, m.
    pub displacement: f32,
    /// Table acceleration, m/s2.
    pub acceleration: f32,
    /// The existing controller's command, m.
    pub external: f32,
    /// Table velocity from a sensor of its own, m/s.
    pub velocity: f32,
    /// Pressure difference across the piston, Pa.
    pub pressure_difference: f32,
    /// Reference velocity, m/s.
    pub reference_velocity: f32,
    /// Reference acceleration, m/s2.
    pub reference_acceleration: f32,
    /// Table displacement from a second sensor, m.
    pub second_displacement: f32,
    /// Whether the table is at a limit switch; 0 is no.
    pub limit_switch: u8,
    /// Whether the relay's contact reads closed; 0 is no.
    pub relay_closed: u8,
}

/// What the valve is told, and what happened.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Command {
    /// What goes out, m: the valve command; in modifier mode the reference handed to the existing controller.
    pub valve: f32,
    /// The reference after the test's ramps and record modification, m.
    pub reference: f32,
    /// The velocity limit now in force, m/s.
    pub velocity_limit: f32,
    /// Where the test stands: one of `SHAKEDOWN_STATE_...`.
    pub state: u8,
    /// Why the guard tripped, 1 to 17 in the order of docs/hosts.md; 0 for no trip.
    pub trip: u8,
    /// Whether the relay of the hydraulic block is to be closed.
    pub relay_closed: u8,
    /// Whether the table's velocity is at its limit.
    pub saturated: u8,
    /// Whether a needed input was not believable, so that the last good output was held.
    pub held: u8,
    /// Whether the command is at its limit.
    pub limited: u8,
    /// Which inputs were not believable, a bit each in the order of `shakedown_sample_t`; bit 6 is both reference rates, 7 the
    /// second displacement.
    pub missing: u8,
    /// How often state or trip have changed, modulo 256.
    pub changes: u8,
}

/// Why settings were refused.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Fault {
    /// One of the codes, `SHAKEDOWN_OK` where nothing is wrong.
    pub code: i32,
    /// What was given.
    pub value: f32,
    /// Smallest value accepted.
    pub low: f32,
    /// Largest value accepted.
    pub high: f32,
    /// The field's dotted name, closed by a zero.
    pub field: [u8; SHAKEDOWN_NAME],
}

impl From<&Sample> for shakedown_core::Sample {
    fn from(c: &Sample) -> Self {
        Self {
            reference: c.reference,
            displacement: c.displacement,
            acceleration: c.acceleration,
            external: c.external,
            velocity: c.velocity,
            pressure_difference: c.pressure_difference,
            reference_velocity: c.reference_velocity,
            reference_acceleration: c.reference_acceleration,
            second_displacement: c.second_displacement,
            limit_switch: c.limit_switch != 0,
            relay_closed: c.relay_closed != 0,
        }
    }
}

impl Command {
    pub(crate) fn of(command: &shakedown_core::Command, changes: u8) -> Self {
        let status = &command.status;
        Self {
            valve: command.valve,
            reference: command.reference,
            velocity_limit: status.velocity_limit,
            state: status.state as u8,
            trip: status.trip.map_or(0, |trip| trip as u8),
            relay_closed: u8::from(status.relay == Relay::Closed),
            saturated: u8::from(status.saturated),
            held: u8::from(status.held),
            limited: u8::from(status.limited),
            missing: status.missing.bits(),
            changes,
        }
    }
}
