//! Laws from closures: a map without state, one with smooth states, one with memories.

use super::law::{Law, Now};
use std::fmt::{Debug, Formatter, Result};

/// A law without state.
pub struct Map<F: Fn(&Now, f64) -> f64>(pub F);

/// A law with smooth states: their rates, and the signal behind it.
pub struct States<R, O>
where
    R: Fn(&Now, f64, &[f64], &mut [f64]),
    O: Fn(&Now, f64, &[f64]) -> f64,
{
    /// Number of states.
    pub count: usize,
    /// Fastest rate (rad/s).
    pub fastest: f64,
    /// Rates from instant, input, states into the last argument.
    pub rates: R,
    /// Output from instant, input, states.
    pub out: O,
}

/// A law with memories that are updated once a step.
pub struct Memories<R, O>
where
    R: Fn(&Now, f64, f64, &mut [f64]),
    O: Fn(&Now, f64, &[f64]) -> f64,
{
    /// Number of memories.
    pub count: usize,
    /// Fastest rate (rad/s).
    pub fastest: f64,
    /// Updates the memories from instant, input and step (s).
    pub remember: R,
    /// Output from instant, input, memories.
    pub out: O,
}

impl<F: Fn(&Now, f64) -> f64> Debug for Map<F> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str("Map")
    }
}

impl<R: Fn(&Now, f64, &[f64], &mut [f64]), O: Fn(&Now, f64, &[f64]) -> f64> Debug for States<R, O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str("States")
    }
}

impl<R: Fn(&Now, f64, f64, &mut [f64]), O: Fn(&Now, f64, &[f64]) -> f64> Debug for Memories<R, O> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        f.write_str("Memories")
    }
}

impl<F: Fn(&Now, f64) -> f64 + Send + Sync> Law for Map<F> {
    fn out(&self, now: &Now, input: f64, _: &[f64], _: &[f64]) -> f64 {
        (self.0)(now, input)
    }
}

impl<R, O> Law for States<R, O>
where
    R: Fn(&Now, f64, &[f64], &mut [f64]) + Send + Sync,
    O: Fn(&Now, f64, &[f64]) -> f64 + Send + Sync,
{
    fn states(&self) -> usize {
        self.count
    }

    fn rates(&self, now: &Now, input: f64, y: &[f64], _: &[f64], dy: &mut [f64]) {
        (self.rates)(now, input, y, dy);
    }

    fn out(&self, now: &Now, input: f64, y: &[f64], _: &[f64]) -> f64 {
        (self.out)(now, input, y)
    }

    fn fastest(&self) -> f64 {
        self.fastest
    }
}

impl<R, O> Law for Memories<R, O>
where
    R: Fn(&Now, f64, f64, &mut [f64]) + Send + Sync,
    O: Fn(&Now, f64, &[f64]) -> f64 + Send + Sync,
{
    fn memories(&self) -> usize {
        self.count
    }

    fn remember(&self, now: &Now, input: f64, h: f64, m: &mut [f64]) {
        (self.remember)(now, input, h, m);
    }

    fn out(&self, now: &Now, input: f64, _: &[f64], m: &[f64]) -> f64 {
        (self.out)(now, input, m)
    }
    fn fastest(&self) -> f64 {
        self.fastest
    }
}
