//! The tracking law inside the controller: there or not, and put at rest or exchanged like everything else.

use crate::control::tracking::{Seen, Surroundings};
use crate::control::{Tracking, TrackingState};
use crate::sample::Sample;
use crate::settings::{Settings, SettingsError};

/// The law, where the settings have one, and what it remembers.
#[derive(Debug, Clone, Default)]
pub(super) struct Tracker {
    law: Option<Tracking>,
    state: TrackingState,
}

/// Works the law out of `settings`, where they have one, or says which field does not hold.
#[inline(never)]
pub(crate) fn tracking(settings: &Settings) -> Result<Option<Tracking>, SettingsError> {
    let s = settings;
    let around = Surroundings {
        dt: 1.0 / s.rate,
        valve: [s.valve.gain, s.valve.lag],
        command_limit: s.valve.command_limit,
        velocity_limit: s.velocity_limit,
    };
    s.tracking.as_ref().map(|tracking| tracking.law(&around)).transpose().map_err(SettingsError::from)
}

impl Tracker {
    /// Takes over another law; the state goes on, or begins at rest at `displacement` (m) where there was no law.
    pub(super) fn retune(&mut self, law: Option<&Tracking>, displacement: f32) {
        match (&self.law, law) {
            (Some(_), Some(law)) => law.meet(&mut self.state),
            _ => self.state = TrackingState::at(displacement),
        }
        self.law = law.copied();
    }

    /// Puts the law at rest with the reference standing at `displacement` (m).
    pub(super) fn start_at(&mut self, displacement: f32) {
        if self.law.is_some() {
            self.state = TrackingState::at(displacement);
        }
    }

    /// One tick: modified reference (m) and readings in, command (m) out, where there is a law.
    #[inline]
    pub(super) fn step(&mut self, reference: f32, readings: &Sample) -> Option<f32> {
        let law = self.law.as_ref()?;
        let seen = Seen {
            reference,
            displacement: readings.displacement,
            acceleration: readings.acceleration,
            pressure_difference: readings.pressure_difference,
        };
        Some(law.advance(&mut self.state, &seen))
    }
}
