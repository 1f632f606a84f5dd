//! First-order washout, `s / (s + w)`: passes change, forgets what stays.
//!
//! ```text
//! y[k] = rho y[k-1] + g (x[k] - x[k-1]),      rho = exp(-2 pi f dt),  g = (1 + rho) / 2
//! ```
//! Gain 0 at rest and 1 at the Nyquist frequency, sign kept, output in the input's unit.

use crate::block::{Block, BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// A washout's configuration.
///
/// ```
/// use shakedown_core::blocks::Block;
/// use shakedown_core::blocks::filter::{Washout, WashoutState};
///
/// let washout = Washout::<f32>::new(0.05, 1e-3)?;
/// // Switched on at an offset it starts at zero.
/// assert_eq!(washout.advance(&mut WashoutState::at(0.3), 0.3), 0.0);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Washout<S = f32> {
    rho: S,
    gain: S,
}

/// What a washout remembers: its last input and its output. The default has stood at zero for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WashoutState<S = f32> {
    input: S,
    output: S,
}

impl<S: Scalar> Default for WashoutState<S> {
    fn default() -> Self {
        Self::at(S::ZERO)
    }
}

impl<S: Scalar> WashoutState<S> {
    /// As after an input that has stood at `input` for ever: switched on at an offset, a washout starts at zero.
    pub fn at(input: S) -> Self {
        Self { input, output: S::ZERO }
    }
}

impl<S: Scalar> Washout<S> {
    /// A washout with its corner at `frequency` (Hz, from 1e-4 up to a tenth of the rate) at ticks of `dt` (s).
    pub fn new(frequency: f32, dt: f32) -> Result<Self, BlockError> {
        let dt = require("dt", dt, 1e-6, 1.0)?;
        let frequency = require("frequency", frequency, 1e-4, 0.1 / dt)?;
        let rho = math::exp(-core::f32::consts::TAU * frequency * dt);
        Ok(Self { rho: S::from_f32(rho), gain: S::from_f32(0.5 * (1.0 + rho)) })
    }
}

impl<S: Scalar> Block<S> for Washout<S> {
    type State = WashoutState<S>;

    #[inline]
    fn advance(&self, state: &mut WashoutState<S>, input: S) -> S {
        state.output = self.rho * state.output + self.gain * (input - state.input);
        state.input = input;
        state.output
    }

    #[inline]
    fn last(&self, state: &WashoutState<S>) -> S {
        state.output
    }
}
