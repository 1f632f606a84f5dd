//! The only door to transcendental functions: `libm`, whose bits agree between host and target.
//!
//! In a tick only comparisons and, near the end of the stroke, the square root are called; configurations work the
//! rest out once.

/// A limit on the magnitude of a number, kept so that what is within it is told by one comparison of whole numbers: bits
/// without the sign are in the order of the magnitudes, and what is no number lies beyond all of them.
///
/// ```
/// use shakedown_core::blocks::math::Magnitude;
///
/// let limit = Magnitude::new(0.1);
/// assert!(limit.holds(-0.1) && !limit.holds(0.11) && !limit.holds(f32::NAN));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Magnitude(u32);

impl Magnitude {
    /// Nothing but zero is within it.
    pub const ZERO: Self = Self(0);

    /// Within `limit`, itself included; infinity lets every number pass. The limit's sign does not matter.
    #[inline]
    pub const fn new(limit: f32) -> Self {
        Self(limit.to_bits() << 1)
    }

    /// Whether `value` is within.
    #[inline]
    pub const fn holds(self, value: f32) -> bool {
        value.to_bits() << 1 <= self.0
    }
}

/// The smaller of two numbers. Where either is NaN the second is given; a plain comparison, where `f32::min` is a call on
/// a target without the instruction.
#[inline]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger of two numbers, in the same way.
#[inline]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Square root; NaN for negative input.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Natural exponential.
#[inline]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Exponential less one, exact to the last bits for small `x`.
#[inline]
pub fn exp_m1(x: f32) -> f32 {
    libm::expm1f(x)
}

/// Sine of an angle in rad; configurations only.
#[inline]
pub fn sin(x: f32) -> f32 {
    libm::sinf(x)
}

/// Tangent of an angle in rad.
#[inline]
pub fn tan(x: f32) -> f32 {
    libm::tanf(x)
}

/// Largest whole number not above `x`.
#[inline]
pub fn floor(x: f32) -> f32 {
    libm::floorf(x)
}

/// `x` to the power of `y`; configurations only.
#[inline]
pub fn pow(x: f32, y: f32) -> f32 {
    libm::powf(x, y)
}
