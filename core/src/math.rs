//! The only door to transcendental functions: `libm`, whose bits agree between host and target.
//!
//! None of these is called in a tick: configurations work them out once.

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
