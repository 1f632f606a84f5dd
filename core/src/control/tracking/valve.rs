//! Inverse of the servo model's valve: the command that makes the mean flow over the coming tick what is asked for.
//!
//! ```text
//! w = z + b1 u,   z' = -a1 z + (b0 - b1 a1) u - f              Eq. 7 without its integrator; f a force per mass, m/s2
//! mean of w over a tick with u held  =  hz z + hu u
//! u[k] = (w[k] - hz z[k]) / hu,     held within the limit
//! z[k+1] = rho z[k] + (1 - rho) (g u[k] - f / a1)
//! rho = exp(-a1 dt),  hz = (1 - rho) / (a1 dt),  g = b0/a1 - b1,  hu = b1 + g (1 - hz)
//! ```
//! u in m, w in m/s (flow as piston velocity). The model's own zero, `lead = b1 / b0` seconds, is what makes this inverse
//! stable; where it is shorter than two ticks, two ticks are taken, and the flow comes later by the difference.

use crate::block::{BlockError, require};
use crate::math;

/// The inverse's configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{Valve, ValveState};
///
/// let valve = Valve::new([2.39, 0.0173, 0.005], 0.2, 1e-3)?;
/// let (mut state, mut command) = (ValveState::default(), 0.0);
/// for _ in 0..500 {
///     (command, _) = valve.advance(&mut state, 0.1, 0.0);
/// }
/// assert!((command - 0.1 / 2.39).abs() < 1e-4); // settled: flow over gain
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Valve {
    rho: f32,
    drive: f32,
    force: f32,
    hz: f32,
    hu: f32,
    per_hu: f32,
    limit: f32,
}

/// What the inverse remembers: the valve's lagging part, m/s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ValveState {
    lag: f32,
}

impl Valve {
    /// For a valve of `gain` (1/s: b0 / a1), `lag` (s: 1 / a1, from a tenth of a tick) and `lead` (s: b1 / b0, 0 to half
    /// the lag) at ticks of `dt` (s), its command held within `limit` (m).
    pub fn new([gain, lag, lead]: [f32; 3], limit: f32, dt: f32) -> Result<Self, BlockError> {
        let lag = require("valve.lag", lag, 0.1 * dt, 10.0)?;
        let lead = math::max(require("tracking.lead", lead, 0.0, 0.5 * lag)?, 2.0 * dt);
        let lead = math::min(lead, lag);
        let decay = -math::exp_m1(-dt / lag);
        let hz = decay * lag / dt;
        let b1 = gain * lead / lag;
        let g = gain - b1;
        let hu = b1 + g * (1.0 - hz);
        Ok(Self { rho: 1.0 - decay, drive: decay * g, force: decay * lag, hz, hu, per_hu: 1.0 / hu, limit })
    }

    /// One tick: mean flow wanted (m/s) and force per mass expected (m/s2) in, command (m) and the mean flow it makes
    /// (m/s) out.
    #[inline]
    pub fn advance(&self, state: &mut ValveState, flow: f32, force: f32) -> (f32, f32) {
        let coasts = self.hz * state.lag;
        let wanted = self.per_hu * (flow - coasts);
        let (command, made) = if wanted.abs() <= self.limit {
            (wanted, flow)
        } else {
            let held = if wanted > 0.0 { self.limit } else { -self.limit };
            (held, coasts + self.hu * held)
        };
        state.lag = self.rho * state.lag + self.drive * command - self.force * force;
        (command, made)
    }
}
