//! The two walls: speed, and a stroke inside which the table can always stop.

use super::ReferenceLimits;
use crate::math::{max, min, sqrt};

/// [`ReferenceLimits`] in metres a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TickLimits {
    /// One tick, s.
    pub(super) tick: f32,
    /// Largest step, m.
    pub(super) step: f32,
    /// Largest displacement from centre, m.
    pub(super) stroke: f32,
    /// Largest change of the step while braking, m.
    pub(super) brake: f32,
    /// Largest step of a reference that is still a motion, m.
    pub(super) leap: f32,
}

impl TickLimits {
    /// Validated limits, by the tick.
    pub(super) fn new(limits: &ReferenceLimits) -> Self {
        let tick = 1.0 / limits.rate;
        Self {
            tick,
            step: limits.velocity * tick,
            stroke: limits.stroke,
            brake: limits.braking * tick * tick,
            leap: limits.leap * tick,
        }
    }

    /// The largest step under the limit in force, m: the configured one where `velocity_limit_now` (m/s) is not a number.
    pub(super) fn step_now(&self, velocity_limit_now: f32) -> f32 {
        let now = velocity_limit_now * self.tick;
        if now < self.step { max(now, 0.0) } else { self.step }
    }

    /// Largest step toward a wall `room` metres away that can still be braked to nothing before it.
    ///
    /// Braking from a step u covers at most u^2 / 2h, h being `brake`; so u + u^2 / 2h = `room`, solved without
    /// cancellation. A state that satisfies it still does after one tick of braking, so the walls never meet.
    fn approach(&self, room: f32) -> f32 {
        if room > 0.0 {
            let twice = 2.0 * self.brake * room;
            twice / (self.brake + sqrt(self.brake * self.brake + twice))
        } else {
            0.0
        }
    }

    /// `want`, m, kept to `step` and to a step from `displacement` that leaves room to stop.
    pub(super) fn keep(&self, want: f32, step: f32, displacement: f32) -> f32 {
        let back = want < 0.0;
        let size = min(want.abs(), step);
        let room = if back { self.stroke + displacement } else { self.stroke - displacement };
        // Far from the wall, where a record nearly always is, the inequality is cheaper than its solution.
        let twice = 2.0 * self.brake;
        let kept = if size * (twice + size) <= twice * room { size } else { min(size, self.approach(room)) };
        if back { -kept } else { kept }
    }
}

/// The displacement sent out: a sum whose rounding is carried along, so that what is too small for one tick is not lost.
#[derive(Debug, Clone, Copy)]
pub(super) struct Integrator {
    /// Displacement, m.
    pub(super) displacement: f32,
    /// What the displacement's last place could not hold, m.
    carry: f32,
    /// Displacement asked for in the last tick, m.
    pub(super) step: f32,
}

impl Integrator {
    /// At rest.
    pub(super) fn at(displacement: f32) -> Self {
        Self { displacement, carry: 0.0, step: 0.0 }
    }

    /// How far it lies behind `reference`, m.
    pub(super) fn behind(&self, reference: f32) -> f32 {
        (reference - self.displacement) - self.carry
    }

    /// How far it lies beyond `other`, m.
    pub(super) fn beyond(&self, other: &Self) -> f32 {
        (self.displacement - other.displacement) + (self.carry - other.carry)
    }

    /// Moves by `step`, m, to within one unit in the last place of the displacement.
    pub(super) fn advance(&mut self, step: f32) -> f32 {
        let sum = step + self.carry;
        let next = self.displacement + sum;
        let moved = next - self.displacement;
        self.carry = (self.displacement - (next - moved)) + (sum - moved);
        self.displacement = next;
        self.step = step;
        next
    }
}
