//! Displacement PI: the loop of the paper's Fig. 3.
//!
//! ```text
//! i[k] = i[k-1] + ki dt e[k],   held within +/- limit
//! u[k] = kp e[k] + i[k]
//! ```
//! e and u in m, kp in 1, ki in 1/s. While no limit acts and nothing is [`Blocked`] this is exactly
//! `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`. The integral is kept in the output's unit: a new `ki` counts from now on
//! and makes no bump.

use super::{Blocked, LoopGains};
use crate::scalar::Scalar;

/// Configuration of the displacement loop.
///
/// ```
/// use shakedown_core::blocks::control::{Blocked, DisplacementLoop, DisplacementState, LoopGains};
///
/// // In f64, as fitting runs it: the integral of 10 mm over 1 s is 10 mm s.
/// let law = DisplacementLoop::new(LoopGains { proportional: 0.0, integral: 2.0 }, 1e-3, 0.1);
/// let (mut state, mut command) = (DisplacementState::default(), 0.0_f64);
/// for _ in 0..1000 {
///     command = law.advance(&mut state, 0.01, Blocked::Neither);
/// }
/// assert!((command - 0.02).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementLoop<S = f32> {
    proportional: S,
    integral_step: S,
    limit: S,
}

/// What the displacement loop remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementState<S = f32> {
    /// The integral's share of the command, m.
    pub integral: S,
}

impl<S: Scalar> Default for DisplacementState<S> {
    fn default() -> Self {
        Self { integral: S::ZERO }
    }
}

impl<S: Scalar> DisplacementLoop<S> {
    /// The loop at ticks of `dt` (s) with its integral held within `limit` (m). The caller vouches for finite numbers.
    #[inline]
    pub fn new(gains: LoopGains<S>, dt: S, limit: S) -> Self {
        Self { proportional: gains.proportional, integral_step: gains.integral * dt, limit }
    }

    /// One tick: displacement error (m) in, command (m) out.
    #[inline]
    pub fn advance(&self, state: &mut DisplacementState<S>, error: S, blocked: Blocked) -> S {
        if blocked.allows(error) {
            let integral = state.integral + self.integral_step * error;
            state.integral = integral.bounded(self.limit);
        }
        self.proportional * error + state.integral
    }
}
