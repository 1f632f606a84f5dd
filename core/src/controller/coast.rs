//! What becomes of a streamed reference of which nothing more comes.

use super::Controller;

impl Controller {
    /// How a streamed `reference` (m) goes on when nothing more comes of it and it moved by `step` (m) in the last of ticks of `dt` (s): its next
    /// step, m. It goes no faster than the velocity limit and loses what the envelope plans for a table that stops, so that it goes no
    /// farther than that, nor out of what is believed of a reference; without a guard it stops at once.
    ///
    /// ```
    /// use shakedown_core::settings::GuardSettings;
    /// use shakedown_core::{Controller, Settings};
    ///
    /// let controller = Controller::new(&Settings { guard: Some(GuardSettings::default()), ..Settings::default() })?;
    /// // From 0.2 m/s at 5 m/s2: 4 mm in 40 ms.
    /// let (mut step, mut reference) = (0.2e-3, 0.0);
    /// for _ in 0..41 {
    ///     step = controller.coast(reference, step, 1e-3);
    ///     reference += step;
    /// }
    /// assert!(step.abs() < 1e-9 && (reference - 0.004_f32).abs() < 2e-4);
    /// # Ok::<(), shakedown_core::SettingsError>(())
    /// ```
    pub fn coast(&self, reference: f32, step: f32, dt: f32) -> f32 {
        let next = self.config.monitors.coast(step, dt);
        if self.config.gate.believes(reference + next) { next } else { 0.0 }
    }
}
