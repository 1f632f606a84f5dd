//! Acceleration PI, integrated twice into a displacement command, with a washout so that it cannot drift.
//!
//! ```text
//! h[k] = rho h[k-1] + g (e[k] - e[k-1])                washout, g = (1 + rho) / 2
//! i[k] = rho i[k-1] + ki dt h[k]
//! w[k] = rho w[k-1] + dt (kp h[k] + i[k])              m/s
//! u[k] = rho u[k-1] + dt w[k],                         m
//! rho = exp(-2 pi f dt)
//! ```
//! the last held within +/- limit, the others within a hundred times that. e in m/s2, u in m, kp in 1, ki in 1/s. Above the washout's frequency f this is
//! `(kp + ki / s) / s^2`, the double integration of Fig. 12. Below it every integrator leaks and the washout removes what
//! stays: a constant error of any size, an accelerometer's bias among them, ends in a command of exactly zero in the
//! limit, and a bounded error can never move the command beyond `(kp + ki / w) |e| / w^2`, w = 2 pi f.

use super::{Blocked, LoopGains};
use crate::block::{BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// Configuration of the acceleration loop.
///
/// ```
/// use shakedown_core::blocks::control::{AccelerationLoop, AccelerationState, Blocked, LoopGains};
///
/// let gains = LoopGains { proportional: 0.02, integral: 0.0 };
/// let law = AccelerationLoop::<f32>::new(gains, 1e-3, 0.05, 0.1)?;
/// let (mut state, mut command) = (AccelerationState::default(), 0.0);
/// for _ in 0..100 {
///     command = law.advance(&mut state, 1.0, Blocked::Neither); // 0.02 * 1 m/s2 * (0.1 s)^2 / 2
/// }
/// assert!((command - 1e-4).abs() < 5e-6);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationLoop<S = f32> {
    proportional: S,
    integral_step: S,
    dt: S,
    rho: S,
    gain: S,
    limit: S,
    /// Bound of what is not yet a displacement: a hundred times the limit, in 1/s and 1/s2.
    wide: S,
}

/// What the acceleration loop remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AccelerationState<S = f32> {
    error: S,
    washed: S,
    /// The integral term, m/s2.
    pub integral: S,
    /// First integral, m/s.
    pub rate: S,
    /// The command, m.
    pub command: S,
}

impl<S: Scalar> Default for AccelerationState<S> {
    fn default() -> Self {
        Self { error: S::ZERO, washed: S::ZERO, integral: S::ZERO, rate: S::ZERO, command: S::ZERO }
    }
}

impl<S: Scalar> AccelerationLoop<S> {
    /// The loop at ticks of `dt` (s), with its washout at `frequency` (Hz, 1e-3 up to a hundredth of the rate) and its
    /// command held within `limit` (m). The caller vouches for finite gains.
    pub fn new(gains: LoopGains<S>, dt: f32, frequency: f32, limit: f32) -> Result<Self, BlockError> {
        let frequency = require("washout_frequency", frequency, 1e-3, 0.01 / dt)?;
        let rho = math::exp(-core::f32::consts::TAU * frequency * dt);
        Ok(Self {
            proportional: gains.proportional,
            integral_step: gains.integral * S::from_f32(dt),
            dt: S::from_f32(dt),
            rho: S::from_f32(rho),
            gain: S::from_f32(0.5 * (1.0 + rho)),
            limit: S::from_f32(limit),
            wide: S::from_f32(100.0 * limit),
        })
    }

    /// One tick: acceleration error (m/s2) in, command (m) out.
    #[inline]
    pub fn advance(&self, state: &mut AccelerationState<S>, error: S, blocked: Blocked) -> S {
        state.washed = self.rho * state.washed + self.gain * (error - state.error);
        state.error = error;
        let more = if blocked.allows(state.washed) { self.integral_step * state.washed } else { S::ZERO };
        state.integral = (self.rho * state.integral + more).bounded(self.wide);
        let push = self.proportional * state.washed + state.integral;
        let more = if blocked.allows(push) { self.dt * push } else { S::ZERO };
        state.rate = (self.rho * state.rate + more).bounded(self.wide);
        state.command = (self.rho * state.command + self.dt * state.rate).bounded(self.limit);
        state.command
    }
}
