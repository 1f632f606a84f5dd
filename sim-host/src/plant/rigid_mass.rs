//! The table as a damped rigid mass, Eq. 1 to 3: `m x'' + c x' = u`, `G(s) = 1 / (m s^2 + c s)`.
//!
//! With the force held, v approaches `u / c` as one exponential of rate `c / m` and x is its integral; with no
//! damping both are polynomials. Exact for steps of any length.

use super::Plant;
use super::paper::{ParameterError, finite, positive};

/// Parameters of Eq. 1.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigidMass {
    /// Moving mass, kg.
    pub mass: f64,
    /// Viscous damping, N s/m; zero for none.
    pub viscous: f64,
    /// Force per unit of command, N; 1 where the command is a force already.
    #[serde(default = "one")]
    pub gain: f64,
}

fn one() -> f64 {
    1.0
}

impl RigidMass {
    /// Checks every parameter.
    pub fn validate(&self) -> Result<(), ParameterError> {
        positive("mass", self.mass)?;
        finite("mass", self.mass)?;
        finite("viscous", self.viscous)?;
        finite("gain", self.gain)
    }
}

/// A rigid mass at a fixed step.
#[derive(Debug, Clone)]
pub struct FixedStep {
    body: RigidMass,
    dt: f64,
    /// `exp(-c dt / m)`.
    kept: f64,
    /// Velocity gained per newton held over a step, `(1 - exp(-c dt / m)) / c`, s/kg.
    gained: f64,
    /// Travel in a step per m/s at its start, `m (1 - exp(-c dt / m)) / c`, s.
    carried: f64,
    /// Travel in a step per newton held over it, m/N.
    pushed: f64,
    displacement: f64,
    velocity: f64,
}

impl FixedStep {
    /// The mass at rest at `displacement` (m), to be moved on in steps of `dt` seconds.
    pub fn new(body: RigidMass, dt: f64, displacement: f64) -> Result<Self, ParameterError> {
        body.validate()?;
        positive("dt", dt)?;
        finite("dt", dt)?;
        finite("displacement", displacement)?;
        let rate = body.viscous / body.mass;
        let (carried, pushed) = integrals(rate * dt, dt);
        Ok(Self {
            body,
            dt,
            kept: (-rate * dt).exp(),
            gained: carried / body.mass,
            carried,
            pushed: pushed / body.mass,
            displacement,
            velocity: 0.0,
        })
    }
}

/// `dt phi1(-q)` and `dt^2 phi2(-q)`, the once and twice integrated exponential, by series where `q` is small.
fn integrals(q: f64, dt: f64) -> (f64, f64) {
    if q.abs() < 1e-3 {
        let first = 1.0 - q / 2.0 * (1.0 - q / 3.0 * (1.0 - q / 4.0 * (1.0 - q / 5.0)));
        let second = 0.5 * (1.0 - q / 3.0 * (1.0 - q / 4.0 * (1.0 - q / 5.0 * (1.0 - q / 6.0))));
        return (dt * first, dt * dt * second);
    }
    let first = -(-q).exp_m1() / q;
    (dt * first, dt * dt * (1.0 - first) / q)
}

impl Plant for FixedStep {
    fn step_length(&self) -> f64 {
        self.dt
    }

    fn advance(&mut self, command: f64, steps: usize) {
        let force = self.body.gain * command;
        for _ in 0..steps {
            self.displacement += self.carried * self.velocity + self.pushed * force;
            self.velocity = self.kept * self.velocity + self.gained * force;
        }
    }

    fn displacement(&self) -> f64 {
        self.displacement
    }

    fn velocity(&self, _command: f64) -> f64 {
        self.velocity
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Eq. 1 solved for a constant force from rest, written independently of the step's form.
        #[test]
        fn constant_force_from_rest(mass in 1.0..1e4f64, rate in 1e-6..50.0f64, force in -1e4..1e4f64) {
            let body = RigidMass { mass, viscous: rate * mass, gain: 1.0 };
            let mut plant = FixedStep::new(body, 1e-3, 0.0).unwrap();
            plant.advance(force, 1000);
            let (settled, t) = (force / body.viscous, 1.0);
            let decayed = -(-rate * t).exp_m1();
            prop_assert!((plant.velocity(force) - settled * decayed).abs() < 1e-9 * (force / mass).abs().max(1e-9));
            let x = if rate > 1e-3 { settled * (t - decayed / rate) } else { force / mass / 2.0 * (1.0 - rate / 3.0) };
            prop_assert!((plant.displacement() - x).abs() < 1e-6 * (force / mass).abs().max(1e-9));
        }
    }

    #[test]
    fn no_damping_is_a_parabola() {
        let body = RigidMass { mass: 5000.0, viscous: 0.0, gain: 1.0 };
        let mut plant = FixedStep::new(body, 1e-3, 0.02).unwrap();
        plant.advance(1000.0, 2000);
        assert!((plant.velocity(0.0) - 0.4).abs() < 1e-12);
        assert!((plant.displacement() - 0.42).abs() < 1e-12);
    }
}
