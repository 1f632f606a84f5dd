//! The loop of an Embassy firmware: codes of 12-bit converters in and out, the core between them.
#![no_std]

#[cfg(test)]
mod tests;

use shakedown_core::settings::GuardSettings;
use shakedown_core::{Controller, Modification, OperatorRequest, Relay, Sample, Settings, SettingsError, State};

/// Control rate, Hz.
pub const RATE: u64 = 1000;
/// The middle of a converter, and of reference, LVDT and valve the metres of a code: +/-0.125 m over 12 bits.
pub const MIDDLE: u16 = 2048;
pub const METRE: f32 = 0.25 / 4096.0;
/// The same of the accelerometer, m/s2.
pub const ACCELERATION: f32 = 40.0 / 4096.0;

/// What the loop owns.
pub struct Table {
    controller: Controller,
    /// Whether the key has been off since the power came or the test tripped: one that is on already arms nothing.
    released: bool,
}

impl Table {
    /// The paper's strong gains behind causal record modification and the guard.
    pub fn new() -> Result<Self, SettingsError> {
        let mut settings = Settings {
            rate: RATE as f32,
            modification: Modification::Causal,
            guard: Some(GuardSettings::default()),
            anti_windup: true,
            ..Settings::default()
        };
        (settings.displacement.proportional, settings.displacement.integral) = (10.0, 1.0);
        Ok(Self { controller: Controller::new(&settings)?, released: false })
    }

    /// One tick: reference, LVDT and accelerometer as codes, and the operator's key; the valve's code and the relay.
    pub fn tick(&mut self, codes: [u16; 3], key: bool) -> (u16, bool) {
        let [reference, displacement, acceleration] = codes.map(|code| f32::from(code) - f32::from(MIDDLE));
        let sample = Sample::new(reference * METRE, displacement * METRE, acceleration * ACCELERATION);
        let command = self.controller.step(&sample);
        let state = command.status.state;
        self.released = state != State::Tripped && (self.released || !key);
        let wanted = match (key, state) {
            (true, State::Off) if self.released => Some(OperatorRequest::Arm),
            (true, State::Ready) => Some(OperatorRequest::Start),
            (false, State::Running) => Some(OperatorRequest::Stop),
            (false, State::Ready) => Some(OperatorRequest::Off),
            _ => None,
        };
        // Refused: asked again at the next tick.
        let _ = wanted.map(|request| self.controller.request(request));
        let code = (command.valve / METRE + f32::from(MIDDLE) + 0.5).clamp(0.0, 4095.0);
        (code as u16, command.status.relay == Relay::Closed)
    }
}
