//! Band-limited differentiator, `s / (1 + s / w)`, by the trapezoidal rule.
//!
//! ```text
//! d[k] = alpha d[k-1] + beta (x[k] - x[k-1])
//! h = pi f dt,    alpha = (1 - h) / (1 + h),    beta = 2 h / ((1 + h) dt)
//! ```
//! Output in the input's unit per second, sign kept. At its widest band, `f = rate / pi`, alpha is 0 and beta is the
//! rate: the plain backward difference. The sum of `d[k] dt` is the input less its start, lagged by `1 / (2 pi f)`:
//! nothing drifts between a signal and the integral of its derivative.

use core::f32::consts::PI;

use crate::block::{Block, BlockError, require};
use crate::scalar::Scalar;

/// A differentiator's configuration.
///
/// ```
/// use shakedown_core::blocks::Block;
/// use shakedown_core::blocks::filter::{Differentiator, DifferentiatorState};
///
/// let differentiator = Differentiator::<f32>::new(1000.0, 1e-3)?; // so wide that it is the backward difference
/// let mut state = DifferentiatorState::at(0.0);
/// assert!((differentiator.advance(&mut state, 1e-4) - 0.1).abs() < 1e-6);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Differentiator<S = f32> {
    alpha: S,
    beta: S,
}

/// What a differentiator remembers: its last input and its output. The default has stood at zero for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DifferentiatorState<S = f32> {
    input: S,
    output: S,
}

impl<S: Scalar> Default for DifferentiatorState<S> {
    fn default() -> Self {
        Self::at(S::ZERO)
    }
}

impl<S: Scalar> DifferentiatorState<S> {
    /// As after an input that has stood at `input` for ever.
    pub fn at(input: S) -> Self {
        Self { input, output: S::ZERO }
    }
}

impl<S: Scalar> Differentiator<S> {
    /// A differentiator up to `frequency` (Hz, from 0.1; from rate / pi on it is the backward difference) at ticks of
    /// `dt` (s).
    pub fn new(frequency: f32, dt: f32) -> Result<Self, BlockError> {
        let dt = require("dt", dt, 1e-6, 1.0)?;
        let frequency = require("frequency", frequency, 0.1, 1e6)?;
        let h = PI * frequency * dt;
        let (alpha, beta) = if h < 1.0 { ((1.0 - h) / (1.0 + h), 2.0 * h / ((1.0 + h) * dt)) } else { (0.0, 1.0 / dt) };
        Ok(Self { alpha: S::from_f32(alpha), beta: S::from_f32(beta) })
    }
}

impl<S: Scalar> Block<S> for Differentiator<S> {
    type State = DifferentiatorState<S>;

    #[inline]
    fn advance(&self, state: &mut DifferentiatorState<S>, input: S) -> S {
        state.output = self.alpha * state.output + self.beta * (input - state.input);
        state.input = input;
        state.output
    }

    #[inline]
    fn last(&self, state: &DifferentiatorState<S>) -> S {
        state.output
    }
}
