//! A table on its oil column: feedforward of acceleration and jerk, observer of load and disturbance, feedback of all
//! three states.
//!
//! ```text
//! p' = w^2 (q - v) - c p + d,   v' = p,   c = 2 zeta w                     p the load per table mass, m/s2
//! observer:     p = pp + l1 e,   d = d + l2 e,   e = a[k] - (mean of p over the last tick)
//!               l1 = 1 - z^2,   l2 = (1 - z)^2 / dt,   z = exp(-2 pi fo dt)
//! feedforward:  q = v_r + (j_r + c a_r) / w^2
//! feedback:     q = q + (ka (a_r - p) + kv (v_r - v) + kx (x_r - x) - d) / w^2
//!               ka = 3 wc - c,   kv = 3 wc^2 - w^2,   kx = wc^3,   wc = 2 pi fc
//! ```
//! Nominally all three poles of the error lie at wc, the resonance among them. d (m/s3) is all that the model lacks: a
//! wrong gain, pole, mass or supply, a payload's reaction. Without a disturbance observer (`fo` = 0) p is the measured
//! acceleration.

use super::trajectory::ReferenceState;
use crate::block::{BlockError, require};
use crate::math;
use crate::scalar::Scalar;

/// The table's mode on its oil column.
///
/// ```
/// use shakedown_core::settings::{OilSettings, TrackingSettings};
///
/// let oil = Some(OilSettings { frequency: 25.0, damping: 0.05 });
/// assert!(TrackingSettings { oil, ..TrackingSettings::default() }.oil.is_some());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct OilSettings {
    /// Natural frequency, Hz.
    pub frequency: f32,
    /// Damping ratio, 1.
    pub damping: f32,
}

/// The configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{OilColumn, ReferenceState};
/// use shakedown_core::settings::OilSettings;
///
/// let oil = OilColumn::new(&OilSettings { frequency: 25.0, damping: 0.05 }, [5.0, 20.0], 0.242, 1e-3)?;
/// // At an even speed the oil column asks for no more flow than that speed.
/// assert_eq!(oil.forward(&ReferenceState { velocity: 0.1, ..ReferenceState::default() }), 0.1);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OilColumn {
    dt: f32,
    square: f32,
    per_square: f32,
    leak: f32,
    l1: f32,
    l2: f32,
    gains: [f32; 3],
    limit: f32,
}

/// What the observer remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OilState {
    /// Load per table mass, m/s2.
    pub load: f32,
    /// Rate of the load beyond the model, m/s3.
    pub disturbance: f32,
}

impl OilColumn {
    /// For feedback of `bandwidth` (Hz) and a disturbance observer up to `observer` (Hz), each up to a fifth of the rate,
    /// at ticks of `dt` (s); the disturbance stays within what a flow of `limit` (m/s) could undo.
    pub fn new(
        settings: &OilSettings,
        [bandwidth, observer]: [f32; 2],
        limit: f32,
        dt: f32,
    ) -> Result<Self, BlockError> {
        use core::f32::consts::TAU;
        let w = TAU * require("tracking.oil.frequency", settings.frequency, 0.5, 0.2 / dt)?;
        let damping = require("tracking.oil.damping", settings.damping, 0.0, 2.0)?;
        let wc = TAU * require("tracking.bandwidth", bandwidth, 0.0, 0.2 / dt)?;
        let y = -math::exp_m1(-TAU * require("tracking.disturbance", observer, 0.0, 0.2 / dt)? * dt);
        let (square, leak) = (w * w, 2.0 * damping * w);
        let (l1, l2) = if y > 0.0 { (y * (2.0 - y), y * y / dt) } else { (1.0, 0.0) };
        let gains = if wc > 0.0 { [wc * wc * wc, 3.0 * wc * wc - square, 3.0 * wc - leak] } else { [0.0; 3] };
        Ok(Self { dt, square, per_square: 1.0 / square, leak, l1, l2, gains, limit: limit * square })
    }

    /// Takes in the last tick: flow made over it (m/s), mean velocity (m/s) and acceleration (m/s2) measured over it.
    #[inline]
    pub fn observe(&self, state: &mut OilState, flow: f32, velocity: f32, acceleration: f32) {
        let rate = self.square * (flow - velocity) - self.leak * state.load + state.disturbance;
        let predicted = state.load + self.dt * rate;
        let innovation = acceleration - 0.5 * (predicted + state.load);
        state.load = predicted + self.l1 * innovation;
        state.disturbance = (state.disturbance + self.l2 * innovation).bounded(self.limit);
    }

    /// The flow that makes the reference's motion on the model, m/s.
    #[inline]
    pub fn forward(&self, ahead: &ReferenceState) -> f32 {
        ahead.velocity + self.per_square * (ahead.jerk + self.leak * ahead.acceleration)
    }

    /// Flow per displacement error, 1/s.
    pub fn stiffness(&self) -> f32 {
        self.per_square * self.gains[0]
    }

    /// The flow that undoes the errors of displacement (m), velocity (m/s) and acceleration (m/s2) and the disturbance,
    /// m/s.
    #[inline]
    pub fn feedback(&self, state: &OilState, errors: [f32; 3]) -> f32 {
        let ([kx, kv, ka], [x, v, a]) = (self.gains, errors);
        self.per_square * (kx * x + kv * v + ka * a - state.disturbance)
    }
}
