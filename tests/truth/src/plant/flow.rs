//! Orifices, their limits, and the supply behind them.

use crate::ode::State;
use crate::plant::state as at;

/// How demand becomes flow.
#[derive(Debug, Clone, PartialEq)]
pub struct Flow {
    /// Width of the limit's corner over the limit (1); 0 is the sharp corner of Fig. 7.
    pub corner: f64,
    /// Limit toward positive x over the baseline's (1).
    pub positive: f64,
    /// Limit toward negative x over the baseline's (1).
    pub negative: f64,
    /// Difference of piston areas: the flow gain is greater one way by this share (1).
    pub area_asymmetry: f64,
    /// Share of the limit lost per second as the oil heats (1/s).
    pub limit_fade: f64,
    /// Pump ripple: share of the flow (1) and frequency (Hz).
    pub pulsation: Option<(f64, f64)>,
    /// Accumulator and pump, where the supply gives way.
    pub supply: Option<Supply>,
}

impl Default for Flow {
    fn default() -> Self {
        Self {
            corner: 0.0,
            positive: 1.0,
            negative: 1.0,
            area_asymmetry: 0.0,
            limit_fade: 0.0,
            pulsation: None,
            supply: None,
        }
    }
}

/// Gas accumulator (polytropic) refilled by a pressure-compensated pump.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Supply {
    /// Share of the pressure lost when the table runs at its limit for long (1).
    pub depth: f64,
    /// Time in which the pump refills (s).
    pub recovery: f64,
    /// Polytropic exponent of the gas (1).
    pub exponent: f64,
    /// Pressure loss at which the pump gives all it can (1).
    pub band: f64,
}

impl Flow {
    /// Flow as a velocity (m/s) from demand (m/s), at time `t` of the run, with supply pressure `r` over its start.
    pub(super) fn limited(&self, t: f64, demand: f64, limit: f64, r: f64) -> f64 {
        let way = demand.signum();
        let asked = demand.abs() * (1.0 + way * self.area_asymmetry);
        let side = if demand > 0.0 { self.positive } else { self.negative };
        let most = limit * side * (1.0 - self.limit_fade * t).max(0.1);
        let mut flow = if self.corner > 0.0 { corner(asked, most, self.corner * most) } else { asked.min(most) };
        if let Some((share, frequency)) = self.pulsation {
            flow *= 1.0 + share * (std::f64::consts::TAU * frequency * t).sin();
        }
        if self.supply.is_some() {
            flow *= r.max(0.0).sqrt();
        }
        way * flow
    }

    /// Gas law and pump: `r' = r^(1 + 1/n) (pump - flow)/volume`, scaled so that small changes lose `depth` at the limit.
    pub(super) fn derivative(&self, velocity: f64, limit: f64, y: &State, dy: &mut State) {
        if let Some(supply) = &self.supply {
            let r = y[at::SUPPLY].max(1e-3);
            let pump = (1.0 - r).clamp(0.0, supply.band);
            let drawn = supply.depth * velocity.abs() / limit;
            dy[at::SUPPLY] = r.powf(1.0 + 1.0 / supply.exponent) * (pump - drawn) / supply.recovery;
        }
    }
}

/// Two restrictions in a row: `s` below `most - width`, `most` above, the corner between them that of a soft minimum.
fn corner(s: f64, most: f64, width: f64) -> f64 {
    let rise = |x: f64| if x > 30.0 { x } else { x.exp().ln_1p() };
    s - width * (rise((s - most) / width) - rise(-most / width))
}

#[cfg(test)]
mod tests {
    use super::Flow;

    #[test]
    fn a_sharp_corner_is_the_clamp_and_a_soft_one_stays_below_it() {
        let sharp = Flow::default();
        let soft = Flow { corner: 0.1, ..Flow::default() };
        for demand in [-0.5, -0.24, -0.1, 0.0, 0.05, 0.2, 0.3] {
            assert_eq!(sharp.limited(1.0, demand, 0.24, 1.0), demand.clamp(-0.24, 0.24));
            let v = soft.limited(1.0, demand, 0.24, 1.0);
            assert!(v.abs() <= demand.abs().min(0.24 * 1.0001), "{v} at {demand}");
            assert_eq!(v, -soft.limited(1.0, -demand, 0.24, 1.0));
        }
    }
}
