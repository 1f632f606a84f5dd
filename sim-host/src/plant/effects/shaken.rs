//! Corners that noise shakes: what is kinked at a point passes, on average over normal noise, without a kink.

use crate::scalar::Scalar;
use std::sync::LazyLock;

/// Noise reaches so many of its standard deviations and no further, for the last digit of a double.
const REACH: f64 = 8.5;
/// Entries of the table for one standard deviation.
const DENSITY: f64 = 32.0;

/// What noise of standard deviation one leaves of `max(n - a, 0)` on average, `phi(a) - a Q(a)`; the share `Q(a)` of it beyond `a`;
/// and its density `phi(a)` there.
#[derive(Debug, Clone, Copy)]
struct Beyond {
    mean: f64,
    share: f64,
    density: f64,
}

impl Beyond {
    fn exactly(a: f64) -> Self {
        let density = (-0.5 * a * a).exp() / std::f64::consts::TAU.sqrt();
        let share = 0.5 * libm::erfc(a * std::f64::consts::FRAC_1_SQRT_2);
        Self { mean: density - a * share, share, density }
    }

    /// Its mean and share at `a`, 0 to [`REACH`], by Taylor's series about the nearest entry of a table, to the last digits of a double:
    /// the exponential and the error function are where a simulation with friction would spend its time.
    fn at(a: f64) -> (f64, f64) {
        static TABLE: LazyLock<Vec<Beyond>> = LazyLock::new(|| {
            let last = (REACH * DENSITY) as usize + 1;
            (0..=last).map(|i| Beyond::exactly(i as f64 / DENSITY)).collect()
        });
        let nearest = (a * DENSITY).round();
        let Some(&Self { mean, share, density }) = TABLE.get(nearest as usize) else { return (0.0, 0.0) };
        let x = nearest / DENSITY;
        let d = a - x;
        // Derivatives of the density over the density, and the integral of its series from the entry on.
        let [second, third, fourth] = [x * x - 1.0, -(x * x - 3.0) * x, (x * x - 6.0) * x * x + 3.0];
        let passed =
            density * d * (1.0 + d * (-x / 2.0 + d * (second / 6.0 + d * (third / 24.0 + d * fourth / 120.0))));
        let twice =
            density * d * d * (0.5 + d * (-x / 6.0 + d * (second / 24.0 + d * (third / 120.0 + d * fourth / 720.0))));
        (mean - share * d + twice, share - passed)
    }
}

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
    let (mean, share) = Beyond::at(at.abs());
    let (value, slope) = if at > 0.0 { (at + mean, 1.0 - share) } else { (mean, share) };
    ratio.chain(value, slope) * s
}

/// Mean of `|x + n|` over the same noise: what passes on either side.
pub(super) fn magnitude<S: Scalar>(x: S, s: S) -> S {
    let reach = s.value() * REACH;
    if x.value().abs() > reach {
        return x.abs();
    }
    let ratio = x / s;
    let at = ratio.value();
    let (mean, share) = Beyond::at(at.abs());
    ratio.chain(at.abs() + 2.0 * mean, at.signum() * (1.0 - 2.0 * share)) * s
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

    /// The table gives what the functions give, between its entries too.
    #[test]
    fn a_table_is_as_good_as_the_functions() {
        for i in 0..=85_000 {
            let a = f64::from(i) * 1e-4;
            let (exact, (mean, share)) = (Beyond::exactly(a), Beyond::at(a));
            assert!((mean - exact.mean).abs() < 2e-15, "{a}: {mean} for {}", exact.mean);
            assert!((share - exact.share).abs() < 2e-13, "{a}: {share} for {}", exact.share);
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
