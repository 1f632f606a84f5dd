//! Settings worked out beside the tick, and exchanged between two.

use super::{Config, Controller};
use crate::control::TrackingState;
use crate::guard::{State, Supervisor};
use crate::sample::Relay;
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
    /// what it would jump by is taken up and let go over [`Settings::blend`].
    ///
    /// Settings with a guard put a controller that had none off; the guard is not taken away from a test that is not off. Under a guard
    /// mode and inner loop, which say what the output is wired to, change only while the relay is open, and so do the kind of the law, the kind
    /// of the modifier and a preview's delay, whose state means nothing to another. Without a guard these three change only before the
    /// first tick.
    pub fn exchange(&mut self, tuning: &Tuning) -> Result<(), SettingsError> {
        let Tuning(config) = tuning;
        self.check_exchange(config)?;
        match (self.config.ramps.is_some(), config.ramps.is_some()) {
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

    /// Whether `config` may be exchanged now.
    fn check_exchange(&self, config: &Config) -> Result<(), SettingsError> {
        let old = &self.config;
        let state = self.supervisor.state();
        let guarded = old.ramps.is_some();
        let live = guarded && self.supervisor.relay() == Relay::Closed;
        let moves = live || (!guarded && self.begun);
        let closed = if guarded { "a relay that is closed" } else { "a law that runs without a guard" };
        let refused = [
            (guarded && config.ramps.is_none() && state != State::Off, "guard", "a test that is not off"),
            (live && !config.mode.is_of_kind(&old.mode), "mode", closed),
            (live && config.cancellation != old.cancellation, "inner_loop", closed),
            (moves && config.mode.tracking().is_some() != old.mode.tracking().is_some(), "tracking", closed),
            (moves && !goes_on(old, config), "modification", closed),
        ];
        match refused.into_iter().find(|(refused, ..)| *refused) {
            Some((_, field, with)) => Err(SettingsError::Contradiction { field, with }),
            None => Ok(()),
        }
    }
}

/// Whether what the modifier of `old` remembers means the same to that of `new`.
fn goes_on(old: &Config, new: &Config) -> bool {
    match (old.mode.modifier(), new.mode.modifier()) {
        (Some(old), Some(new)) => old.is_of_kind(new),
        // The mode is another.
        _ => true,
    }
}
