//! The biquad: any second-order section, in the trapezoidal state-variable form.
//!
//! ```text
//! v3 = x[k] - s2          g = tan(pi f / rate),  r = 1 / Q = 2 zeta
//! v1 = c1 s1 + c2 v3      c1 = 1 / (1 + g (g + r)),  c2 = g c1,  c3 = g c2
//! v2 = s2 + c2 s1 + c3 v3
//! s1 = 2 v1 - s1,   s2 = 2 v2 - s2
//! y[k] = m0 x[k] + m1 v1 + m2 v2
//! ```
//! The transfer function is exactly the bilinear transform of `(m0 s^2 + (m0 r + m1) w s + (m0 + m2) w^2) /
//! (s^2 + r w s + w^2)`, prewarped at `f`, that a direct-form biquad has. The form differs where `f32` matters: a
//! direct form keeps a low corner as a small difference of coefficients near 2 and 1 and loses it below a thousandth
//! of the rate; here `g` is itself the small number, and corners of 0.01 Hz at 1 kHz keep their six digits.
//! Sign kept; output in the input's unit.

use core::f32::consts::PI;

use crate::block::{Block, BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// A section's configuration.
///
/// ```
/// use shakedown_core::blocks::Block;
/// use shakedown_core::blocks::filter::SecondOrder;
///
/// let low_pass = SecondOrder::<f32>::low_pass(10.0, 0.7, 1e-3)?;
/// let mut state = Default::default();
/// let settled = (0..2000).map(|_| low_pass.advance(&mut state, 1.0)).last();
/// assert!((settled.unwrap() - 1.0).abs() < 1e-5);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondOrder<S = f32> {
    c1: S,
    c2: S,
    c3: S,
    m0: S,
    m1: S,
    m2: S,
}

/// What a section remembers: two states in the input's unit, and its output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondOrderState<S = f32> {
    s1: S,
    s2: S,
    output: S,
}

impl<S: Scalar> Default for SecondOrderState<S> {
    fn default() -> Self {
        Self { s1: S::ZERO, s2: S::ZERO, output: S::ZERO }
    }
}

impl<S: Scalar> SecondOrder<S> {
    /// Low-pass: gain 1 at rest, 0 at the Nyquist frequency. `frequency` in Hz, `damping` ratio zeta (1).
    pub fn low_pass(frequency: f32, damping: f32, dt: f32) -> Result<Self, BlockError> {
        Self::design(frequency, damping, dt, |_| [0.0, 0.0, 1.0])
    }

    /// High-pass: gain 0 at rest, 1 at the Nyquist frequency. `frequency` in Hz, `damping` ratio zeta (1).
    pub fn high_pass(frequency: f32, damping: f32, dt: f32) -> Result<Self, BlockError> {
        Self::design(frequency, damping, dt, |r| [1.0, -r, -1.0])
    }

    /// Notch: gain 0 at `frequency` (Hz), 1 far from it; its width is 2 `damping` times the frequency.
    pub fn notch(frequency: f32, damping: f32, dt: f32) -> Result<Self, BlockError> {
        Self::design(frequency, damping, dt, |r| [1.0, -r, 0.0])
    }

    /// Frequency from 1e-3 Hz to 0.45 of the rate, damping from 0.005 to 10.
    fn design(frequency: f32, damping: f32, dt: f32, mix: fn(f32) -> [f32; 3]) -> Result<Self, BlockError> {
        let dt = require("dt", dt, 1e-6, 1.0)?;
        let frequency = require("frequency", frequency, 1e-3, 0.45 / dt)?;
        let r = 2.0 * require("damping", damping, 0.005, 10.0)?;
        let g = math::tan(PI * frequency * dt);
        let c1 = 1.0 / (1.0 + g * (g + r));
        let [m0, m1, m2] = mix(r);
        let c = S::from_f32;
        Ok(Self { c1: c(c1), c2: c(g * c1), c3: c(g * g * c1), m0: c(m0), m1: c(m1), m2: c(m2) })
    }
}

impl<S: Scalar> Block<S> for SecondOrder<S> {
    type State = SecondOrderState<S>;

    #[inline]
    fn advance(&self, state: &mut SecondOrderState<S>, input: S) -> S {
        let v3 = input - state.s2;
        let v1 = self.c1 * state.s1 + self.c2 * v3;
        let v2 = state.s2 + self.c2 * state.s1 + self.c3 * v3;
        state.s1 = v1 + (v1 - state.s1);
        state.s2 = v2 + (v2 - state.s2);
        state.output = self.m0 * input + self.m1 * v1 + self.m2 * v2;
        state.output
    }

    #[inline]
    fn last(&self, state: &SecondOrderState<S>) -> S {
        state.output
    }
}
