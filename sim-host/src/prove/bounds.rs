//! Bounds on a probability from counts (Clopper and Pearson 1934): exact, so never too narrow.

/// Below the true probability in at least 95 % of campaigns: one-sided.
pub fn lower(successes: usize, trials: usize) -> f64 {
    if successes == 0 {
        return 0.0;
    }
    quantile(0.05, successes as f64, (trials - successes + 1) as f64)
}

/// Above the true probability in at least 95 % of campaigns: one-sided.
pub fn upper(successes: usize, trials: usize) -> f64 {
    if successes >= trials {
        return 1.0;
    }
    quantile(0.95, (successes + 1) as f64, (trials - successes) as f64)
}

/// The `p` quantile of the beta distribution, by bisection of its integral.
fn quantile(p: f64, a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if incomplete_beta(middle, a, b) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Regularised incomplete beta function `I_x(a, b)` by its continued fraction (DLMF 8.17.22), Lentz's method.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    // The fraction converges fast on one side of the mean; the other side is its mirror.
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let front =
        libm::exp(libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b) + a * libm::log(x) + b * libm::log(1.0 - x));
    let tiny = |v: f64| if v.abs() < 1e-300 { 1e-300 } else { v };
    let (mut c, mut d) = (1.0, 1.0 / tiny(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for m in 1..300 {
        let m = f64::from(m);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let mut change = 1.0;
        for term in [even, odd] {
            d = 1.0 / tiny(1.0 + term * d);
            c = tiny(1.0 + term / c);
            change = d * c;
            fraction *= change;
        }
        if (change - 1.0).abs() < 1e-14 {
            break;
        }
    }
    front * fraction / a
}

#[cfg(test)]
mod tests {
    use super::{incomplete_beta, lower, upper};
    use proptest::prelude::*;

    #[test]
    fn known_bounds() {
        // No success in n: 1 - 0.05^(1/n), the rule of three.
        assert!((upper(0, 300) - (1.0 - 0.05_f64.powf(1.0 / 300.0))).abs() < 1e-9);
        // All of n: 0.05^(1/n).
        assert!((lower(20, 20) - 0.05_f64.powf(1.0 / 20.0)).abs() < 1e-9);
        // Binomial tail by hand: P(X <= 2 | n = 10, p) = 0.05 at p = 0.5069.
        assert!((upper(2, 10) - 0.506_901_3).abs() < 1e-5, "{}", upper(2, 10));
        assert_eq!((lower(0, 5), upper(5, 5)), (0.0, 1.0));
    }

    proptest! {
        #[test]
        fn the_integral_is_the_binomial_tail(n in 1_i32..40, k in 0_i32..40, p in 0.01_f64..0.99) {
            let k = k.min(n - 1);
            // P(X > k) = I_p(k + 1, n - k).
            let mut term = (1.0 - p).powi(n);
            let mut below = term;
            for i in 1..=k {
                term *= f64::from(n - i + 1) / f64::from(i) * p / (1.0 - p);
                below += term;
            }
            let tail = incomplete_beta(p, f64::from(k + 1), f64::from(n - k));
            prop_assert!((tail - (1.0 - below)).abs() < 1e-9, "{tail} against {}", 1.0 - below);
        }

        #[test]
        fn bounds_hold_the_share_between_them(n in 1_usize..500, share in 0.0_f64..1.0) {
            let k = ((n as f64 * share) as usize).min(n);
            let value = k as f64 / n as f64;
            prop_assert!(lower(k, n) <= value && value <= upper(k, n));
        }
    }
}
