//! Record modification with no preview: drift-free, inside the stroke, and nearer the reference than clipping.
//!
//! In metres a tick, with r the reference's step, u the output's, x and y their displacements, e = r - u:
//!
//! ```text
//! g = 1 - (1 - V/R) (1 + q)/2          where R > V, else 1; q = u/V toward which r is moving, -1 to 1
//! u = u + g (r - r_before) + c e + k (x - y)       then kept to the speed and to what the stroke can still brake
//! ```
//!
//! With g = 1 and no walls this is the reference itself. A wall pushes e as the play operator does: e
//! changes only while the wall is touched and the reference presses on it. So an excess is paid for once, where clipping
//! pays on the way out and again on the way back. The washout c, k then returns e and its integral to zero.
//!
//! R is the reference's largest step of late. Once it has been over the limit V, a swing is expected to go there again:
//! it is compressed as it leaves the opposite wall instead of being cut at this one, which spreads the same loss of
//! velocity over the whole swing (least squares prefers that) and takes the peak off the error. A record that has kept
//! inside the limit is never touched.
//!
//! Cost: about 40 floating-point operations, one square root for each end of the stroke, no loop.

use super::input::Input;
use super::travel::{Integrator, TickLimits};
use super::{DriftRecovery, ReferenceLimits, within};
use crate::math::{max, min};
use crate::settings::SettingsError;

/// What is set before a test.
///
/// ```
/// use shakedown_core::blocks::record::{ReferenceLimits, causal};
///
/// let limits = ReferenceLimits::new(1000.0, 0.242, 0.12);
/// let config = causal::Config::new(&limits, &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY)?;
/// let mut state = causal::State::at(0.0);
/// // A reference within the limits is not touched.
/// assert!((causal::step(&config, &mut state, 1e-4, 0.242) - 1e-4).abs() < 1e-9);
/// # Ok::<(), shakedown_core::SettingsError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    walls: TickLimits,
    velocity_share: f32,
    displacement_share: f32,
    decay: f32,
}

impl Config {
    /// The washout and the memory for the reference's peak, s, with which the benches' figures are taken. Chosen on
    /// generated records, none of them among those the figures are reported for.
    pub const DRIFT_RECOVERY: DriftRecovery = DriftRecovery { frequency: 0.4, damping: 0.8 };
    /// See [`Config::DRIFT_RECOVERY`].
    pub const MEMORY: f32 = 4.0;

    /// A modifier that stays within `limits` and forgets the reference's peak velocity with time constant `memory`, s.
    pub fn new(limits: &ReferenceLimits, washout: &DriftRecovery, memory: f32) -> Result<Self, SettingsError> {
        limits.validate()?;
        washout.validate(limits.rate)?;
        within("memory", memory, 0.1, 1000.0)?;
        let (velocity_share, displacement_share) = washout.shares(limits.rate);
        let decay = 1.0 - 1.0 / (limits.rate * memory);
        Ok(Self { walls: TickLimits::new(limits), velocity_share, displacement_share, decay })
    }
}

/// What changes during a test.
#[derive(Debug, Clone, Copy)]
pub struct State {
    input: Input,
    output: Integrator,
    peak: f32,
    limited: bool,
}

impl State {
    /// At rest at `reference`, m.
    pub fn at(reference: f32) -> Self {
        let input = Input::at(reference);
        Self { input, output: Integrator::at(input.displacement), peak: 0.0, limited: false }
    }

    /// Goes on after ticks that were not heard, with `reference` (m) the next: what it moved meanwhile is washed out.
    pub fn resume(&mut self, reference: f32) {
        self.input.resume(reference);
    }

    /// The last reference was not a number, or leapt, and was not followed.
    pub fn held(&self) -> bool {
        self.input.held
    }

    /// The last output met a wall: the speed in force or the room left to stop in.
    pub fn limited(&self) -> bool {
        self.limited
    }
}

/// One tick: `reference` in m, `velocity_limit_now` in m/s; gives the modified reference, m.
pub fn step(config: &Config, state: &mut State, reference: f32, velocity_limit_now: f32) -> f32 {
    let walls = &config.walls;
    let limit = walls.step_now(velocity_limit_now);
    let velocity_error = state.input.step - state.output.step;
    let displacement_error = state.output.behind(state.input.displacement);
    let before = state.input.step;

    state.input.accept(reference, walls.leap, walls.brake);
    let wish = state.input.step;
    let change = wish - before;
    state.peak = max(state.peak * config.decay, wish.abs());

    let returned = config.velocity_share * velocity_error + config.displacement_share * displacement_error;
    let want = (wish - velocity_error) + returned - given_up(change, state.output.step, state.peak, limit);
    let kept = walls.keep(want, limit, state.output.displacement);
    state.limited = kept != want;
    state.output.advance(kept)
}

/// The part of the reference's `change` that a swing expected to exceed `limit` is spared, (1 - g) `change`.
fn given_up(change: f32, step: f32, peak: f32, limit: f32) -> f32 {
    if peak <= limit {
        return 0.0;
    }
    let outward = if change < 0.0 { -step } else { step };
    // A limit lowered to nothing leaves no way to go: whatever moves, moves outward.
    let progress = if limit > 0.0 { max(min(outward / limit, 1.0), -1.0) } else { 1.0 };
    change * (1.0 - limit / peak) * 0.5 * (1.0 + progress)
}
