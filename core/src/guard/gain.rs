//! The valve command as a second witness of the LVDT's gain: how far the table moves by its LVDT for what the command asks.
//!
//! ```text
//! v, w = lag(measured velocity), lag(velocity that the identified model makes of the command)         both by [`SLOW`], m/s
//! g = mean(v w) / mean(w^2)        over the turns in which |w| > V / 10 and the command is not at the limit in force
//! |g - g0| > 0.25 g0: the LVDT's gain or the flow gain has changed
//! ```
//! V is the velocity limit; the
//! means have a time constant of [`MEMORY`] of such turns. g0 is g after the first of them since the test was armed, so a
//! model whose gain is wrong by any factor judges as well as a good one. A quarter is more than what load, amplitude and
//! frequency within a record change of a table's flow gain; a loop that is closed over the LVDT goes 1 / 0.75 of its
//! reference by then. Both are lagged because a gain that is wrong does harm where the table goes far, which at its speed is below
//! 1 Hz, and because the model has no oil column: near its resonance a healthy table moves in quadrature to its command, or against it,
//! which says nothing of a gain. A supply that sags below 0.56 of its pressure changes the flow gain as much, and trips as well.

use crate::block::whole_ticks;
use crate::math::{Magnitude, max};
use crate::scalar::Scalar;

/// Time constant of the means, s of motion.
const MEMORY: f32 = 2.0;
/// Time constant of the lag before them, s: a corner of 1 Hz.
const SLOW: f32 = 0.16;
/// Largest change of the gain, 1.
const CHANGE: f32 = 0.25;

/// Gains of a table that the model is still good for, 1.
pub(super) const BELIEVED: (f32, f32) = (0.65, 1.35);

/// The gain by which a table does what the model says, 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Gain {
    /// Nothing has been learned of it.
    Unknown,
    /// As far as it has been learned.
    Estimated(f32),
    /// Learned.
    Known(f32),
}

impl Gain {
    /// The best guess at it, 1.
    #[inline]
    pub(super) fn value(self) -> f32 {
        match self {
            Self::Unknown => 1.0,
            Self::Estimated(gain) | Self::Known(gain) => gain,
        }
    }
}

/// The witness's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GainWitness {
    share: f32,
    /// What a turn takes over into the lagged velocities, 1.
    slow: f32,
    /// Turns until the gain is known.
    learn: u32,
}

/// What it remembers: the lagged velocities; mean of v w and of w^2, m2/s2; turns so far; and the gain at first, 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct GainState {
    /// The lagged velocities: expected and measured, m/s.
    expected: f32,
    measured: f32,
    both: f32,
    square: f32,
    turns: u32,
    first: f32,
}

impl GainWitness {
    /// A witness at turns of `dt` (s).
    pub(super) fn new(dt: f32) -> Self {
        Self { share: dt / MEMORY, slow: (dt / SLOW).min(1.0), learn: whole_ticks(MEMORY, dt) }
    }

    /// One turn: velocity asked for (m/s), limit in force (m/s), velocity expected of it and measured (m/s). True: the gain
    /// has changed.
    #[inline]
    pub(super) fn advance(self, state: &mut GainState, asked: f32, limit: f32, expected: f32, measured: f32) -> bool {
        if !Magnitude::new(0.95 * limit).holds(asked) {
            // What the table does at its limit is no answer to the command, and is not carried over.
            (state.expected, state.measured) = (0.0, 0.0);
            return false;
        }
        state.expected += self.slow * (expected - state.expected);
        state.measured += self.slow * (measured - state.measured);
        let (expected, measured) = (state.expected, state.measured);
        if Magnitude::new(0.1 * limit).holds(expected) {
            return false;
        }
        if state.turns < self.learn {
            // A plain mean at first, so that the first gain is as good as the later ones.
            state.turns += 1;
            let share = max(self.share, 1.0 / state.turns as f32);
            state.average(share, expected, measured);
            state.first = if state.square > 0.0 { state.both / state.square } else { 0.0 };
            return false;
        }
        state.average(self.share, expected, measured);
        let change = state.both - state.first * state.square;
        !Magnitude::new(CHANGE * state.first * state.square).holds(change)
    }
}

impl GainState {
    /// The gain by which the table does what the model says: an estimate from an eighth of the time on.
    #[inline]
    pub(super) fn gain(&self, witness: GainWitness) -> Gain {
        let first = self.first.within(BELIEVED.0, BELIEVED.1);
        if self.turns >= witness.learn {
            Gain::Known(first)
        } else if self.turns >= witness.learn / 8 {
            Gain::Estimated(first)
        } else {
            Gain::Unknown
        }
    }

    #[inline]
    fn average(&mut self, share: f32, expected: f32, measured: f32) {
        self.both += share * (measured * expected - self.both);
        self.square += share * (expected * expected - self.square);
    }
}
