//! The motion observer: displacement, velocity and the accelerometer's zero from an LVDT and an accelerometer.
//!
//! ```text
//! f  = a[k] + o                                  acceleration less its offset
//! xp = x + dt v + (dt^2 / 2) f                   prediction
//! e  = displacement[k] - xp                      innovation, m
//! x  = xp + l1 e,   v = v + dt f + l2 e,   o = o + l3 e
//! ```
//! The gains come from a crossover frequency ([`MotionObserver::crossover`]), for guard and velocity loop, or from the sensors'
//! noise ([`MotionObserver::kalman`]), for the tracking law. The offset `o` (m/s2, to be added to the reading) learns the
//! accelerometer's zero, so a bias makes no velocity. Without an accelerometer `a` is 0, `o` becomes the estimate of the
//! acceleration, and the observer is a third-order tracking differentiator of the LVDT.

use core::f32::consts::TAU;

use crate::block::{BlockError, require};
use crate::math;

/// The observer's configuration.
///
/// ```
/// use shakedown_core::blocks::filter::{MotionObserver, MotionState};
///
/// let observer = MotionObserver::crossover(2.0, 1e-3)?;
/// let mut state = MotionState::at(0.0);
/// for k in 1..=3000 {
///     observer.advance(&mut state, 0.1e-3 * k as f32, 0.0); // an even 0.1 m/s
/// }
/// assert!((state.velocity - 0.1).abs() < 1e-3);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionObserver {
    dt: f32,
    half_dt2: f32,
    l1: f32,
    l2: f32,
    l3: f32,
}

/// What the observer remembers; the default is rest at zero, [`MotionState::at`] rest elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct MotionState {
    /// Displacement, m.
    pub displacement: f32,
    /// Velocity, m/s.
    pub velocity: f32,
    /// Acceleration over the last tick, m/s2.
    pub acceleration: f32,
    /// What to add to the accelerometer's reading, m/s2.
    pub offset: f32,
    /// LVDT less prediction, m.
    pub innovation: f32,
}

impl MotionState {
    /// At rest at `displacement` (m).
    pub fn at(displacement: f32) -> Self {
        Self { displacement, ..Self::default() }
    }
}

impl MotionObserver {
    /// An observer that believes the LVDT below `frequency` (Hz, 0.1 up to a twentieth of the rate) and the accelerometer above,
    /// at ticks of `dt` (s). All three poles lie at z:
    ///
    /// ```text
    /// z = exp(-2 pi f dt),   l1 = 1 - z^3,   l2 = 3/2 (1 - z)^2 (1 + z) / dt,   l3 = (1 - z)^3 / dt^2
    /// ```
    pub fn crossover(frequency: f32, dt: f32) -> Result<Self, BlockError> {
        let dt = require("dt", dt, 1e-6, 1.0)?;
        let frequency = require("frequency", frequency, 0.1, 0.05 / dt)?;
        let z = math::exp(-TAU * frequency * dt);
        let y = -math::exp_m1(-TAU * frequency * dt);
        Ok(Self {
            dt,
            half_dt2: 0.5 * dt * dt,
            l1: y * (1.0 + z + z * z),
            l2: 1.5 * y * y * (1.0 + z) / dt,
            l3: y * y * y / (dt * dt),
        })
    }

    /// A Kalman observer in its steady state, for noise of `displacement` (m, 1e-9 to 0.01) and `acceleration` (m/s2, 1e-4 to
    /// 1000) at ticks of `dt` (s):
    ///
    /// ```text
    /// lambda = sigma_a dt^2 / sigma_x,   q = (sqrt(lambda^2 + 8 lambda) - lambda) / 4
    /// alpha = q (2 - q),   beta = 2 q^2,   gamma = beta^1.5 / 50
    /// l1 = alpha,   l2 = beta / dt,   l3 = gamma / dt^2
    /// ```
    /// alpha and beta are the steady Kalman gains for white noise of `sigma_x` (m) on the LVDT and of `sigma_a` (m/s2) on the
    /// accelerometer, each at every tick (Kalata 1984, the tracking index `lambda`). The crossover between the two sensors is
    /// `sqrt(beta) / dt` rad/s. gamma lets the accelerometer's zero be learned fifty times more slowly than that. Without an
    /// accelerometer `sigma_a` is the size of the accelerations to expect.
    pub fn kalman(displacement: f32, acceleration: f32, dt: f32) -> Result<Self, BlockError> {
        let x = require("tracking.noise.displacement", displacement, 1e-9, 0.01)?;
        let a = require("tracking.noise.acceleration", acceleration, 1e-4, 1000.0)?;
        // Beyond an index of 8 the LVDT alone is followed.
        let lambda = math::min(a * dt * dt / x, 8.0);
        let q = 0.25 * (math::sqrt(lambda * (lambda + 8.0)) - lambda);
        let beta = 2.0 * q * q;
        let gamma = 0.02 * beta * math::sqrt(beta);
        Ok(Self { dt, half_dt2: 0.5 * dt * dt, l1: q * (2.0 - q), l2: beta / dt, l3: gamma / (dt * dt) })
    }

    /// One tick without readings: the table goes on as it went, so that the next reading finds it where it is.
    #[cold]
    pub fn coast(&self, state: &mut MotionState) {
        state.displacement += self.dt * state.velocity;
        state.innovation = 0.0;
    }

    /// One tick: displacement (m) and acceleration (m/s2) as measured, both finite and within range.
    #[inline]
    pub fn advance(&self, state: &mut MotionState, displacement: f32, acceleration: f32) {
        let f = acceleration + state.offset;
        let predicted = state.displacement + self.dt * state.velocity + self.half_dt2 * f;
        let innovation = displacement - predicted;
        state.displacement = predicted + self.l1 * innovation;
        state.velocity = state.velocity + self.dt * f + self.l2 * innovation;
        state.offset += self.l3 * innovation;
        state.acceleration = f;
        state.innovation = innovation;
    }
}
