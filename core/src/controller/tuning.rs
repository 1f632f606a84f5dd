//! Settings worked out beside the tick, and exchanged between two.

use super::{Config, Controller};
use crate::control::TrackingState;
use crate::guard::{State, Supervisor};
use crate::settings::{Settings, SettingsError};

/// A configuration that is ready to be exchanged between two ticks: [`Settings`] worked out, which takes longer than a tick.
///
/// ```
/// use shakedown_core::{Controller, Settings, Tuning};
///
/// let mut controller = Controller::new(&Settings::default())?;
/// let tuning = Tuning::new(&Settings { velocity_limit: 0.2, ..Settings::default() })?; // outside the tick
/// controller.exchange(&tuning)?; // between two ticks
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tuning(Config);

impl Tuning {
    /// Works out `settings`, or says which field does not hold.
    #[inline(always)]
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        Config::new(settings).map(Self)
    }
}

impl Controller {
    /// Works out `settings` and exchanges them: [`Tuning::new`] and [`Self::exchange`] in one.
    pub fn retune(&mut self, settings: &Settings) -> Result<(), SettingsError> {
        self.exchange(&Tuning::new(settings)?)
    }

    /// Exchanges the settings between two ticks, whole or not at all, while the state goes on. The output does not jump:
    /// what it would jump by is taken up and let go over [`Settings::blend`]. A change of mode is the same thing.
    /// Settings with a guard put a controller that had none off; the guard is not taken away from a test that is not off.
    pub fn exchange(&mut self, tuning: &Tuning) -> Result<(), SettingsError> {
        let Tuning(config) = tuning;
        match (self.config.ramps.is_some(), config.ramps.is_some()) {
            (true, false) if self.supervisor.state() != State::Off => {
                return Err(SettingsError::Contradiction { field: "guard", with: "a test that is not off" });
            }
            (_, false) => self.supervisor = Supervisor::unguarded(),
            (false, true) => self.supervisor = Supervisor::off(),
            (true, true) => {}
        }
        if !self.begun {
            self.output = config.null_bias;
        }
        let displacement = self.readings.displacement;
        self.monitors.retune(&config.monitors, &self.config.monitors, displacement);
        match (self.config.mode.tracking(), config.mode.tracking()) {
            (Some(_), Some(law)) => law.adapt_state(&mut self.tracking),
            _ => self.tracking = TrackingState::at(displacement),
        }
        self.three_variable.take_over(self.config.mode.three_variable());
        if let Some(modifier) = config.mode.modifier().filter(|modifier| !modifier.owns(&self.modifier)) {
            modifier.restart(&mut self.modifier, self.reference);
        }
        self.blend.pending = self.begun;
        self.config = *config;
        Ok(())
    }
}
