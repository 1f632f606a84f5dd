//! From the controller's output to the spool's opening.

use crate::ode::State;
use crate::plant::state as at;

/// Amplifier between controller and valve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CommandStage {
    /// Added to the command (its unit).
    pub bias: f64,
    /// Transport delay (s): a true buffer, kept by the closed loop.
    pub delay: f64,
    /// Rate at which the gain starts to change as the oil warms (1/s), and the time in which that settles (s).
    pub warming: Option<(f64, f64)>,
    /// Magnetic hysteresis of the torque motor.
    pub hysteresis: Option<Hysteresis>,
}

/// Prandtl and Ishlinskii's sum of play operators: what the torque motor's iron withholds.
#[derive(Debug, Clone, PartialEq)]
pub struct Hysteresis {
    /// Half-widths of the plays (unit of command).
    pub widths: [f64; 3],
    /// Shares of the command that pass through each.
    pub shares: [f64; 3],
}

impl Hysteresis {
    /// The command after the iron; `plays` is its memory.
    pub fn pass(&self, command: f64, plays: &mut [f64; 3]) -> f64 {
        let mut out = command * (1.0 - self.shares.iter().sum::<f64>());
        for ((play, width), share) in plays.iter_mut().zip(&self.widths).zip(&self.shares) {
            *play = play.clamp(command - width, command + width);
            out += share * *play;
        }
        out
    }
}

impl CommandStage {
    /// The command with bias and gain change, at time `t` of the run.
    pub fn amplified(&self, t: f64, command: f64) -> f64 {
        let gain = self.warming.map_or(1.0, |(rate, settle)| 1.0 + rate * settle * (1.0 - (-t / settle).exp()));
        gain * (command + self.bias)
    }
}

/// Spool and its lands.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Valve {
    /// Spool dynamics.
    pub lag: Option<Lag>,
    /// Fastest opening (unit of command per s), as a servo with that much flow in its pilot stage.
    pub rate: Option<f64>,
    /// Overlapped lands.
    pub overlap: Option<Overlap>,
    /// Underlapped lands.
    pub underlap: Option<Underlap>,
}

/// Second-order spool behind a torque motor that is a good deal faster.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Natural frequency (Hz).
    pub frequency: f64,
    /// Damping ratio (1).
    pub damping: f64,
    /// Torque motor's corner over the spool's (1).
    pub motor: f64,
}

/// Lands wider than their ports; the edges are rounded, so that opening sets in gradually.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    /// Half the dead travel (unit of command).
    pub half_width: f64,
    /// Radius of the edges over the half-width (1).
    pub rounding: f64,
}

/// Lands narrower than their ports: more flow per opening near the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Underlap {
    /// Half the width (unit of command).
    pub half_width: f64,
    /// Extra gain in the middle (1).
    pub gain: f64,
}

/// Gain of the pilot stage that follows the command up to its greatest rate (1/s).
const PILOT: f64 = 3000.0;

impl Valve {
    /// Whether the spool has states of its own.
    pub fn moves(&self) -> bool {
        self.lag.is_some() || self.rate.is_some()
    }

    pub(super) fn derivative(&self, raw: f64, y: &State, dy: &mut State) {
        if let Some(lag) = &self.lag {
            let w = std::f64::consts::TAU * lag.frequency;
            dy[at::MOTOR] = lag.motor * w * (raw - y[at::MOTOR]);
            dy[at::SPOOL] = y[at::SPOOL_RATE];
            dy[at::SPOOL_RATE] = w * w * (y[at::MOTOR] - y[at::SPOOL]) - 2.0 * lag.damping * w * y[at::SPOOL_RATE];
            if let Some(rate) = self.rate {
                dy[at::SPOOL] = dy[at::SPOOL].clamp(-rate, rate);
            }
        } else if let Some(rate) = self.rate {
            dy[at::SPOOL] = (PILOT * (raw - y[at::SPOOL])).clamp(-rate, rate);
        }
    }

    /// Effective opening at a spool position.
    pub(super) fn opening(&self, spool: f64) -> f64 {
        let mut out = spool;
        if let Some(Overlap { half_width, rounding }) = self.overlap {
            out = rounded_overlap(out, half_width, (rounding * half_width).max(1e-12));
        }
        if let Some(Underlap { half_width, gain }) = self.underlap {
            out += gain * half_width * (out / half_width).tanh();
        }
        out
    }
}

/// `|u| - d` far outside, exactly zero in the middle, edges rounded over `r`.
fn rounded_overlap(u: f64, d: f64, r: f64) -> f64 {
    let rise = |s: f64| if s > 30.0 { s } else { s.exp().ln_1p() };
    u.signum() * r * (rise((u.abs() - d) / r) - rise(-d / r))
}

#[cfg(test)]
mod tests {
    use super::{Hysteresis, rounded_overlap};

    #[test]
    fn the_overlap_is_odd_dead_in_the_middle_and_loses_its_half_width_outside() {
        let (d, r) = (1e-3, 1e-4);
        assert_eq!(rounded_overlap(0.0, d, r), 0.0);
        assert!(rounded_overlap(0.4e-3, d, r) < 0.005 * d);
        assert!((rounded_overlap(5e-3, d, r) - 4e-3).abs() < 1e-7);
        assert_eq!(rounded_overlap(-3e-3, d, r), -rounded_overlap(3e-3, d, r));
    }

    #[test]
    fn iron_withholds_by_the_way_it_came() {
        let iron = Hysteresis { widths: [1e-3, 2e-3, 4e-3], shares: [0.05; 3] };
        let mut plays = [0.0; 3];
        let path = |to: f64, plays: &mut [f64; 3]| iron.pass(to, plays);
        path(0.02, &mut plays);
        let falling = path(0.0, &mut plays);
        path(-0.02, &mut plays);
        let rising = path(0.0, &mut plays);
        assert!(falling > 0.0 && rising < 0.0 && (falling + rising).abs() < 1e-15);
    }
}
