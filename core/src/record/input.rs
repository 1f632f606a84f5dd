//! The reference as it arrives, made safe to differentiate.

use crate::scalar::Scalar;

/// The last reference accepted and its last step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Input {
    /// Displacement, m.
    pub(super) displacement: f32,
    /// Displacement moved in the last tick, m.
    pub(super) step: f32,
    /// The last reference was not a number, or leapt.
    pub(super) held: bool,
}

impl Input {
    /// At rest.
    pub(super) fn at(displacement: f32) -> Self {
        let displacement = if displacement.is_finite() { displacement } else { 0.0 };
        Self { displacement, step: 0.0, held: false }
    }

    /// Goes on at `reference` (m) after ticks that were not heard: the way gone meanwhile is an offset to wash out, as a leap
    /// is, and no motion of one tick. The next [`Input::accept`] of it finds the step of before.
    pub(super) fn resume(&mut self, reference: f32) {
        if reference.is_finite() {
            self.displacement = reference - self.step;
        }
    }

    /// Takes the next reference, m. One that is not a number coasts to rest, `brake` (m per tick squared) at a time, so
    /// that a sample lost costs neither a jerk now nor one when the next arrives. One that leaps more than `leap` (m)
    /// moves the displacement and leaves the velocity to coast.
    pub(super) fn accept(&mut self, reference: f32, leap: f32, brake: f32) {
        let step = reference - self.displacement;
        // True of no step but one to a finite reference.
        let near = step.abs() <= leap;
        self.held = !near;
        if !self.held {
            self.step = step;
            self.displacement = reference;
            return;
        }
        // Not `clamp`, which panics on limits that are no numbers.
        self.step -= self.step.within(-brake, brake);
        self.displacement = if reference.is_finite() { reference } else { self.displacement + self.step };
    }
}
