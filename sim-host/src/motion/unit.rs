//! Units of acceleration a record may come in.

use serde::{Deserialize, Serialize};

pub(crate) use crate::scalar::GRAVITY as STANDARD_GRAVITY;

/// A unit of acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum AccelerationUnit {
    /// Metre per second squared.
    #[serde(rename = "m/s2")]
    MetrePerSecondSquared,
    /// Centimetre per second squared, also called gal.
    #[serde(rename = "cm/s2")]
    CentimetrePerSecondSquared,
    /// Millimetre per second squared.
    #[serde(rename = "mm/s2")]
    MillimetrePerSecondSquared,
    /// Standard gravity.
    #[serde(rename = "g")]
    Gravity,
}

/// A text that names no unit of acceleration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no unit of acceleration: expected m/s2, cm/s2 (gal), mm/s2 or g")]
pub struct UnknownUnit(pub String);

impl AccelerationUnit {
    /// The unit's size in m/s².
    pub fn in_si(self) -> f64 {
        match self {
            Self::MetrePerSecondSquared => 1.0,
            Self::CentimetrePerSecondSquared => 0.01,
            Self::MillimetrePerSecondSquared => 0.001,
            Self::Gravity => STANDARD_GRAVITY,
        }
    }

    /// The unit's symbol.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::MetrePerSecondSquared => "m/s2",
            Self::CentimetrePerSecondSquared => "cm/s2",
            Self::MillimetrePerSecondSquared => "mm/s2",
            Self::Gravity => "g",
        }
    }
}

impl std::str::FromStr for AccelerationUnit {
    type Err = UnknownUnit;

    /// Reads the spellings found in record files, whatever their case: `cm/sec/sec`, `CM/S**2`, `mm/s/s`, `gal`, `G`.
    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        let plain = text.trim().to_lowercase().replace("sec", "s").replace(['^', '*'], "").replace('²', "2");
        match plain.as_str() {
            "m/s2" | "m/s/s" => Ok(Self::MetrePerSecondSquared),
            "cm/s2" | "cm/s/s" | "gal" | "gals" => Ok(Self::CentimetrePerSecondSquared),
            "mm/s2" | "mm/s/s" => Ok(Self::MillimetrePerSecondSquared),
            "g" | "gs" | "g's" => Ok(Self::Gravity),
            _ => Err(UnknownUnit(text.trim().to_owned())),
        }
    }
}

impl std::fmt::Display for AccelerationUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_reads_back() {
        use AccelerationUnit as U;
        for unit in [U::MetrePerSecondSquared, U::CentimetrePerSecondSquared, U::MillimetrePerSecondSquared, U::Gravity]
        {
            assert_eq!(unit.symbol().parse(), Ok(unit));
        }
        assert_eq!("CM/SEC/SEC".parse(), Ok(U::CentimetrePerSecondSquared));
        assert_eq!(" cm/sec**2".parse(), Ok(U::CentimetrePerSecondSquared));
        assert!("m/s".parse::<U>().is_err() && "furlong".parse::<U>().is_err());
    }
}
