//! The only door to transcendental functions: `libm`, whose bits agree between host and target.

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
