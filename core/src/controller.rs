//! The only entry point: one sample in, one command out.

use crate::settings::{Settings, SettingsError};

/// What the sensors and the reference say at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Reference displacement, m.
    pub reference: f32,
    /// Table displacement from the LVDT, m.
    pub displacement: f32,
    /// Table acceleration, m/s2.
    pub acceleration: f32,
}

/// What happened during a tick, beside the command itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Status {
    /// The table's velocity is at its limit.
    pub saturated: bool,
    /// An input was not a number or out of range; the last good output was held.
    pub held: bool,
}

/// What the valve is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command {
    /// Valve command, m (the paper feeds the valve a displacement error times a gain).
    pub valve: f32,
    /// The reference after record modification, m.
    pub reference: f32,
    /// What happened.
    pub status: Status,
}

/// The whole control law.
#[derive(Debug, Clone)]
pub struct Controller {
    settings: Settings,
    sum: f32,
}

impl Controller {
    /// A controller at rest, if the settings hold.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        Ok(Self { settings: *settings, sum: 0.0 })
    }

    /// One tick: measure, decide, command.
    pub fn step(&mut self, sample: &Sample) -> Command {
        let error = sample.reference - sample.displacement;
        self.sum += error / self.settings.rate;
        let gains = self.settings.displacement;
        Command {
            valve: gains.proportional * error + gains.integral * self.sum,
            reference: sample.reference,
            status: Status::default(),
        }
    }
}
