//! Disturbance observer of a table that moves as the oil flows: what the velocity is beyond the flow that was asked for.
//!
//! ```text
//! d[k] = d[k-1] + alpha (v[k] - q[k] - d[k-1]),      alpha = 1 - exp(-2 pi f dt),   held within +/- limit
//! ```
//! v is the measured mean velocity over the last tick, q the flow that was to be made in it, both m/s; so d is in m/s,
//! positive where the table is faster than the model. Taken off the next flow it makes the loop's sensitivity
//! `s / (s + 2 pi f)`: errors of gain, pole and offset die out below f. While the table moves at the limit and more than the
//! limit is asked for, the difference says nothing of the model and d stands.

use crate::block::{BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// Share of the velocity limit from which the table is at it.
const NEAR: f32 = 0.98;

/// The observer's configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{Disturbance, DisturbanceState};
///
/// let observer = Disturbance::new(50.0, 0.242, 1e-3)?;
/// let mut state = DisturbanceState::default();
/// let mut lost = 0.0;
/// for _ in 0..200 {
///     lost = observer.advance(&mut state, 0.08, 0.1); // the table moves 0.02 m/s slower than the flow made
/// }
/// assert!((lost + 0.02).abs() < 1e-4);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disturbance {
    alpha: f32,
    limit: f32,
    near: f32,
}

/// What the observer remembers: the disturbance, m/s.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DisturbanceState {
    /// m/s.
    pub flow: f32,
}

impl Disturbance {
    /// An observer up to `frequency` (Hz, 0 to a fifth of the rate; 0 for none) for a velocity `limit` (m/s), twice
    /// which the estimate stays within, at ticks of `dt` (s).
    pub fn new(frequency: f32, limit: f32, dt: f32) -> Result<Self, BlockError> {
        let frequency = require("tracking.disturbance", frequency, 0.0, 0.2 / dt)?;
        Ok(Self {
            alpha: -math::exp_m1(-core::f32::consts::TAU * frequency * dt),
            limit: 2.0 * limit,
            near: NEAR * limit,
        })
    }

    /// One tick: mean velocity measured and flow made, both over the last tick, m/s.
    #[inline]
    pub fn advance(&self, state: &mut DisturbanceState, velocity: f32, flow: f32) -> f32 {
        if velocity.abs() < self.near || flow.abs() < self.near {
            let next = state.flow + self.alpha * (velocity - flow - state.flow);
            state.flow = next.bounded(self.limit);
        }
        state.flow
    }
}
