//! Feedback laws of the paper's Fig. 12, one a file.
//!
//! Signs: an error is reference less measurement; a positive command moves the table toward positive displacement.
//! Every loop's output is a command in m, and the loops add up.

pub(crate) mod acceleration;
pub(crate) mod cancellation;
pub(crate) mod displacement;
pub(crate) mod tracking;
pub(crate) mod velocity;

pub(crate) use acceleration::{AccelerationLoop, AccelerationState};
pub use cancellation::InnerLoop;
pub(crate) use displacement::{DisplacementLoop, DisplacementState};
pub(crate) use tracking::{Tracking, TrackingState};
pub(crate) use velocity::{VelocityLoop, VelocityState};

use crate::scalar::Scalar;

/// The direction in which more command moves nothing: the valve or the command is at its limit there.
///
/// Integrators stop for errors that push farther that way and go on for errors that lead back.
///
/// ```
/// use shakedown_core::blocks::control::Blocked;
///
/// assert!(!Blocked::Positive.allows(0.01));
/// assert!(Blocked::Positive.allows(-0.01)); // leads back
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Blocked {
    /// Neither.
    #[default]
    Neither,
    /// Toward positive displacement.
    Positive,
    /// Toward negative displacement.
    Negative,
}

impl Blocked {
    /// Whether an integrator may take in `error`.
    #[inline]
    pub fn allows<S: Scalar>(self, error: S) -> bool {
        match self {
            Self::Neither => true,
            Self::Positive => error <= S::ZERO,
            Self::Negative => error >= S::ZERO,
        }
    }
}

/// Gains of one loop in the number type of the law, with their ranges checked.
///
/// ```
/// use shakedown_core::blocks::control::{DisplacementLoop, LoopGains};
///
/// let law = DisplacementLoop::new(LoopGains { proportional: 3.7, integral: 0.6 }, 1e-3, 0.1_f32);
/// assert!((law.advance(&mut Default::default(), 0.01, Default::default()) - 0.037).abs() < 1e-5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopGains<S = f32> {
    /// Proportional gain, 1.
    pub proportional: S,
    /// Integral gain, 1/s.
    pub integral: S,
}
