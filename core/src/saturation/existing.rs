//! What an existing controller asks of the valve, whose command is not ours to see: learned from what the table does.
//!
//! A position loop makes its command of its error e, so that a table below its limit moves by
//!
//! ```text
//! v + lag a = K e                                        lag that of the valve, s; K in 1/s
//! K = mean((v + lag a) e) / mean(e^2)                    over the turns in which |a| > plateau
//! d = K e                                                speed that it asks for, m/s
//! ```
//! A table that accelerates is not at its limit, so what is learned from is not saturated. The means forget with time
//! constant [`MEMORY`], counted in turns that are learned from. Until the error has been seen to be of some size, nothing is
//! said to be asked for.
//!
//! The reference's own velocity is no measure of it: a loop of 2 Hz lags a reference of 1 Hz at every crest of its swing.

use crate::math::Magnitude;

/// Time after which what was learned is forgotten, s of accelerated motion.
const MEMORY: f32 = 10.0;
/// Mean square of the error from which K is believed, m2: as 5 mm give in a tenth of a second.
const LEAST: f32 = 2.5e-7;

/// The configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Existing {
    lag: f32,
    share: f32,
    plateau: Magnitude,
}

/// What is remembered: mean of flow times error, m2/s, and of the error's square, m2.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExistingState {
    pull: f32,
    square: f32,
}

impl Existing {
    /// Nothing is learned, and nothing said to be asked for.
    pub(crate) const fn none() -> Self {
        Self { lag: 0.0, share: 0.0, plateau: Magnitude::ZERO }
    }

    /// For a valve of time constant `lag` (s) and the [`plateau`](super::Detection::plateau) of saturation detection (m/s2) at
    /// ticks of `dt` (s).
    pub const fn new(lag: f32, plateau: f32, dt: f32) -> Self {
        Self { lag, share: dt / MEMORY, plateau: Magnitude::new(plateau) }
    }

    /// One tick: velocity (m/s), low-passed acceleration (m/s2) and displacement error (m) in, speed asked for (m/s) out.
    #[inline(never)]
    pub fn advance(&self, state: &mut ExistingState, velocity: f32, acceleration: f32, error: f32) -> f32 {
        if !self.plateau.holds(acceleration) {
            let flow = velocity + self.lag * acceleration;
            state.pull += self.share * (flow * error - state.pull);
            state.square += self.share * (error * error - state.square);
        }
        if state.square > LEAST { state.pull / state.square * error } else { 0.0 }
    }
}
