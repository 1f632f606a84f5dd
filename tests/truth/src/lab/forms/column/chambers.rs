//! Two oil volumes that shrink and grow with the stroke, with entrained air, the valve's edges or none, and hoses or none.
//! Pressures times area over table mass (m/s2).

use crate::lab::balance::balance;
use crate::lab::law::{Column, Now};
use std::f64::consts::TAU;

/// The cylinder.
#[derive(Debug, Clone, Copy)]
pub struct Chambers {
    /// Oil-column frequency in mid-stroke (Hz).
    pub frequency: f64,
    /// Damping ratio in mid-stroke, of the pipe (1).
    pub damping: f64,
    /// Half the stroke with its dead volume (m).
    pub stroke: f64,
    /// Supply pressure (m/s2).
    pub supply: f64,
    /// Whether flow follows the orifice law at each edge.
    pub edges: bool,
    /// Hoses that swell: share of the compliance, and time constant (s).
    pub hose: Option<(f64, f64)>,
}

/// Entrained air: oil is softer at low pressure by this share of the resting pressure.
const AIR: f64 = 0.03;

impl Chambers {
    fn stiffness(&self, p: f64) -> f64 {
        let (w, rest) = (TAU * self.frequency, 0.5 * self.supply);
        let p = p.max(0.02 * rest);
        0.5 * w * w * (1.0 + AIR) * p / (p + AIR * rest)
    }

    /// Flow through the two open edges while the pistons' side of the chambers takes `taken` (m/s), softened where the pressure
    /// difference vanishes. The edges see the pressures as they are damped, each in balance with its flow.
    fn flows(&self, q: f64, taken: f64, p1: f64, p2: f64) -> (f64, f64) {
        if !self.edges {
            return (q, q);
        }
        let edge = |difference: f64| {
            let ratio = 2.0 * difference / self.supply;
            ratio.signum() * (ratio * ratio / (ratio.abs() + 2e-3)).sqrt()
        };
        let first = |p: f64| if q > 0.0 { q * edge(self.supply - p) } else { q * edge(p) };
        let second = |p: f64| if q > 0.0 { q * edge(p) } else { q * edge(self.supply - p) };
        let damper = self.damping * TAU * self.frequency;
        let one = balance(p1, |p| p1 + damper * (first(p) - taken));
        let other = balance(p2, |p| p2 - damper * (second(p) - taken));
        (first(one), second(other))
    }
}

impl Column for Chambers {
    fn states(&self) -> usize {
        4
    }

    fn at_rest(&self, y: &mut [f64]) {
        y[..2].fill(0.5 * self.supply);
    }

    fn spring(&self, _: &Now, y: &[f64]) -> f64 {
        y[0] - y[1]
    }

    fn rates(&self, now: &Now, q: f64, lost: f64, v: f64, y: &[f64], dy: &mut [f64]) -> f64 {
        let w = TAU * self.frequency;
        let (q1, q2) = self.flows(q, lost + v, y[0], y[1]);
        // Hoses take up flow in proportion to how far their wall lags behind the pressure.
        let (mut into1, mut into2) = (0.0, 0.0);
        if let Some((share, time)) = self.hose {
            let rest = 0.5 * self.supply;
            let compliance = 2.0 * share / (w * w);
            dy[2] = (y[0] - rest - y[2]) / time;
            dy[3] = (y[1] - rest - y[3]) / time;
            (into1, into2) = (compliance * dy[2], compliance * dy[3]);
        }
        let place = (now.x / self.stroke).clamp(-0.8, 0.8);
        dy[0] = self.stiffness(y[0]) / (1.0 + place) * (q1 - lost - v - into1);
        dy[1] = self.stiffness(y[1]) / (1.0 - place) * (v + lost - q2 - into2);
        y[0] - y[1] + 2.0 * self.damping * w * (0.5 * (q1 + q2) - lost - v)
    }

    fn fastest(&self) -> f64 {
        let hose = self.hose.map_or(0.0, |(share, time)| (1.0 + share) / time);
        (2.2 * TAU * self.frequency).max(hose)
    }

    fn relaxation(&self) -> f64 {
        // Off the middle by 0.4 of the stroke, beyond which the tests do not go, the two springs add up to a fifth more.
        0.6 * TAU * self.frequency / self.damping
    }
}
