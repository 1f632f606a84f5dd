//! What an existing controller asks of the valve, whose command is not ours to see: learned from what the table does.
//!
//! A position loop makes its command of its error e, so that a table below its limit moves by
//!
//! ```text
//! v = K f,   f[k] = f[k-1] + (dt / lag) (e - f[k-1])     lag that of the valve, s; K in 1/s
//! K = mean(v f) / mean(f^2)                              weighted by a^2, over the turns in which |a| > plateau
//! d = K f + lag a                                        speed that it asks for, m/s: what is behind the lag is K f
//! ```
//! A table that accelerates is not at its limit, so what is learned from is not saturated. The acceleration says when to learn
//! and how much, and nothing of what: where its noise decides that a table accelerates, v + lag a = K e would learn the noise,
//! half as much again as K on slow swings. Its square leaves little weight to such turns, and to those in which the low-passed
//! acceleration of a table that has just come to its limit still fades. The means forget with time constant [`MEMORY`]. Until
//! the error has been seen to be of some size, nothing is said to be asked for.
//!
//! The reference's own velocity is no measure of it: a loop of 2 Hz lags a reference of 1 Hz at every crest of its swing.

use crate::math::Magnitude;

/// Time after which what was learned is forgotten, s of motion accelerated at 1 m/s2; a hundredth of it at 10 m/s2.
const MEMORY: f32 = 10.0;
/// Mean square of the error from which K is believed, m2: as 5 mm give in a tenth of a second at 1 m/s2.
const LEAST: f32 = 2.5e-7;

/// Most that one turn weighs, 1: a blow on the accelerometer does not wipe out what was learned before.
const MOST: f32 = 0.1;

/// The configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExternalLoopEstimator {
    lag: f32,
    smoothing: f32,
    share: f32,
    plateau: Magnitude,
}

/// What is remembered: the error behind the valve's lag, m; mean of velocity times it, m2/s, and of its square, m2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct ExternalLoopState {
    error: f32,
    pull: f32,
    square: f32,
}

impl ExternalLoopEstimator {
    /// For a valve of time constant `lag` (s) and the [`plateau`](super::Detection::plateau) of saturation detection (m/s2) at
    /// ticks of `dt` (s).
    pub(super) const fn new(lag: f32, plateau: f32, dt: f32) -> Self {
        // A lag shorter than a tick is none.
        let smoothing = if lag > dt { dt / lag } else { 1.0 };
        Self { lag, smoothing, share: dt / MEMORY, plateau: Magnitude::new(plateau) }
    }

    /// One tick: velocity (m/s), low-passed acceleration (m/s2) and displacement error (m) in, speed asked for (m/s) out.
    #[inline(never)]
    pub(super) fn advance(&self, state: &mut ExternalLoopState, velocity: f32, acceleration: f32, error: f32) -> f32 {
        state.error += self.smoothing * (error - state.error);
        let error = state.error;
        if !self.plateau.holds(acceleration) {
            let share = self.share * acceleration * acceleration;
            let share = if share < MOST { share } else { MOST };
            state.pull += share * (velocity * error - state.pull);
            state.square += share * (error * error - state.square);
        }
        if state.square > LEAST { state.pull / state.square * error + self.lag * acceleration } else { 0.0 }
    }
}
