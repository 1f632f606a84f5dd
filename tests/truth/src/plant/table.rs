//! Forces on the table, per table mass, and the lost motion between actuator and table.

use std::f64::consts::TAU;

/// Everything that holds the table back.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// Dry friction.
    pub friction: Option<Friction>,
    /// Break-away levels scatter up to this share above theirs, redrawn at each reversal (1).
    pub breakaway_spread: Option<f64>,
    /// Lubricant: coefficient (1/s) and the velocity about which it thins (m/s).
    pub viscous: Option<(f64, f64)>,
    /// Drag: coefficient of `v |v|` (1/m).
    pub quadratic: f64,
    /// Hose bundle: stiffness over table mass (1/s2).
    pub hose: f64,
    /// Ripple per travelled distance: amplitude (m/s2), wavelength (m), phase (rad).
    pub ripple: Option<(f64, f64, f64)>,
    /// Cushions at the ends.
    pub stop: Option<Stop>,
    /// Constant force (m/s2), positive along x.
    pub offset: f64,
    /// Lost motion.
    pub backlash: Option<Backlash>,
}

/// `LuGre` friction (Canudas de Wit et al. 1995): bristles that bend before they slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Level when sliding (m/s2).
    pub sliding: f64,
    /// Level at break-away (m/s2).
    pub breakaway: f64,
    /// Stribeck velocity (m/s).
    pub stribeck: f64,
    /// Deflection at which bristles slip (m).
    pub presliding: f64,
    /// A rough patch instead of friction everywhere: centre and width (m).
    pub patch: Option<(f64, f64)>,
}

/// Cushion: a force that rises faster than the penetration, with oil squeezed out of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    /// Where it begins, either side (m).
    pub position: f64,
    /// Stiffness over table mass at the scale of the penetration (1/s2).
    pub stiffness: f64,
    /// Exponent of the penetration (1).
    pub exponent: f64,
    /// Penetration at which the stiffness is stated (m).
    pub scale: f64,
    /// Damping while going in (1/s).
    pub damping: f64,
}

/// Lost motion as a hysteresis in the manner of Bouc and Wen: contact stiffens over the last part of the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Backlash {
    /// Full gap (m).
    pub gap: f64,
    /// Sharpness of the contact (1).
    pub sharpness: f64,
}

impl Backlash {
    /// Table velocity from actuator velocity, at a place within the gap.
    pub(super) fn passed(&self, v: f64, place: f64) -> f64 {
        let filled = 2.0 * place / self.gap;
        if v * filled <= 0.0 { 0.0 } else { v * filled.abs().powf(self.sharpness).min(1.0) }
    }
}

/// Above this speed (m/s) bristles are in equilibrium, and their pace is held so that the equations stay mild.
const BRISTLE_PACE: f64 = 0.03;

impl Friction {
    /// Force per table mass, positive against positive motion, and the bristles' rate.
    fn force(&self, x: f64, v: f64, bristle: f64, level: f64, rate: &mut f64) -> f64 {
        let stiffness = self.sliding.max(1e-12) / self.presliding;
        let static_level = self.breakaway * level;
        let slip = self.sliding + (static_level - self.sliding) * (-(v / self.stribeck).powi(2)).exp();
        let pace = 1.0 / (1.0 + v.abs() / BRISTLE_PACE);
        *rate = pace * (v - stiffness * v.abs() / slip * bristle);
        let here = self.patch.map_or(1.0, |(centre, width)| (-((x - centre) / width).powi(2)).exp());
        // Micro-damping of two per cent of the level at 10 mm/s: enough to stop the bristles from ringing.
        here * (stiffness * bristle + 2.0 * self.sliding * *rate)
    }
}

impl Table {
    pub(super) fn force(&self, x: f64, v: f64, bristle: f64, level: f64, rate: &mut f64) -> f64 {
        let mut force = -self.offset + self.hose * x + self.quadratic * v * v.abs();
        if let Some(friction) = &self.friction {
            force += friction.force(x, v, bristle, level, rate);
        }
        if let Some((coefficient, about)) = self.viscous {
            force += coefficient * v * (1.0 + (v / about).powi(2)).powf(-0.03);
        }
        if let Some((amplitude, wavelength, phase)) = self.ripple {
            force += amplitude * ((TAU * x / wavelength + phase).sin() - phase.sin());
        }
        if let Some(stop) = &self.stop {
            force += stop.force(x, v);
        }
        force
    }
}

impl Stop {
    fn force(&self, x: f64, v: f64) -> f64 {
        let depth = x.abs() - self.position;
        if depth <= 0.0 {
            return 0.0;
        }
        let inward = (v * x.signum()).max(0.0);
        let spring = self.stiffness * self.scale * (depth / self.scale).powf(self.exponent);
        x.signum() * (spring + self.damping * inward * (depth / self.scale).min(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::{Backlash, Friction};

    #[test]
    fn bristles_settle_at_the_sliding_level() {
        let friction = Friction { sliding: 0.3, breakaway: 0.3, stribeck: 0.01, presliding: 3e-5, patch: None };
        let (mut bristle, mut rate) = (0.0, 0.0);
        for _ in 0..100_000 {
            friction.force(0.0, 0.05, bristle, 1.0, &mut rate);
            bristle += 1e-5 * rate;
        }
        assert!((friction.force(0.0, 0.05, bristle, 1.0, &mut rate) - 0.3).abs() < 1e-3);
    }

    #[test]
    fn the_gap_passes_nothing_inside_everything_at_its_edge_and_nothing_on_the_way_back() {
        let gap = Backlash { gap: 2e-4, sharpness: 16.0 };
        assert!(gap.passed(0.1, 0.0).abs() < 1e-15);
        assert!((gap.passed(0.1, 1e-4) - 0.1).abs() < 1e-15);
        assert_eq!(gap.passed(-0.1, 1e-4), 0.0);
    }
}
