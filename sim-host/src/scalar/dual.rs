//! Values that carry derivatives along, in forward mode.

use super::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

/// Derivatives smaller than this are nothing.
const DIED_AWAY: f32 = 1e-30;

/// A value and its derivatives with respect to `N` parameters.
///
/// The value comes last: with derivatives by the four, a copy then goes in whole words of the processor, none of which was
/// written in two parts, for which it would have to wait.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub(crate) struct Dual<const N: usize> {
    /// Its derivatives.
    pub tangent: [f32; N],
    /// The value.
    pub value: f64,
}

impl<const N: usize> Dual<N> {
    /// The `i`-th parameter: derivative one with respect to itself.
    pub(crate) fn variable(value: f64, i: usize) -> Self {
        let mut tangent = [0.0; N];
        if let Some(t) = tangent.get_mut(i) {
            *t = 1.0;
        }
        Self { tangent, value }
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

    #[test]
    fn a_derivative_that_died_away_is_let_go_of_and_no_slope_is_infinite() {
        let tiny = Dual::<2> { value: 1e-40, tangent: [1e-31, 1e-29] };
        assert_eq!((tiny.settled().value, tiny.settled().tangent), (1e-40, [0.0, 1e-29]));
        let root = Dual::<1> { value: 1e-100, tangent: [0.0] }.sqrt();
        assert_eq!((root.value, root.tangent), (1e-50, [0.0]));
    }
}
