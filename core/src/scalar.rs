//! The numbers a linear law can run on.
//!
//! A law of this crate ships in `f32`. Fitting a model to recordings needs the derivatives of the very same law, so the
//! linear blocks are generic over this trait: `f32` is what the device and every verification run use, `f64` serves
//! comparisons against closed forms, and a host's forward-mode duals carry derivatives through the same lines of code.
//! The trait is therefore open: it asks only for what the recurrences use. It offers no division and no
//! transcendental function, because none belongs in a tick.

use core::ops::{Add, Mul, Neg, Sub};

/// A real number, as far as a linear recurrence is concerned.
///
/// Order compares the value alone: where a limit acts, a dual's derivative is that of the branch taken.
///
/// ```
/// use shakedown_core::blocks::Scalar;
///
/// assert_eq!(0.3_f32.bounded(0.1), 0.1);
/// assert_eq!((-0.3_f64).within(-0.2, 0.1), -0.2);
/// ```
pub trait Scalar:
    Copy + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Zero, with no derivatives.
    const ZERO: Self;

    /// `value` as a constant, with no derivatives.
    fn from_f32(value: f32) -> Self;

    /// Held between two limits, `low <= high`. A NaN stays one.
    #[inline]
    #[must_use]
    fn within(self, low: Self, high: Self) -> Self {
        if self < low {
            low
        } else if self > high {
            high
        } else {
            self
        }
    }

    /// Held within `limit` of zero, `limit >= 0`. A NaN stays one.
    #[inline]
    #[must_use]
    fn bounded(self, limit: Self) -> Self {
        self.within(-limit, limit)
    }
}

impl Scalar for f32 {
    const ZERO: Self = 0.0;

    #[inline]
    fn bounded(self, limit: Self) -> Self {
        // Inside, where a law nearly always is, this is one comparison.
        if self.abs() <= limit { self } else { self.within(-limit, limit) }
    }

    #[inline]
    fn from_f32(value: f32) -> Self {
        value
    }
}

impl Scalar for f64 {
    const ZERO: Self = 0.0;

    #[inline]
    fn from_f32(value: f32) -> Self {
        Self::from(value)
    }
}
