//! Dimensions of what is in an expression, from the units of its parameters.

use std::fmt;

/// Exponents of metre, second, kilogram and the command's unit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Dimension {
    exponents: [f64; 4],
}

const NAMES: [&str; 4] = ["m", "s", "kg", "u"];

/// Units that can be written, with their exponents; all of them SI, so that no factor is hidden.
const UNITS: &[(&str, [f64; 4])] = &[
    ("1", [0.0; 4]),
    ("rad", [0.0; 4]),
    ("m", [1.0, 0.0, 0.0, 0.0]),
    ("s", [0.0, 1.0, 0.0, 0.0]),
    ("kg", [0.0, 0.0, 1.0, 0.0]),
    ("N", [1.0, -2.0, 1.0, 0.0]),
    ("Pa", [-1.0, -2.0, 1.0, 0.0]),
    ("Hz", [0.0, -1.0, 0.0, 0.0]),
    // What a command is measured in differs from rig to rig, and is one dimension.
    ("u", [0.0, 0.0, 0.0, 1.0]),
    ("V", [0.0, 0.0, 0.0, 1.0]),
    ("mA", [0.0, 0.0, 0.0, 1.0]),
];

impl Dimension {
    /// A number.
    pub(crate) const NONE: Self = Self { exponents: [0.0; 4] };
    /// m.
    pub(crate) const LENGTH: Self = Self { exponents: [1.0, 0.0, 0.0, 0.0] };
    /// s.
    pub(crate) const TIME: Self = Self { exponents: [0.0, 1.0, 0.0, 0.0] };
    /// m/s.
    pub(crate) const VELOCITY: Self = Self { exponents: [1.0, -1.0, 0.0, 0.0] };
    /// m/s2.
    pub(crate) const ACCELERATION: Self = Self { exponents: [1.0, -2.0, 0.0, 0.0] };
    /// N.
    pub(crate) const FORCE: Self = Self { exponents: [1.0, -2.0, 1.0, 0.0] };
    /// The command's.
    pub(crate) const COMMAND: Self = Self { exponents: [0.0, 0.0, 0.0, 1.0] };

    /// From a unit as it is written: `m/s2`, `1/s`, `N s/m`, `1/(m2 s2)`.
    pub(crate) fn of_unit(text: &str) -> Result<Self, String> {
        let (above, below) = text.split_once('/').unwrap_or((text, ""));
        let below = below.trim();
        let below = below.strip_prefix('(').and_then(|b| b.strip_suffix(')')).unwrap_or(below);
        let mut all = Self::NONE;
        for (side, sign) in [(above, 1.0), (below, -1.0)] {
            for factor in side.split([' ', '*']).filter(|f| !f.is_empty()) {
                all = all.times(Self::of_factor(factor, text)?.to_the(sign));
            }
        }
        if text.trim().is_empty() { Err("has no unit; write `1` for a number".into()) } else { Ok(all) }
    }

    fn of_factor(factor: &str, text: &str) -> Result<Self, String> {
        let whole = |name: &str| UNITS.iter().find(|(unit, _)| *unit == name).map(|(_, e)| Self { exponents: *e });
        if let Some(unit) = whole(factor) {
            return Ok(unit);
        }
        let split = factor.find(|c: char| c.is_ascii_digit()).unwrap_or(factor.len());
        let (name, power) = factor.split_at(split);
        match (whole(name), power.parse::<f64>()) {
            // A root has half a power: N/m0.5.
            (Some(unit), Ok(power)) if power > 0.0 && power <= 9.0 && (2.0 * power).fract() == 0.0 => {
                Ok(unit.to_the(power))
            }
            _ => {
                let known = UNITS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" ");
                Err(format!("`{text}` is no SI unit; write it with {known}, as in m/s2, N s/m or 1/(m2 s2)"))
            }
        }
    }

    /// Of a product.
    pub(super) fn times(self, other: Self) -> Self {
        Self { exponents: std::array::from_fn(|i| self.exponents[i] + other.exponents[i]) }
    }

    /// Of a power.
    pub(super) fn to_the(self, power: f64) -> Self {
        Self { exponents: self.exponents.map(|e| e * power) }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let part = |wanted: f64| {
            let mut factors = Vec::new();
            for (name, e) in NAMES.iter().zip(self.exponents) {
                let e = e * wanted;
                if e == 1.0 {
                    factors.push((*name).to_owned());
                } else if e > 0.0 {
                    factors.push(format!("{name}{e}"));
                }
            }
            factors
        };
        let (above, below) = (part(1.0), part(-1.0));
        let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
        match below.as_slice() {
            [] => write!(f, "{above}"),
            [one] => write!(f, "{above}/{one}"),
            many => write!(f, "{above}/({})", many.join(" ")),
        }
    }
}
