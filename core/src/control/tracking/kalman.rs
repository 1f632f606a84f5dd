//! Kalman observer of displacement and velocity from LVDT and accelerometer, in its steady state.
//!
//! ```text
//! f  = a[k] + o                                      acceleration less its offset
//! xp = x + dt v + (dt^2 / 2) f,   e = displacement[k] - xp
//! x  = xp + alpha e,   v = v + dt f + (beta / dt) e,   o = o + (gamma / dt^2) e
//! lambda = sigma_a dt^2 / sigma_x,   q = (sqrt(lambda^2 + 8 lambda) - lambda) / 4
//! alpha = q (2 - q),   beta = 2 q^2,   gamma = beta^1.5 / 50
//! ```
//! alpha and beta are the steady Kalman gains for white noise of `sigma_x` (m) on the LVDT and of `sigma_a` (m/s2) on the
//! accelerometer, each at every tick (Kalata 1984, the tracking index `lambda`). The crossover between the two sensors is
//! `sqrt(beta) / dt` rad/s. gamma lets the accelerometer's zero be learned fifty times more slowly than that. Without an
//! accelerometer `a` is 0 and `sigma_a` the size of the accelerations to expect.

use crate::block::{BlockError, require};
use crate::math;

/// The observer's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kalman {
    dt: f32,
    half_dt2: f32,
    alpha: f32,
    beta: f32,
    gamma: f32,
}

/// What the observer remembers; the default is rest at zero.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct KalmanState {
    /// Displacement, m.
    pub displacement: f32,
    /// Velocity, m/s.
    pub velocity: f32,
    /// Acceleration over the last tick, m/s2.
    pub acceleration: f32,
    /// What to add to the accelerometer's reading, m/s2.
    pub offset: f32,
}

impl KalmanState {
    /// At rest at `displacement` (m).
    pub fn at(displacement: f32) -> Self {
        Self { displacement, ..Self::default() }
    }
}

impl Kalman {
    /// For noise of `displacement` (m, 1e-9 to 0.01) and `acceleration` (m/s2, 1e-4 to 1000) at ticks of `dt` (s).
    pub fn new(displacement: f32, acceleration: f32, dt: f32) -> Result<Self, BlockError> {
        let x = require("tracking.noise.displacement", displacement, 1e-9, 0.01)?;
        let a = require("tracking.noise.acceleration", acceleration, 1e-4, 1000.0)?;
        let lambda = a * dt * dt / x;
        // Beyond an index of 8 the LVDT alone is followed.
        let lambda = math::min(lambda, 8.0);
        let q = 0.25 * (math::sqrt(lambda * (lambda + 8.0)) - lambda);
        let beta = 2.0 * q * q;
        let gamma = 0.02 * beta * math::sqrt(beta);
        Ok(Self { dt, half_dt2: 0.5 * dt * dt, alpha: q * (2.0 - q), beta: beta / dt, gamma: gamma / (dt * dt) })
    }

    /// One tick: displacement (m) and acceleration (m/s2) as measured, both finite and within range.
    #[inline]
    pub fn advance(&self, state: &mut KalmanState, displacement: f32, acceleration: f32) {
        let f = acceleration + state.offset;
        let predicted = state.displacement + self.dt * state.velocity + self.half_dt2 * f;
        let innovation = displacement - predicted;
        state.displacement = predicted + self.alpha * innovation;
        state.velocity = state.velocity + self.dt * f + self.beta * innovation;
        state.offset += self.gamma * innovation;
        state.acceleration = f;
    }
}
