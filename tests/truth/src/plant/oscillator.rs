//! Structures that swing: the specimen on the table and the foundation under it.

use crate::ode::State;
use crate::plant::state as at;
use std::f64::consts::TAU;

/// Specimen of up to two storeys, with columns that soften or stiffen, or that pound against a stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Payload {
    /// Mass over the table's (1).
    pub mass_ratio: f64,
    /// First storey's frequency when rigid above (Hz).
    pub frequency: f64,
    /// Damping ratio (1).
    pub damping: f64,
    /// Change of stiffness with stretch (1/m2); negative softens.
    pub cubic: f64,
    /// Second storey: mass over the first's (1), frequency over the first's (1).
    pub second: Option<(f64, f64)>,
    /// Free stretch (m) before it pounds against a stop of this many times its stiffness (1).
    pub pounding: Option<(f64, f64)>,
}

impl Payload {
    /// Rates of its states from the table's velocity; returns the force on the table per table mass, positive against x.
    pub(super) fn derivative(&self, table: f64, y: &State, dy: &mut State) -> f64 {
        let (stretch, speed) = (y[at::PAYLOAD], y[at::PAYLOAD + 1]);
        let w = TAU * self.frequency;
        let slip = speed - table;
        let mut shear =
            w * w * stretch * (1.0 + self.cubic * stretch * stretch).max(0.2) + 2.0 * self.damping * w * slip;
        if let Some((free, times)) = self.pounding {
            let beyond = (stretch.abs() - free).max(0.0);
            shear += stretch.signum() * times * w * w * beyond;
        }
        dy[at::PAYLOAD] = slip;
        let mut above = 0.0;
        if let Some((mass, frequency)) = self.second {
            let w2 = w * frequency;
            let slip2 = y[at::PAYLOAD + 3] - speed;
            let shear2 = w2 * w2 * y[at::PAYLOAD + 2] + 2.0 * self.damping * w2 * slip2;
            dy[at::PAYLOAD + 2] = slip2;
            dy[at::PAYLOAD + 3] = -shear2;
            above = mass * shear2;
        }
        dy[at::PAYLOAD + 1] = -shear + above;
        -self.mass_ratio * shear
    }
}

/// Reaction mass on soil. The actuator pushes against it, so the displacement sensor sees only the difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Base {
    /// Table mass over the reaction mass (1).
    pub mass_ratio: f64,
    /// Frequency of reaction mass and table together (Hz).
    pub frequency: f64,
    /// Damping ratio (1).
    pub damping: f64,
    /// Change of stiffness with displacement (1/m2).
    pub cubic: f64,
}

impl Base {
    fn share(&self) -> f64 {
        self.mass_ratio / (1.0 + self.mass_ratio)
    }

    /// Velocity of the base from the conserved momentum and the actuator's velocity.
    pub(super) fn velocity(&self, actuator: f64, momentum: f64) -> f64 {
        momentum - self.share() * actuator
    }

    pub(super) fn derivative(&self, actuator: f64, y: &State, dy: &mut State) {
        let w = TAU * self.frequency;
        let place = y[at::BASE];
        let velocity = self.velocity(actuator, y[at::BASE + 1]);
        dy[at::BASE] = velocity;
        dy[at::BASE + 1] = -w * w * place * (1.0 + self.cubic * place * place) - 2.0 * self.damping * w * velocity;
    }
}
