//! Numbers with the digits that their error leaves them.

/// A value with what it is uncertain by, both to two digits of that: `-1300 +/- 120`, not `-1297.54374`; the value alone where no error is known.
pub(crate) fn with_spread(value: f64, std: Option<f64>) -> String {
    match std.filter(|s| s.is_finite() && *s > 0.0) {
        Some(std) => format!("{} +/- {}", to(value, std), to(std, std)),
        None => to(value, f64::NAN),
    }
}

/// Error, over a value, from which the fit says nothing of it: two time constants that are about the same are known by their sum alone.
const NOTHING: f64 = 20.0;

/// True where a value's error is so large that the value is not determined.
pub(crate) fn says_nothing(value: f64, std: f64) -> bool {
    std > NOTHING * value.abs()
}

/// A fitted value to the digits that its error leaves, or to three where that says nothing of it.
pub(crate) fn fitted(value: f64, std: Option<f64>) -> String {
    match std {
        Some(std) if says_nothing(value, std) => three(value),
        std => to(value, std.unwrap_or(f64::NAN)),
    }
}

/// A figure whose error nobody states, such as a chi2, to three digits: `1.02`, `704000`.
pub(crate) fn three(value: f64) -> String {
    to(value, 0.1 * value)
}

/// A coefficient of determination: what it lacks of 1 to two digits where it is near, else two decimals.
pub(crate) fn r2(value: f64) -> String {
    if value > 0.9 && value < 1.0 { to(value, (1.0 - value).max(1e-6)) } else { format!("{value:.2}") }
}

/// A value as somebody stated it, to five digits: `138`, `0.242`, `2.38e-5`.
pub(crate) fn stated(value: f64) -> String {
    let rounded = format!("{value:.4e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-3..1e6).contains(&f64::abs(rounded)) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}

/// A number to two digits of `error`; to five of its own where there is none.
pub(crate) fn to(number: f64, error: f64) -> String {
    if !number.is_finite() {
        return number.to_string();
    }
    let size = if error.is_finite() && error != 0.0 { error.abs() } else { number.abs() * 1e-3 };
    if size == 0.0 {
        return "0".into();
    }
    // Of 9.96 two digits are 10: the decade is that of the rounded size.
    let decade = |x: f64| format!("{x:.1e}").split('e').nth(1).and_then(|p| p.parse::<i32>().ok()).unwrap_or(0);
    let last = decade(size) - 1;
    let step = 10f64.powi(last);
    let rounded = (number / step).round() * step;
    let largest = rounded.abs().max(size);
    if !(1e-3..1e6).contains(&largest) {
        let digits = (decade(largest) - last).clamp(0, 17) as usize;
        return if rounded == 0.0 { "0".into() } else { format!("{rounded:.digits$e}") };
    }
    format!("{rounded:.*}", usize::try_from(-last).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_keeps_the_digits_that_its_error_leaves() {
        for (value, std, shown) in [
            (-1_297.543_74, 124.873_53, ("-1300", "120")),
            (0.210_34, 0.003_97, ("0.2103", "0.0040")),
            (138.02, 0.996, ("138.0", "1.0")),
            (4.0, 9.96, ("4", "10")),
            (2.0e-7, 3.14e-9, ("2.000e-7", "3.1e-9")),
            (0.0, 0.02, ("0.000", "0.020")),
            (5.0e7, 2.0e5, ("5.000e7", "200000")),
        ] {
            let (a, b) = (to(value, std), to(std, std));
            assert_eq!((a.as_str(), b.as_str()), shown);
        }
        assert_eq!(with_spread(22_265.439_3, Some(232.0)), "22270 +/- 230");
        assert_eq!(with_spread(0.5, None), "0.50000");
        assert_eq!([1.0234, 0.98765, 703_970.093, 2.157e9, 0.0].map(three), ["1.02", "0.988", "704000", "2.16e9", "0"]);
        assert_eq!([0.999_641, 0.951_2, -4.119_26, 1.0, 0.84].map(r2), ["0.99964", "0.951", "-4.12", "1.00", "0.84"]);
        assert_eq!(
            [138.0, 0.242, 2.38e-5, 0.0, 1e300, f64::NAN].map(stated),
            ["138", "0.242", "2.38e-5", "0", "1e300", "NaN"]
        );
        assert_eq!(to(57.654_32, f64::NAN), "57.654");
        assert_eq!((to(0.0, 0.0).as_str(), to(f64::NAN, 1.0).as_str()), ("0", "NaN"));
    }
}
