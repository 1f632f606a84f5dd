//! The one table of units a recording may be in, and what each is in SI.

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// m
    Length,
    /// m/s
    Velocity,
    /// m/s2
    Acceleration,
    /// s
    Time,
    /// N
    Force,
    /// Pa
    Pressure,
    /// V
    Voltage,
    /// A
    Current,
    /// No unit, or one that was never calibrated.
    Number,
}

/// One unit of the table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    /// How files write it.
    pub symbol: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// SI units in one of it.
    pub factor: f64,
}

pub(crate) use crate::scalar::GRAVITY as STANDARD_GRAVITY;

const fn unit(symbol: &'static str, dimension: Dimension, factor: f64) -> Unit {
    Unit { symbol, dimension, factor }
}

/// Every unit an experiment may name (docs/formats.md).
pub(crate) const UNITS: [Unit; 29] = [
    unit("m", Dimension::Length, 1.0),
    unit("cm", Dimension::Length, 1e-2),
    unit("mm", Dimension::Length, 1e-3),
    unit("um", Dimension::Length, 1e-6),
    unit("in", Dimension::Length, 0.0254),
    unit("m/s", Dimension::Velocity, 1.0),
    unit("cm/s", Dimension::Velocity, 1e-2),
    unit("mm/s", Dimension::Velocity, 1e-3),
    unit("m/s2", Dimension::Acceleration, 1.0),
    unit("cm/s2", Dimension::Acceleration, 1e-2),
    unit("mm/s2", Dimension::Acceleration, 1e-3),
    unit("gal", Dimension::Acceleration, 1e-2),
    unit("g", Dimension::Acceleration, STANDARD_GRAVITY),
    unit("s", Dimension::Time, 1.0),
    unit("ms", Dimension::Time, 1e-3),
    unit("N", Dimension::Force, 1.0),
    unit("kN", Dimension::Force, 1e3),
    unit("lbf", Dimension::Force, 4.448_221_615_260_5),
    unit("kip", Dimension::Force, 4_448.221_615_260_5),
    unit("kgf", Dimension::Force, STANDARD_GRAVITY),
    unit("Pa", Dimension::Pressure, 1.0),
    unit("kPa", Dimension::Pressure, 1e3),
    unit("MPa", Dimension::Pressure, 1e6),
    unit("bar", Dimension::Pressure, 1e5),
    unit("psi", Dimension::Pressure, 6_894.757_293_168),
    unit("V", Dimension::Voltage, 1.0),
    unit("mV", Dimension::Voltage, 1e-3),
    unit("mA", Dimension::Current, 1e-3),
    unit("%", Dimension::Number, 1e-2),
];

/// A plain number: `1`, the unit of what has none.
pub(crate) const NUMBER: Unit = unit("1", Dimension::Number, 1.0);

impl Unit {
    /// The unit of that name, exactly as the table writes it.
    pub fn named(symbol: &str) -> Option<Self> {
        if symbol == NUMBER.symbol {
            return Some(NUMBER);
        }
        UNITS.iter().copied().find(|u| u.symbol == symbol)
    }

    /// The unit a file's header means: blanks, carets, superscripts and a few common spellings are accepted there,
    /// because it is only ever compared with what the experiment says.
    pub fn in_header(text: &str) -> Option<Self> {
        let plain: String = text
            .chars()
            .filter(|c| !c.is_whitespace() && *c != '^')
            .map(|c| match c {
                '\u{b2}' => '2',
                '\u{b5}' | '\u{3bc}' => 'u',
                c => c,
            })
            .collect();
        let plain = match plain.as_str() {
            "sec" | "Sec" | "seconds" | "Seconds" => "s",
            "Volts" | "volts" | "Volt" => "V",
            "Newtons" | "newtons" | "Newton" => "N",
            "Meters" | "meters" => "m",
            "msec" => "ms",
            "m/s/s" => "m/s2",
            "mm/s/s" => "mm/s2",
            "inch" => "in",
            "G" => "g",
            "-" => "1",
            other => other,
        };
        Self::named(plain)
    }
}

/// All symbols, for a message.
pub(crate) fn symbols() -> String {
    let all: Vec<&str> = UNITS.iter().map(|u| u.symbol).chain([NUMBER.symbol]).collect();
    all.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_of_the_format_is_known_and_unique() {
        let listed =
            "m cm mm um in m/s cm/s mm/s m/s2 cm/s2 mm/s2 gal g s ms N kN lbf kip kgf Pa kPa MPa bar psi V mV mA % 1";
        assert_eq!(symbols(), listed);
        for symbol in listed.split(' ') {
            assert_eq!(Unit::named(symbol).unwrap().symbol, symbol);
            assert!(crate::files::layout::is_unit(symbol), "{symbol}");
        }
        assert_eq!(Unit::named("furlong"), None);
    }

    #[test]
    fn headers_may_spell_units_their_own_way() {
        assert_eq!(Unit::in_header("m/s^2"), Unit::named("m/s2"));
        assert_eq!(Unit::in_header(" mm/s\u{b2} "), Unit::named("mm/s2"));
        assert_eq!(Unit::in_header("\u{b5}m"), Unit::named("um"));
        assert_eq!(Unit::in_header("furlong"), None);
    }

    #[test]
    fn factors_are_the_defined_ones() {
        let factor = |s: &str| Unit::named(s).unwrap().factor;
        assert_eq!(factor("in"), 0.0254);
        assert_eq!(factor("g"), 9.806_65);
        // One pound-force (4.4482216152605 N) on a square inch.
        assert!((factor("psi") - 4.448_221_615_260_5 / (0.0254 * 0.0254)).abs() < 1e-9);
    }
}
