//! Settings worked out beside the tick, and exchanged between two.

use super::{Config, Controller};
use crate::control::TrackingState;
use crate::guard::{State, Supervisor};
use crate::modifier::Modifier;
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
    /// mode and inner loop, which say what the output is wired to, change only while the relay is open. The law and the delay of a
    /// preview, whose state means nothing to another, change only while no test is under way; without a guard one is from the
    /// first tick on.
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
        if self.config.mode.tracking().is_none() {
            self.tracking = TrackingState::held(self.reference, displacement);
        }
        if let Some(law) = config.mode.tracking() {
            law.adapt_state(&mut self.tracking);
        }
        self.three_variable.take_over(self.config.mode.three_variable());
        let late = delay(&self.config);
        if let Some(modifier) = config.mode.modifier().filter(|new| !new.owns(&self.modifier) || new.delay() != late) {
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
        let under_way = self.begun && matches!(state, State::Running | State::Hold | State::RampDown);
        let wired = "a relay that is closed";
        let running = "a test under way";
        let refused = [
            (guarded && config.ramps.is_none() && state != State::Off, "guard", "a test that is not off"),
            (live && !config.mode.is_of_kind(&old.mode), "mode", wired),
            (live && config.cancellation != old.cancellation, "inner_loop", wired),
            (under_way && config.mode.tracking().is_some() != old.mode.tracking().is_some(), "tracking", running),
            (under_way && delay(config) != delay(old), "modification.preview.seconds", running),
        ];
        match refused.into_iter().find(|(refused, ..)| *refused) {
            Some((_, field, with)) => Err(SettingsError::Contradiction { field, with }),
            None => Ok(()),
        }
    }
}

/// Ticks by which the modifier of `config` is late.
fn delay(config: &Config) -> u32 {
    config.mode.modifier().map_or(0, Modifier::delay)
}
