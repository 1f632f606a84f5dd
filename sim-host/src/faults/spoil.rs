//! What becomes of a signal on its way: the ways in which sensors, wires and commands fail.

use super::dice::FaultRng;
use serde::Serialize;

/// A way for a signal to be wrong; heights are in the signal's own unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SignalFault {
    /// No number: an open wire, a dead converter.
    Open,
    /// Is at this value, beyond what the signal can be.
    Rail(f64),
    /// Held within this distance from zero: an amplifier that saturates early.
    Clipped(f64),
    /// Stands where it stood.
    Stuck,
    /// Stands where it stood, with white noise of this standard deviation: a core that came off its rod.
    Detached(f64),
    /// White noise of this standard deviation on top.
    Noisy(f64),
    /// Moves away at this rate, per second.
    Drifting(f64),
    /// Moves away and part of the way back, both at the same rate.
    Returning {
        /// Rate, per second.
        rate: f64,
        /// How far it goes.
        most: f64,
        /// Share of that at which it stays in the end, 1.
        left: f64,
    },
    /// Off by this much.
    Offset(f64),
    /// Spikes of a height that last so long, so far apart.
    Spikes {
        /// Height.
        height: f64,
        /// Length, ms.
        length: u32,
        /// From one to the next, ms.
        period: u32,
    },
    /// No number for so many ms, then good again.
    Gap(u32),
    /// No number for so long, again and again: a loose contact.
    Flicker {
        /// Length, ms.
        length: u32,
        /// From one to the next, ms.
        period: u32,
    },
    /// Reads zero, with white noise of this standard deviation: a short.
    Short(f64),
    /// A sine on top.
    Hum {
        /// Its peak.
        amplitude: f64,
        /// Its frequency, Hz.
        frequency: f64,
    },
    /// One bit of an input's converter stands.
    Bit {
        /// What the converter's codes reach, either way.
        span: f64,
        /// Which bit, 0 the least.
        bit: u32,
        /// Whether it is 1.
        set: bool,
    },
    /// Its sign turned.
    Reversed,
    /// Its gain goes to this multiple of what it was, evenly over so many seconds.
    Gain {
        /// What is left of the gain, 1.
        left: f64,
        /// How long it takes, s.
        over: f64,
    },
}

/// Bits of an input's converter, the sum of sixteen scans of twelve, and of the output's.
pub const BITS: [u32; 2] = [16, 12];

/// A converter of so many bits that reaches `span` either way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Converter {
    /// Its bits.
    pub bits: u32,
    /// What its codes reach, either way.
    pub span: f64,
}

impl Converter {
    fn half(self) -> f64 {
        f64::from(1_u32 << (self.bits - 1))
    }

    fn code(self, value: f64) -> u32 {
        (self.half() * (1.0 + value / self.span)).round().clamp(0.0, 2.0 * self.half() - 1.0) as u32
    }

    fn value(self, code: u32) -> f64 {
        (f64::from(code) / self.half() - 1.0) * self.span
    }

    /// What it makes of a value.
    pub fn pass(self, value: f64) -> f64 {
        if value.is_nan() { value } else { self.value(self.code(value)) }
    }

    /// The same with one bit that stands.
    pub fn pass_with(self, value: f64, bit: u32, set: bool) -> f64 {
        let code = self.code(value);
        self.value(if set { code | 1 << bit } else { code & !(1 << bit) })
    }
}

/// A signal that is being spoilt.
#[derive(Debug, Clone)]
pub struct Spoiled {
    how: SignalFault,
    dt: f64,
    ticks: u32,
    held: f64,
}

impl Spoiled {
    /// From now on, at ticks of `dt` (s).
    pub fn new(how: SignalFault, dt: f64) -> Self {
        Self { how, dt, ticks: 0, held: 0.0 }
    }

    /// What arrives of `value`.
    pub fn pass(&mut self, value: f64, dice: &mut FaultRng) -> f64 {
        if self.ticks == 0 {
            self.held = value;
        }
        let time = self.dt * f64::from(self.ticks);
        // A little later than the tick, so that the first tick of a millisecond is one of it.
        let ms = (1e3 * time + 1e-6) as u32;
        self.ticks = self.ticks.saturating_add(1);
        match self.how {
            SignalFault::Open => f64::NAN,
            SignalFault::Rail(rail) => rail,
            SignalFault::Clipped(limit) => value.clamp(-limit, limit),
            SignalFault::Stuck => self.held,
            SignalFault::Detached(deviation) => self.held + deviation * dice.normal(),
            SignalFault::Noisy(deviation) => value + deviation * dice.normal(),
            SignalFault::Drifting(rate) => value + rate * time,
            SignalFault::Returning { rate, most, left } => {
                let way = rate.abs() * time;
                let off = if way < most { way } else { (2.0 * most - way).max(left * most) };
                value + rate.signum() * off
            }
            SignalFault::Offset(offset) => value + offset,
            SignalFault::Spikes { height, length, period } => {
                value + if ms % period.max(1) < length { height } else { 0.0 }
            }
            SignalFault::Gap(length) if ms < length => f64::NAN,
            SignalFault::Gap(_) => value,
            SignalFault::Flicker { length, period } if ms % period.max(1) < length => f64::NAN,
            SignalFault::Flicker { .. } => value,
            SignalFault::Short(deviation) => deviation * dice.normal(),
            SignalFault::Hum { amplitude, frequency } => {
                value + amplitude * (std::f64::consts::TAU * frequency * time).sin()
            }
            SignalFault::Bit { span, bit, set } => Converter { bits: BITS[0], span }.pass_with(value, bit, set),
            SignalFault::Reversed => -value,
            SignalFault::Gain { left, over } => value * (1.0 + (left - 1.0) * (time / over).min(1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(how: SignalFault, values: &[f64]) -> Vec<f64> {
        let (mut spoiled, mut dice) = (Spoiled::new(how, 0.5), FaultRng::new(1, 1));
        values.iter().map(|&v| spoiled.pass(v, &mut dice)).collect()
    }

    #[test]
    fn each_way_is_what_it_says() {
        let v = [1.0, 2.0, -3.0];
        assert!(passed(SignalFault::Open, &v).iter().all(|x| x.is_nan()));
        assert_eq!(passed(SignalFault::Rail(9.0), &v), [9.0; 3]);
        assert_eq!(passed(SignalFault::Clipped(1.5), &v), [1.0, 1.5, -1.5]);
        assert_eq!(passed(SignalFault::Stuck, &v), [1.0; 3]);
        assert_eq!(passed(SignalFault::Drifting(2.0), &v), [1.0, 3.0, -1.0]);
        let returning = SignalFault::Returning { rate: -2.0, most: 1.5, left: 0.75 };
        assert_eq!(passed(returning, &[0.0; 4]), [0.0, -1.0, -1.125, -1.125]);
        let returning = SignalFault::Returning { rate: 1.0, most: 1.25, left: 0.25 };
        assert_eq!(passed(returning, &[0.0; 6]), [0.0, 0.5, 1.0, 1.0, 0.5, 0.3125]);
        assert_eq!(passed(SignalFault::Offset(1.0), &v), [2.0, 3.0, -2.0]);
        assert_eq!(passed(SignalFault::Spikes { height: 5.0, length: 400, period: 1000 }, &v), [6.0, 2.0, 2.0]);
        let flicker = passed(SignalFault::Flicker { length: 400, period: 1000 }, &v);
        assert!(flicker[0].is_nan() && flicker[1] == 2.0 && flicker[2].is_nan());
        assert_eq!(passed(SignalFault::Short(0.0), &v), [0.0; 3]);
        assert!((passed(SignalFault::Hum { amplitude: 2.0, frequency: 0.5 }, &v)[1] - 4.0).abs() < 1e-9);
        // Of codes 32768 + 8192, + 16384 and - 24576 the bit of 8192 stands at 1.
        assert_eq!(passed(SignalFault::Bit { span: 4.0, bit: 13, set: true }, &v), [1.0, 3.0, -3.0]);
        assert_eq!(passed(SignalFault::Reversed, &v), [-1.0, -2.0, 3.0]);
        assert_eq!(passed(SignalFault::Gain { left: 0.5, over: 1.0 }, &v), [1.0, 1.5, -1.5]);
        let gap = passed(SignalFault::Gap(400), &v);
        assert!(gap[0].is_nan() && gap[1..] == [2.0, -3.0]);
        assert_ne!(passed(SignalFault::Noisy(1.0), &v), v);
    }
}
