//! What becomes of a signal on its way: the ways in which sensors, wires and commands fail.

use super::dice::Dice;
use serde::Serialize;

/// A way for a signal to be wrong; heights are in the signal's own unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Spoil {
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
    /// Off by this much.
    Offset(f64),
    /// Spikes of a height that last so many ticks, so many ticks apart.
    Spikes {
        /// Height.
        height: f64,
        /// Length, ticks.
        length: u32,
        /// From one to the next, ticks.
        period: u32,
    },
    /// No number for so many ticks, then good again.
    Gap(u32),
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

/// A signal that is being spoilt.
#[derive(Debug, Clone)]
pub struct Spoiled {
    how: Spoil,
    dt: f64,
    ticks: u32,
    held: f64,
}

impl Spoiled {
    /// From now on, at ticks of `dt` (s).
    pub fn new(how: Spoil, dt: f64) -> Self {
        Self { how, dt, ticks: 0, held: 0.0 }
    }

    /// What arrives of `value`.
    pub fn pass(&mut self, value: f64, dice: &mut Dice) -> f64 {
        if self.ticks == 0 {
            self.held = value;
        }
        let ticks = self.ticks;
        self.ticks = self.ticks.saturating_add(1);
        match self.how {
            Spoil::Open => f64::NAN,
            Spoil::Rail(rail) => rail,
            Spoil::Clipped(limit) => value.clamp(-limit, limit),
            Spoil::Stuck => self.held,
            Spoil::Detached(deviation) => self.held + deviation * dice.normal(),
            Spoil::Noisy(deviation) => value + deviation * dice.normal(),
            Spoil::Drifting(rate) => value + rate * self.dt * f64::from(ticks),
            Spoil::Offset(offset) => value + offset,
            Spoil::Spikes { height, length, period } => {
                value + if ticks % period.max(1) < length { height } else { 0.0 }
            }
            Spoil::Gap(length) => {
                if ticks < length {
                    f64::NAN
                } else {
                    value
                }
            }
            Spoil::Reversed => -value,
            Spoil::Gain { left, over } => value * (1.0 + (left - 1.0) * (self.dt * f64::from(ticks) / over).min(1.0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn passed(how: Spoil, values: &[f64]) -> Vec<f64> {
        let (mut spoiled, mut dice) = (Spoiled::new(how, 0.5), Dice::new(1, 1));
        values.iter().map(|&v| spoiled.pass(v, &mut dice)).collect()
    }

    #[test]
    fn each_way_is_what_it_says() {
        let v = [1.0, 2.0, -3.0];
        assert!(passed(Spoil::Open, &v).iter().all(|x| x.is_nan()));
        assert_eq!(passed(Spoil::Rail(9.0), &v), [9.0; 3]);
        assert_eq!(passed(Spoil::Clipped(1.5), &v), [1.0, 1.5, -1.5]);
        assert_eq!(passed(Spoil::Stuck, &v), [1.0; 3]);
        assert_eq!(passed(Spoil::Drifting(2.0), &v), [1.0, 3.0, -1.0]);
        assert_eq!(passed(Spoil::Offset(1.0), &v), [2.0, 3.0, -2.0]);
        assert_eq!(passed(Spoil::Spikes { height: 5.0, length: 1, period: 2 }, &v), [6.0, 2.0, 2.0]);
        assert_eq!(passed(Spoil::Reversed, &v), [-1.0, -2.0, 3.0]);
        assert_eq!(passed(Spoil::Gain { left: 0.5, over: 1.0 }, &v), [1.0, 1.5, -1.5]);
        let gap = passed(Spoil::Gap(1), &v);
        assert!(gap[0].is_nan() && gap[1..] == [2.0, -3.0]);
        assert_ne!(passed(Spoil::Noisy(1.0), &v), v);
    }
}
