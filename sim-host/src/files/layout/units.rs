//! Which texts are units, so that a row of units is known from a row of names.

/// Spellings of units, superscripts written as plain digits.
const UNITS: [&str; 58] = [
    "m", "cm", "mm", "um", "km", "in", "ft", "m/s", "cm/s", "mm/s", "in/s", "m/s2", "cm/s2", "mm/s2", "in/s2", "gal",
    "g", "g's", "mg", "s", "sec", "ms", "us", "min", "h", "d", "N", "kN", "MN", "lbf", "kip", "kgf", "Pa", "kPa",
    "MPa", "GPa", "bar", "psi", "V", "mV", "mA", "A", "%", "1", "-", "deg", "rad", "K", "C", "degC", "Hz", "um/m",
    "strain", "counts", "none", "cm/s/s", "m/s/s", "mm/s/s",
];

/// True for a unit, in brackets or without: `mm`, `[m/s²]`, `(g)`.
pub(crate) fn is_unit(text: &str) -> bool {
    let plain = plain(text);
    UNITS.iter().any(|unit| unit.eq_ignore_ascii_case(&plain))
}

/// Names that one unit has beside its own.
const ALSO: [(&str, &str); 8] = [
    ("sec", "s"),
    ("g's", "g"),
    ("gal", "cm/s2"),
    ("m/s/s", "m/s2"),
    ("cm/s/s", "cm/s2"),
    ("mm/s/s", "mm/s2"),
    ("-", "1"),
    ("none", "1"),
];

/// True for two spellings of one unit.
pub(super) fn is_same(a: &str, b: &str) -> bool {
    let usual = |text: &str| {
        let plain = plain(text).to_ascii_lowercase();
        ALSO.iter().find(|(also, _)| *also == plain).map_or(plain, |(_, usual)| (*usual).to_owned())
    };
    usual(a) == usual(b)
}

/// The unit that a name ends with in brackets, as in `acceleration [g]`.
pub(super) fn of_name(name: &str) -> Option<&str> {
    let from = name.rfind(['[', '('])?;
    Some(&name[from..]).filter(|unit| is_unit(unit))
}

fn plain(text: &str) -> String {
    let plain = text.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim();
    plain.replace('²', "2").replace("**2", "2").replace("^2", "2").replace("/sec", "/s").replace('µ', "u")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_known_in_brackets_and_without() {
        for unit in ["mm", "[m/s^2]", "(g)", "kN", "s", "V", "d"] {
            assert!(is_unit(unit), "{unit}");
        }
        assert!(!is_unit("time") && !is_unit("1944 B") && !is_unit(""));
    }

    /// One unit under two names is no contradiction, another of its kind is.
    #[test]
    fn a_unit_has_more_than_one_name() {
        for (a, b) in [("s", "[sec]"), ("gal", "(cm/s^2)"), ("m/s2", "[m/s/s]"), ("1", "[-]"), ("kN", "[kn]")] {
            assert!(is_same(a, b) && is_same(b, a), "{a} {b}");
        }
        assert!(!is_same("gal", "g") && !is_same("mm", "[m]") && !is_same("s", "[ms]"));
    }
}
