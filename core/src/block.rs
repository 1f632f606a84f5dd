//! The shape of every block: a validated, immutable configuration apart from its state.
//!
//! A block is two values. Its *configuration* is made once, from physical quantities, by a constructor that checks
//! them and works out every coefficient; it never changes afterwards. Its *state* is what a tick remembers. So a law is
//! retuned by exchanging one configuration for another between two ticks, whole, while the state goes on: nothing is
//! ever half retuned, and what the state means (an integral in the output's unit, the last input, the last output)
//! does not depend on the coefficients, so that the exchange makes no bump beyond the new gain on the present input.
//!
//! [`Block::advance`] is the bare recurrence, generic over [`Scalar`]; it trusts its input. [`Block::step`] is the same
//! recurrence behind a wall: an input that is not a finite number within the block's range leaves the state as it
//! was, and the last good output is given again, marked [`Held::Last`].
//!
//! [`crate::Controller`] puts walls at its edge, once, and calls `advance` inside: a check in every block would cost a
//! fifth of the tick and say nothing new.

use crate::scalar::Scalar;

/// Largest magnitude that a block takes, in whatever unit: far above any signal of a shake table, and far enough below
/// the largest `f32` that no recurrence here overflows.
pub const RANGE: f32 = 1e9;

/// An output, and whether it is of this tick.
///
/// ```
/// use shakedown_core::blocks::filter::{Lag, LagState};
/// use shakedown_core::blocks::{Block, Held};
///
/// let lag = Lag::<f32>::new(0.0, 1e-3)?;
/// let mut state = LagState::at(0.5);
/// assert_eq!(lag.step(&mut state, f32::NAN), Held::Last(0.5));
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Held<T> {
    /// Computed from this tick's input.
    Fresh(T),
    /// The input was not a finite number within range: the last good output.
    Last(T),
}

impl<T: Copy> Held<T> {
    /// The output, fresh or held.
    #[inline]
    pub fn value(self) -> T {
        match self {
            Self::Fresh(value) | Self::Last(value) => value,
        }
    }

    /// Whether the last good output was held.
    #[inline]
    pub fn is_held(self) -> bool {
        matches!(self, Self::Last(_))
    }
}

/// A configuration that advances a state by one tick.
///
/// ```
/// use shakedown_core::blocks::filter::{Lag, LagState};
/// use shakedown_core::blocks::{Block, Held};
///
/// let lag = Lag::<f32>::new(0.01, 1e-3)?;
/// let mut state = LagState::default();
/// let first = lag.advance(&mut state, 1.0); // the bare recurrence
/// assert_eq!(lag.step(&mut state, f32::NAN), Held::Last(first)); // and behind its wall
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
pub trait Block<S: Scalar = f32> {
    /// What a tick remembers; the default is rest.
    type State: Copy + Default;

    /// One tick of the bare recurrence. `input` must be finite and within [`RANGE`].
    fn advance(&self, state: &mut Self::State, input: S) -> S;

    /// The output of the last tick, or of rest.
    fn last(&self, state: &Self::State) -> S;

    /// One tick behind a wall: an input that is NaN, infinite or beyond [`RANGE`] changes nothing and yields the last
    /// good output.
    #[inline]
    fn step(&self, state: &mut Self::State, input: S) -> Held<S> {
        if within_range(input) { Held::Fresh(self.advance(state, input)) } else { Held::Last(self.last(state)) }
    }
}

/// Whether `input` is a number no farther from zero than [`RANGE`].
#[inline]
pub fn within_range<S: Scalar>(input: S) -> bool {
    input >= S::from_f32(-RANGE) && input <= S::from_f32(RANGE)
}

/// Why a block's configuration was refused.
///
/// ```
/// use shakedown_core::blocks::filter::Lag;
///
/// let error = Lag::<f32>::new(-1.0, 1e-3).unwrap_err();
/// assert_eq!((error.field, error.value), ("time", -1.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockError {
    /// Which quantity.
    pub field: &'static str,
    /// What was given.
    pub value: f32,
    /// Smallest value accepted.
    pub low: f32,
    /// Largest value accepted.
    pub high: f32,
}

impl BlockError {
    /// The same error under the name that the quantity has in the settings.
    #[must_use]
    pub(crate) fn named(self, field: &'static str) -> Self {
        Self { field, ..self }
    }
}

/// Whole ticks of `dt` (s) in `time` (s). A quotient short of a whole number by no more than its rounding is that number: 10 ms
/// are 20 ticks of 0.5 ms, although the `f32` nearest to one over the other is below 20.
pub(crate) fn whole_ticks(time: f32, dt: f32) -> u32 {
    (time / dt * (1.0 + 2.0 * f32::EPSILON)) as u32
}

/// `value` if it lies between `low` and `high`, both included; NaN never does.
pub(crate) fn require(field: &'static str, value: f32, low: f32, high: f32) -> Result<f32, BlockError> {
    if value >= low && value <= high { Ok(value) } else { Err(BlockError { field, value, low, high }) }
}

#[cfg(test)]
mod tests {
    use super::whole_ticks;

    /// A time of so many milliseconds at a rate of so many kilohertz, and at the turns of the slower monitors.
    #[test]
    fn a_time_of_whole_ticks_has_that_many() {
        for rate in [200_u32, 500, 1000, 1250, 2000, 2500, 4000, 5000, 8000, 10_000] {
            for count in 1..2000_u32 {
                let dt = 1.0 / rate as f32;
                assert_eq!(whole_ticks(count as f32 / rate as f32, dt), count, "{rate} Hz");
                assert_eq!(whole_ticks((count as f32 + 0.5) / rate as f32, dt), count, "{rate} Hz");
            }
        }
    }
}
