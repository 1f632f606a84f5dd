//! Velocity from an LVDT and an accelerometer, each where it is good: one observer for everything that needs it.
//!
//! ```text
//! f      = a[k] + o                                  acceleration less its offset
//! xp     = x + dt v + (dt^2 / 2) f                   prediction
//! e      = displacement[k] - xp                      innovation, m
//! x      = xp + l1 e,   v = v + dt f + l2 e,   o = o + l3 e
//! z = exp(-2 pi f dt),   l1 = 1 - z^3,   l2 = 3/2 (1 - z)^2 (1 + z) / dt,   l3 = (1 - z)^3 / dt^2
//! ```
//! All three poles lie at `z`: below the frequency the LVDT is believed, above it the accelerometer. The offset `o`
//! (m/s2, to be added to the reading) learns the accelerometer's zero, so a bias makes no velocity. Without an
//! accelerometer `a` is 0, `o` becomes the estimate of the acceleration, and the observer is a third-order tracking
//! differentiator of the LVDT. The innovation is what tells two sensors that disagree ([`crate::guard`]).

use core::f32::consts::TAU;

use crate::block::{BlockError, require};
use crate::math;

/// The observer's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fusion {
    dt: f32,
    half_dt2: f32,
    l1: f32,
    l2: f32,
    l3: f32,
}

/// What the observer remembers; the default is rest at zero, [`FusionState::at`] rest elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FusionState {
    /// Displacement, m.
    pub displacement: f32,
    /// Velocity, m/s.
    pub velocity: f32,
    /// What to add to the accelerometer's reading, m/s2.
    pub offset: f32,
    /// LVDT less prediction, m.
    pub innovation: f32,
}

impl FusionState {
    /// At rest at `displacement` (m).
    pub fn at(displacement: f32) -> Self {
        Self { displacement, ..Self::default() }
    }
}

impl Fusion {
    /// No observer: what was last seen stands.
    pub(crate) const fn none() -> Self {
        Self { dt: 0.0, half_dt2: 0.0, l1: 0.0, l2: 0.0, l3: 0.0 }
    }

    /// An observer that believes the LVDT below `frequency` (Hz, 0.1 up to a twentieth of the rate) at ticks of `dt` (s).
    pub fn new(frequency: f32, dt: f32) -> Result<Self, BlockError> {
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

    /// One tick without readings: the table goes on as it went, so that the next reading finds it where it is.
    #[cold]
    pub fn coast(&self, state: &mut FusionState) {
        state.displacement += self.dt * state.velocity;
        state.innovation = 0.0;
    }

    /// One tick: displacement (m) and acceleration (m/s2) as measured, both finite and within range.
    #[inline]
    pub fn advance(&self, state: &mut FusionState, displacement: f32, acceleration: f32) {
        let f = acceleration + state.offset;
        let predicted = state.displacement + self.dt * state.velocity + self.half_dt2 * f;
        let innovation = displacement - predicted;
        state.displacement = predicted + self.l1 * innovation;
        state.velocity = state.velocity + self.dt * f + self.l2 * innovation;
        state.offset += self.l3 * innovation;
        state.innovation = innovation;
    }
}
