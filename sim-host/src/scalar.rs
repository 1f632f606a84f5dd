//! Numbers a model can be run on: `f64`, and forward-mode duals that carry derivatives along.
//!
//! A [`Dual<N>`] holds a value and its derivatives with respect to N parameters. Comparisons look at the value alone,
//! so that branches (limits, deadbands) are taken as the value takes them and the derivative is that of the branch.
//!
//! Values have double precision, derivatives single: seven digits tell a fit where to step and how sure it is, and take half
//! the room.

mod dual;
mod shift;

pub(crate) use dual::Dual;
pub(crate) use shift::earlier;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Standard gravity, m/s2: the `g` of every file, label and equation.
pub const GRAVITY: f64 = 9.806_65;

/// A real number a model can be run on.
pub trait Scalar:
    Copy
    + Send
    + Sync
    + PartialOrd
    + std::fmt::Debug
    + From<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + 'static
{
    /// Numbers it consists of: the value and its derivatives.
    const PARTS: usize;
    /// One of those numbers, the value first.
    fn part(&self, i: usize) -> f64;
    /// From those numbers.
    fn from_parts(part: impl Fn(usize) -> f64) -> Self;

    /// The value without its derivatives.
    fn value(self) -> f64;
    /// Applies a function known by its value and derivative at this point.
    fn chain(self, value: f64, derivative: f64) -> Self;
    /// The same number, derivatives that have died away being nothing: a processor takes a hundred times as long over
    /// numbers at the end of its range.
    #[inline]
    fn settled(self) -> Self {
        self
    }

    /// True for zero of which no derivative is asked: what is multiplied by it is not there.
    fn is_nothing(&self) -> bool {
        (0..Self::PARTS).all(|i| self.part(i) == 0.0)
    }

    /// `self + a b`.
    #[inline]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
    /// `self + a factor`.
    #[inline]
    fn plus_scaled(self, a: Self, factor: f64) -> Self {
        self + a * factor
    }

    /// Natural exponential.
    #[inline]
    fn exp(self) -> Self {
        let e = self.value().exp();
        self.chain(e, e)
    }
    /// Natural logarithm.
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value().ln(), 1.0 / self.value())
    }
    /// Square root; the derivative at zero is taken as zero, so that a trajectory through it stays finite.
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.chain(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }
    /// Hyperbolic tangent.
    #[inline]
    fn tanh(self) -> Self {
        let t = self.value().tanh();
        self.chain(t, 1.0 - t * t)
    }
    /// Sine.
    fn sin(self) -> Self {
        self.chain(self.value().sin(), self.value().cos())
    }
    /// Cosine.
    fn cos(self) -> Self {
        self.chain(self.value().cos(), -self.value().sin())
    }
    /// Power with a real exponent that carries derivatives too; the base must be positive.
    fn pow(self, exponent: Self) -> Self {
        (self.ln() * exponent).exp()
    }
    /// Magnitude.
    #[inline]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
    /// The larger of two.
    #[inline]
    fn max(self, other: Self) -> Self {
        if self.value() < other.value() { other } else { self }
    }
    /// The smaller of two.
    #[inline]
    fn min(self, other: Self) -> Self {
        if self.value() > other.value() { other } else { self }
    }
    /// Held between two limits.
    #[inline]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
}

impl Scalar for f64 {
    const PARTS: usize = 1;
    fn part(&self, _i: usize) -> f64 {
        *self
    }
    fn from_parts(part: impl Fn(usize) -> f64) -> Self {
        part(0)
    }
    fn value(self) -> f64 {
        self
    }
    fn chain(self, value: f64, _derivative: f64) -> f64 {
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn formula<S: Scalar>(x: S, y: S) -> S {
        (x * y + x.tanh() / (y * y + 1.0)).sin() + x.abs().pow(y) - (x * x + 2.0).sqrt() * y.exp()
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_central_differences(x in 0.1..2.0f64, y in -1.0..1.0f64) {
            let dual = formula(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
            let h = 1e-6;
            let by_x = (formula(x + h, y) - formula(x - h, y)) / (2.0 * h);
            let by_y = (formula(x, y + h) - formula(x, y - h)) / (2.0 * h);
            prop_assert_eq!(dual.value, formula(x, y));
            // Single precision: a few units in the seventh digit of each of ten operations.
            prop_assert!((dual.part(1) - by_x).abs() < 2e-6 * (1.0 + by_x.abs()));
            prop_assert!((dual.part(2) - by_y).abs() < 2e-6 * (1.0 + by_y.abs()));
        }
    }
}
