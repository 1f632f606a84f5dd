//! The paper's record modification: its Eq. 10 and Fig. 14, in real time.
//!
//! `x_hat(t)` is the integral of the reference's velocity clamped to the limit. What the clamp cuts off is never made up,
//! so the displacement drifts (0.22 m on Rinaldi 228 at 0.242 m/s), and no stroke is respected: it stands here as the
//! paper has it, for comparison.

use super::ReferenceLimits;
use super::input::Input;
use super::travel::{Integrator, TickLimits};
use crate::math::{max, min};
use crate::settings::SettingsError;

/// What is set before a test.
///
/// ```
/// use shakedown_core::blocks::record::{ReferenceLimits, clip};
///
/// let config = clip::Config::new(&ReferenceLimits::new(1000.0, 0.242, 0.12))?;
/// let mut state = clip::State::at(0.0);
/// // 1 m/s asked for, 0.242 m/s let through.
/// assert!((clip::step(&config, &mut state, 0.001, 0.242) - 0.242e-3).abs() < 1e-8);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    walls: TickLimits,
}

impl Config {
    /// A clip at the limits' velocity. The stroke is not used.
    pub fn new(limits: &ReferenceLimits) -> Result<Self, SettingsError> {
        limits.validate()?;
        Ok(Self { walls: TickLimits::new(limits) })
    }
}

/// What changes during a test.
#[derive(Debug, Clone, Copy)]
pub struct State {
    input: Input,
    output: Integrator,
    limited: bool,
}

impl State {
    /// At rest at `reference`, m.
    pub fn at(reference: f32) -> Self {
        let input = Input::at(reference);
        Self { input, output: Integrator::at(input.displacement), limited: false }
    }

    /// Goes on after ticks that were not heard, with `reference` (m) the next: what it moved meanwhile is washed out.
    pub fn resume(&mut self, reference: f32) {
        self.input.resume(reference);
    }

    /// The last reference was not a number, or leapt, and was not followed.
    pub fn held(&self) -> bool {
        self.input.held
    }

    /// The last output moved at its limit.
    pub fn limited(&self) -> bool {
        self.limited
    }
}

/// One tick: `reference` in m, `velocity_limit_now` in m/s; gives the modified reference, m.
pub fn step(config: &Config, state: &mut State, reference: f32, velocity_limit_now: f32) -> f32 {
    let walls = &config.walls;
    state.input.accept(reference, walls.leap, walls.brake);
    let limit = walls.step_now(velocity_limit_now);
    let kept = max(min(state.input.step, limit), -limit);
    state.limited = kept != state.input.step;
    state.output.advance(kept)
}
