//! Numbers a model can be run on: `f64`, and forward-mode duals that carry derivatives along.
//!
//! A [`Dual<N>`] holds a value and its derivatives with respect to N parameters. Comparisons look at the value alone,
//! so that branches (limits, deadbands) are taken as the value takes them and the derivative is that of the branch.
//!
//! Values have double precision, derivatives single: seven digits tell a fit where to step and how sure it is, and take half
//! the room.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

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

/// Derivatives smaller than this are nothing.
const DIED_AWAY: f32 = 1e-30;

/// A value and its derivatives with respect to `N` parameters.
#[derive(Debug, Clone, Copy)]
pub struct Dual<const N: usize> {
    /// The value.
    pub value: f64,
    /// Its derivatives.
    pub tangent: [f32; N],
}

impl<const N: usize> Dual<N> {
    /// The `i`-th parameter: derivative one with respect to itself.
    pub fn variable(value: f64, i: usize) -> Self {
        let mut tangent = [0.0; N];
        if let Some(t) = tangent.get_mut(i) {
            *t = 1.0;
        }
        Self { value, tangent }
    }

    /// This value, and these derivatives times a factor.
    #[inline(always)]
    fn scaled(mut self, value: f64, factor: f32) -> Self {
        self.value = value;
        for i in 0..N {
            self.tangent[i] *= factor;
        }
        self
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(value: f64) -> Self {
        Self { value, tangent: [0.0; N] }
    }
}

impl<const N: usize> PartialEq for Dual<N> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<const N: usize> PartialOrd for Dual<N> {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    const PARTS: usize = N + 1;
    fn part(&self, i: usize) -> f64 {
        if i == 0 { self.value } else { f64::from(self.tangent[i - 1]) }
    }
    fn from_parts(part: impl Fn(usize) -> f64) -> Self {
        Self { value: part(0), tangent: std::array::from_fn(|i| part(i + 1) as f32) }
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }
    #[inline(always)]
    fn plus_product(mut self, a: Self, b: Self) -> Self {
        let (by_a, by_b) = (b.value as f32, a.value as f32);
        self.value += a.value * b.value;
        for i in 0..N {
            self.tangent[i] += a.tangent[i] * by_a + b.tangent[i] * by_b;
        }
        self
    }
    #[inline(always)]
    fn plus_scaled(mut self, a: Self, factor: f64) -> Self {
        self.value += a.value * factor;
        let factor = factor as f32;
        for i in 0..N {
            self.tangent[i] += a.tangent[i] * factor;
        }
        self
    }
    #[inline(always)]
    fn chain(self, value: f64, derivative: f64) -> Self {
        // Steeper than single precision holds is as steep as it can be: nothing times infinity is no number.
        self.scaled(value, (derivative as f32).clamp(f32::MIN, f32::MAX))
    }
    #[inline(always)]
    fn settled(mut self) -> Self {
        for i in 0..N {
            self.tangent[i] = if self.tangent[i].abs() < DIED_AWAY { 0.0 } else { self.tangent[i] };
        }
        self
    }
}

/// Combines two tangents entry by entry. A plain loop: iterators are not always inlined, and this is where a fit spends
/// its time.
#[inline(always)]
fn zip<const N: usize>(a: &[f32; N], b: &[f32; N], f: impl Fn(f32, f32) -> f32) -> [f32; N] {
    let mut out = *a;
    for i in 0..N {
        out[i] = f(a[i], b[i]);
    }
    out
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { value: self.value + o.value, tangent: zip(&self.tangent, &o.tangent, |a, b| a + b) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { value: self.value - o.value, tangent: zip(&self.tangent, &o.tangent, |a, b| a - b) }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let (by_own, by_other) = (o.value as f32, self.value as f32);
        let tangent = zip(&self.tangent, &o.tangent, |a, b| a * by_own + b * by_other);
        Self { value: self.value * o.value, tangent }
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        let (inverse, ratio) = ((1.0 / o.value) as f32, value as f32);
        Self { value, tangent: zip(&self.tangent, &o.tangent, |a, b| (a - ratio * b) * inverse) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.scaled(-self.value, -1.0)
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<const N: usize> SubAssign for Dual<N> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl<const N: usize> Add<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl<const N: usize> Sub<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}

impl<const N: usize> Mul<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        self.scaled(self.value * o, o as f32)
    }
}

impl<const N: usize> Div<f64> for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: f64) -> Self {
        self.scaled(self.value / o, (1.0 / o) as f32)
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

    #[test]
    fn a_derivative_that_died_away_is_let_go_of_and_no_slope_is_infinite() {
        let tiny = Dual::<2> { value: 1e-40, tangent: [1e-31, 1e-29] };
        assert_eq!((tiny.settled().value, tiny.settled().tangent), (1e-40, [0.0, 1e-29]));
        let root = Dual::<1> { value: 1e-100, tangent: [0.0] }.sqrt();
        assert_eq!((root.value, root.tangent), (1e-50, [0.0]));
    }
}
