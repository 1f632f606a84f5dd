//! Velocity PI, integrated once into a displacement command.
//!
//! ```text
//! i[k] = i[k-1] + ki dt e[k],              held within +/- limit / dt0,  dt0 = 1 s
//! u[k] = u[k-1] + dt (kp e[k] + i[k]),     held within +/- limit
//! ```
//! e in m/s, u in m, kp in 1, ki in 1/s. With an error that is the derivative of a displacement error, the proportional
//! part is `kp` times that displacement error: this is why the paper's velocity gain adds to its displacement gain. The
//! limits bound the state; a velocity measured with an offset is held against by the displacement loop alone, as in
//! the paper.

use super::{Blocked, LoopGains};
use crate::scalar::Scalar;

/// Configuration of the velocity loop.
///
/// ```
/// use shakedown_core::blocks::control::{Blocked, LoopGains, VelocityLoop, VelocityState};
///
/// let law = VelocityLoop::new(LoopGains { proportional: 1.0, integral: 0.0 }, 1e-3, 0.1);
/// let (mut state, mut command) = (VelocityState::default(), 0.0_f64);
/// for _ in 0..100 {
///     command = law.advance(&mut state, 0.1, Blocked::Neither); // 0.1 m/s for 0.1 s
/// }
/// assert!((command - 0.01).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityLoop<S = f32> {
    proportional: S,
    integral_step: S,
    dt: S,
    limit: S,
}

/// What the velocity loop remembers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VelocityState<S = f32> {
    /// The integral term, m/s.
    pub integral: S,
    /// The command, m.
    pub command: S,
}

impl<S: Scalar> Default for VelocityState<S> {
    fn default() -> Self {
        Self { integral: S::ZERO, command: S::ZERO }
    }
}

impl<S: Scalar> VelocityLoop<S> {
    /// The loop at ticks of `dt` (s) with its command held within `limit` (m). The caller vouches for finite numbers.
    #[inline]
    pub fn new(gains: LoopGains<S>, dt: S, limit: S) -> Self {
        Self { proportional: gains.proportional, integral_step: gains.integral * dt, dt, limit }
    }

    /// One tick: velocity error (m/s) in, command (m) out.
    #[inline]
    pub fn advance(&self, state: &mut VelocityState<S>, error: S, blocked: Blocked) -> S {
        if blocked.allows(error) {
            let integral = state.integral + self.integral_step * error;
            state.integral = integral.bounded(self.limit);
        }
        let rate = self.proportional * error + state.integral;
        if blocked.allows(rate) {
            state.command = (state.command + self.dt * rate).bounded(self.limit);
        }
        state.command
    }
}
