//! Numbers with the digits that their error leaves them.

/// A value and its standard deviation, both to two digits of the deviation: `-1300 +/- 120`, not `-1297.54374`.
pub fn with_error(value: f64, std: f64) -> (String, String) {
    (to(value, std), to(std, std))
}

/// A number to two digits of `error`; to five of its own where there is none.
pub fn to(number: f64, error: f64) -> String {
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
            let (a, b) = with_error(value, std);
            assert_eq!((a.as_str(), b.as_str()), shown);
        }
        assert_eq!(to(57.654_32, f64::NAN), "57.654");
        assert_eq!((to(0.0, 0.0).as_str(), to(f64::NAN, 1.0).as_str()), ("0", "NaN"));
    }
}
