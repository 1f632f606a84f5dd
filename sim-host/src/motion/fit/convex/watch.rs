//! Which samples are held to the limits of speed and stroke inside the program.
//!
//! A limit that does not bind costs as much as one that does, and most never bind: a record is fast for a few seconds of its
//! minute, and displacement says little new from one sample to the next. So the program starts with the samples that may
//! bind; what its solution breaks elsewhere is added, and it is solved again until nothing is broken. A program with fewer
//! rows has an optimum at most as high, so its bound, and its proof that no motion exists, hold for the whole.

use super::super::{Limits, Reference, taut};

/// Samples held to the limits.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Watch {
    /// Whether the speed is held at each sample.
    pub(super) speed: Vec<bool>,
    /// Whether displacement is a variable, held to the stroke, at each sample. First and last always are.
    pub(super) knot: Vec<bool>,
}

/// Share of the speed limit from which a sample may come to bind.
const NEAR: f64 = 0.4;
/// Displacement is looked at this often to begin with, s: moving at 10 m/s2 it strays 0.1 mm from a chord of that length.
const SPACING: f64 = 0.02;
/// Share of a limit by which it may be passed, that of the solver's accuracy.
const SLACK: f64 = 1e-6;
/// Rounds after which every sample is watched.
pub(super) const ROUNDS: usize = 4;

impl Watch {
    /// Samples that are fast in the reference or under the speed limit alone, and displacement every [`SPACING`].
    pub(super) fn first(reference: &Reference, limits: &Limits) -> Self {
        let near = NEAR * limits.velocity;
        let mut speed: Vec<bool> = reference.velocity.iter().map(|v| v.abs() > near).collect();
        if let Ok(string) = taut::fit(reference, limits) {
            speed.iter_mut().zip(&string.velocity).for_each(|(watched, v)| *watched |= v.abs() > near);
        }
        let stride = ((SPACING / reference.dt) as usize).max(1);
        let last = reference.len() - 1;
        let knot = (0..=last).map(|k| k.is_multiple_of(stride) || k == last).collect();
        Self { speed, knot }
    }

    /// Every sample.
    pub(super) fn all(reference: &Reference) -> Self {
        Self { speed: vec![true; reference.len()], knot: vec![true; reference.len()] }
    }

    /// Adds the samples at which `velocity` (m/s) breaks a limit unwatched; whether there were any.
    pub(super) fn add(&mut self, reference: &Reference, limits: &Limits, velocity: &[f64]) -> bool {
        let stroke = limits.stroke.unwrap_or(f64::INFINITY);
        let displacement = reference.displacement(velocity);
        let fast = add(&mut self.speed, velocity, limits.velocity);
        add(&mut self.knot, &displacement, stroke) || fast
    }
}

/// Watches where `signal` passes `limit`; whether anything was not watched there.
fn add(watched: &mut [bool], signal: &[f64], limit: f64) -> bool {
    let mut added = false;
    for (watched, value) in watched.iter_mut().zip(signal) {
        if value.abs() > limit * (1.0 + SLACK) && !*watched {
            (*watched, added) = (true, true);
        }
    }
    added
}
