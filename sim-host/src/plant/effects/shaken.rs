//! Corners that noise shakes: what is kinked at a point passes, on average over normal noise, without a kink.

use crate::scalar::Scalar;

/// Noise reaches so many of its standard deviations and no further, for the last digit of a double.
const REACH: f64 = 8.5;

/// Mean of `max(x + n, 0)` over noise `n` of standard deviation `s`: `s phi(x/s) + x Phi(x/s)`, whose slope is `Phi(x/s)`.
pub(super) fn positive_part<S: Scalar>(x: S, s: S) -> S {
    let reach = s.value() * REACH;
    if x.value() > reach {
        return x;
    }
    if x.value() < -reach {
        return S::from(0.0);
    }
    let ratio = x / s;
    let at = ratio.value();
    let density = (-0.5 * at * at).exp() / std::f64::consts::TAU.sqrt();
    let below = 0.5 * libm::erfc(-at * std::f64::consts::FRAC_1_SQRT_2);
    ratio.chain(density + at * below, below) * s
}

/// Mean of `|x + n|` over the same noise.
pub(super) fn magnitude<S: Scalar>(x: S, s: S) -> S {
    positive_part(x, s) + positive_part(-x, s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// Midpoint sum over the noise's density.
    fn mean(of: impl Fn(f64) -> f64) -> f64 {
        let (n, reach) = (200_000, 12.0);
        let step = 2.0 * reach / f64::from(n);
        let place = |i: i32| -reach + (f64::from(i) + 0.5) * step;
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        (0..n).map(|i| of(place(i)) * density(place(i)) * step).sum()
    }

    #[test]
    fn means_are_those_over_the_noise() {
        for x in [-9.0, -8.4, -3.0, -1.0, -0.1, 0.0, 0.3, 2.0, 5.0, 8.4, 9.0] {
            let positive = mean(|n| (2.0 * x + 2.0 * n).max(0.0));
            assert!(
                (positive_part(2.0 * x, 2.0) - positive).abs() < 1e-9,
                "{x}: {} {positive}",
                positive_part(2.0 * x, 2.0)
            );
            let size = mean(|n| (x + n).abs());
            assert!((magnitude(x, 1.0) - size).abs() < 1e-9, "{x}: {} {size}", magnitude(x, 1.0));
        }
    }

    #[test]
    fn the_slope_is_the_share_of_noise_beyond_the_corner() {
        for x in [-2.0, 0.0, 0.7, 20.0] {
            let slope = positive_part(Dual::<1>::variable(x, 0), Dual::from(1.0)).tangent[0];
            let share = mean(|n| if x + n > 0.0 { 1.0 } else { 0.0 });
            assert!((f64::from(slope) - share).abs() < 1e-4, "{x}: {slope} {share}");
        }
    }
}
