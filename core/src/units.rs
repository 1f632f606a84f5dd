//! Units at the edge: codes, volts, and what they stand for.
//!
//! Inside, everything is a plain `f32` in SI. At the edge three scales meet that are easily mixed up, so each has its
//! type: what a converter counts ([`Code`]), what lies on the wire ([`Volt`]), and what it means ([`Channel`] turns one
//! into the other, in the SI unit of its quantity). A [`Converter`] and a [`Channel`] together make the one straight
//! line, [`Scale`], that a tick uses: a multiplication and no division.

use crate::block::{BlockError, require};

/// What a converter counts, from 0 to its full scale.
///
/// ```
/// use shakedown_core::units::Code;
///
/// assert!(Code(4095) > Code(0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Code(pub u16);

/// A voltage on a wire, V.
///
/// ```
/// use shakedown_core::units::{Channel, Volt};
///
/// // A command of +/-10 V over a table of +/-0.2 m.
/// let command = Channel::new(Volt(0.0), 0.02)?;
/// assert!((command.to_si(Volt(5.0)) - 0.1).abs() < 1e-6);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Volt(pub f32);

/// A converter: code 0 is `low`, the largest code is `high`.
///
/// ```
/// use shakedown_core::units::{Code, Converter, Volt};
///
/// let converter = Converter::new(Code(4095), Volt(0.0), Volt(3.3))?;
/// assert_eq!(converter.to_code(Volt(3.3)), Some(Code(4095)));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    low: f32,
    volt_per_code: f32,
    full_scale: u16,
}

impl Converter {
    /// A converter of `full_scale` (its largest code, at least 255) from `low` to `high` (V, within 1000 V of zero and
    /// at least 1 mV apart).
    pub fn new(full_scale: Code, low: Volt, high: Volt) -> Result<Self, BlockError> {
        let full = require("full_scale", f32::from(full_scale.0), 255.0, 65_535.0)?;
        let low = require("low", low.0, -1000.0, 1000.0)?;
        let high = require("high", high.0, low + 1e-3, 1000.0)?;
        Ok(Self { low, volt_per_code: (high - low) / full, full_scale: full_scale.0 })
    }

    /// The voltage that `code` stands for.
    pub fn to_volt(self, code: Code) -> Volt {
        Volt(self.low + f32::from(code.0) * self.volt_per_code)
    }

    /// The code nearest to `volt`; beyond the span, its end. None for what is not a number.
    pub fn to_code(self, volt: Volt) -> Option<Code> {
        let code = (volt.0 - self.low) / self.volt_per_code + 0.5;
        // `as` saturates at both ends of u16.
        (!code.is_nan()).then(|| Code((code as u16).min(self.full_scale)))
    }
}

/// What a voltage means: a straight line through `zero`.
///
/// ```
/// use shakedown_core::units::{Channel, Code, Converter, Volt};
///
/// // An LVDT of 100 mm/V around 1.65 V.
/// let lvdt = Channel::new(Volt(1.65), 0.1)?;
/// assert!((lvdt.to_si(Volt(2.65)) - 0.1).abs() < 1e-6);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    zero: f32,
    per_volt: f32,
}

impl Channel {
    /// A channel that reads 0 at `zero` and gains `per_volt` (SI unit of its quantity per V; negative where the wiring
    /// inverts) with every volt.
    pub fn new(zero: Volt, per_volt: f32) -> Result<Self, BlockError> {
        require("per_volt", per_volt.abs(), 1e-9, 1e9)?;
        Ok(Self { zero: require("zero", zero.0, -1000.0, 1000.0)?, per_volt })
    }

    /// What `volt` stands for, in the quantity's SI unit.
    pub fn to_si(self, volt: Volt) -> f32 {
        (volt.0 - self.zero) * self.per_volt
    }

    /// The voltage for `value`, in the quantity's SI unit.
    pub fn to_volt(self, value: f32) -> Volt {
        Volt(value / self.per_volt + self.zero)
    }

    /// The one line from `converter`'s codes to SI.
    pub fn scale(self, converter: Converter) -> Scale {
        Scale {
            zero: (self.zero - converter.low) / converter.volt_per_code,
            per_code: converter.volt_per_code * self.per_volt,
        }
    }
}

/// A straight line between converter codes and SI units.
///
/// ```
/// use shakedown_core::units::Scale;
///
/// let scale = Scale { zero: 2048.0, per_code: 1e-4 };
/// assert!((scale.to_si(3048) - 0.1).abs() < 1e-6);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct Scale {
    /// Code at zero, which may lie between two codes or outside the converter's range.
    pub zero: f32,
    /// SI units per code; negative where the wiring inverts.
    pub per_code: f32,
}

impl Scale {
    /// What `code` stands for, in the channel's SI unit.
    #[inline]
    pub fn to_si(&self, code: u16) -> f32 {
        (f32::from(code) - self.zero) * self.per_code
    }

    /// What the codes from `first` to `last` stand for: smallest and largest value, in the channel's SI unit.
    pub fn span(&self, first: u16, last: u16) -> [f32; 2] {
        let [a, b] = [first, last].map(|code| self.to_si(code));
        if a < b { [a, b] } else { [b, a] }
    }
}
