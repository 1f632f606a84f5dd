//! What the lags, plays and relays of an expression remember from one integration step to the next.

use super::expression::Operation;
use crate::scalar::Scalar;

/// What the lags and plays of a program hold.
#[derive(Debug, Clone)]
pub(super) struct Memory<S> {
    held: Vec<S>,
    begun: bool,
}

impl<S: Scalar> Memory<S> {
    /// So many that have seen nothing yet: everything is at rest where it is.
    pub(super) fn new(count: usize) -> Self {
        Self { held: vec![S::from(0.0); count], begun: false }
    }

    /// All at zero, as if the past had been there.
    pub(super) fn at_zero(count: usize) -> Self {
        Self { begun: true, ..Self::new(count) }
    }

    /// The same, to be told what it holds from now on.
    pub(super) fn settled(&self) -> Self {
        Self { held: self.held.clone(), begun: true }
    }

    /// Holds a value at a place.
    pub(super) fn hold(&mut self, slot: usize, value: S) {
        if let Some(held) = self.held.get_mut(slot) {
            *held = value;
        }
    }

    /// What follows `input` now, `elapsed` seconds after the memory was settled.
    pub(super) fn follow(&self, (how, slot): (Operation, usize), input: S, by: S, elapsed: f64) -> S {
        let side = |held: S| {
            let (input, by) = (input.value(), by.value());
            if input > by {
                S::from(1.0)
            } else if input < -by {
                S::from(-1.0)
            } else {
                held
            }
        };
        let Some(held) = self.held.get(slot).copied().filter(|_| self.begun) else {
            return if how == Operation::Relay { side(S::from(0.0)) } else { input };
        };
        match how {
            Operation::Relay => side(held),
            Operation::Lag if elapsed <= 0.0 => held,
            Operation::Lag => input + (held - input) * (-(S::from(elapsed) / by.max(S::from(SHORTEST)))).exp(),
            _ => held.max(input - by).min(input + by),
        }
    }
}

/// Shortest lag, s: a shorter one is none.
const SHORTEST: f64 = 1e-6;
