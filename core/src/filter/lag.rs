//! First-order lag, `1 / (tau s + 1)`.
//!
//! ```text
//! y[k] = y[k-1] + alpha (x[k] - y[k-1]),      alpha = 1 - exp(-dt / tau)
//! ```
//! Exact for an input that is constant between ticks. Gain 1 at rest, sign kept, output in the input's unit. `alpha`
//! comes from `expm1`, so that a lag of a minute at 10 kHz is still as long as it was asked to be.

use crate::block::{Block, BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// A lag's configuration.
///
/// ```
/// use shakedown_core::blocks::Block;
/// use shakedown_core::blocks::filter::{Lag, LagState};
///
/// let lag = Lag::<f32>::new(0.05, 1e-3)?;
/// let mut state = LagState::at(1.0);
/// assert_eq!(lag.advance(&mut state, 1.0), 1.0); // at rest
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag<S = f32> {
    alpha: S,
}

/// What a lag remembers: its output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LagState<S = f32> {
    output: S,
}

impl<S: Scalar> Default for LagState<S> {
    fn default() -> Self {
        Self { output: S::ZERO }
    }
}

impl<S: Scalar> LagState<S> {
    /// The output of the last tick.
    pub fn output(&self) -> S {
        self.output
    }

    /// A lag that has stood at `output` for ever.
    pub fn at(output: S) -> Self {
        Self { output }
    }
}

impl<S: Scalar> Lag<S> {
    /// A lag of `time` (s, 0 to 1000; 0 passes the input through) at ticks of `dt` (s).
    pub fn new(time: f32, dt: f32) -> Result<Self, BlockError> {
        let dt = require("dt", dt, 1e-6, 1.0)?;
        let time = require("time", time, 0.0, 1000.0)?;
        let alpha = if time > 0.0 { -math::exp_m1(-dt / time) } else { 1.0 };
        Ok(Self { alpha: S::from_f32(alpha) })
    }
}

impl<S: Scalar> Block<S> for Lag<S> {
    type State = LagState<S>;

    #[inline]
    fn advance(&self, state: &mut LagState<S>, input: S) -> S {
        state.output = state.output + self.alpha * (input - state.output);
        state.output
    }

    #[inline]
    fn last(&self, state: &LagState<S>) -> S {
        state.output
    }
}
