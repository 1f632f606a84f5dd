//! Which texts are units, so that a row of units is known from a row of names.

/// Spellings beyond the recordings' own units: counts, temperatures, strains, angles, days.
const OTHERS: [&str; 22] = [
    "cm", "km", "ft", "g's", "gal", "cm/s2", "cm/s^2", "deg", "rad", "K", "C", "degC", "Hz", "min", "h", "d", "um/m",
    "strain", "counts", "A", "kPa", "none",
];

/// True for a unit, in brackets or without: `mm`, `[m/s²]`, `(g)`.
pub fn is_unit(text: &str) -> bool {
    let plain = text.trim().trim_start_matches(['[', '(']).trim_end_matches([']', ')']).trim();
    crate::recording::unit::Unit::in_header(plain).is_some()
        || plain.parse::<crate::motion::AccelerationUnit>().is_ok()
        || OTHERS.iter().any(|unit| unit.eq_ignore_ascii_case(plain))
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
}
