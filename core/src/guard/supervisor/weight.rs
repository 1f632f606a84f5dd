//! How a weight between 0 and 1 rises and falls, and the smooth step that is taken of it.

#[inline]
pub(super) fn up(weight: f32, step: f32) -> f32 {
    // Half a step of slack: rounding must not add a tick.
    let next = weight + step;
    if next < 1.0 - 0.5 * step { next } else { 1.0 }
}

#[inline]
pub(super) fn down(weight: f32, step: f32) -> f32 {
    let next = weight - step;
    if next > 0.5 * step { next } else { 0.0 }
}

/// The smooth step 3 p^2 - 2 p^3.
#[inline]
pub(super) fn smooth(p: f32) -> f32 {
    p * p * (3.0 - 2.0 * p)
}
