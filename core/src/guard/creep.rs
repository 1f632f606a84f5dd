//! The valve command as a second witness of where the table is: how far the LVDT may have gone beyond what the command moved it.
//!
//! ```text
//! f[k] = f[k-1] + clamp(x - f[k-1], -2 dt V, +2 dt V)              the LVDT less its spikes, m
//! s[k] = max(0, s[k-1] + (f[k] - f[k-1]) - dt g w - dt n)          way beyond the command and an unknown null, m
//! h[k] = h[k-1] + 2 dt n while s > 0, else 0                       most that such a null has hidden meanwhile, m
//! ```
//! and the same for the other direction with x and w turned. w is the velocity that the model makes of the command (m/s), g the
//! table's gain as learned since arming, V the velocity limit that is set, n the largest even speed that an error of the null bias
//! makes. An LVDT that has crept by d since s left zero shows s <= d <= s + h: what nulls within n can hide is in h, so the
//! table is nowhere beyond x - s - h. From `s > mismatch` on, half of it once g is known, it trips where the envelope, with
//! its stopping distance, would not let the table be there. Up to that, and up to an even 2 n, a creep is not distinguished from
//! the errors of model and null.
//!
//! Beyond 2 `mismatch` it trips wherever the table may be, if s says so under the limit in force as well as under the one that is set:
//! a table that does less than it is told looks saturated, and one whose limit was estimated lower than it is moves beyond it. An LVDT
//! that creeps against its motion looks saturated too, so for where the table may be only the one that is set counts.

use crate::math::min;
use crate::scalar::Scalar;

/// An unknown null's even speed as a share of `mismatch` / `memory`, 1.
const NULL: f32 = 0.04;

/// What the command says of an LVDT that creeps.
///
/// ```
/// use shakedown_core::blocks::guard::{Creep, ValveMonitor, ValveMonitorState};
/// use shakedown_core::settings::ValveMonitorSettings;
///
/// let monitor = ValveMonitor::new(&ValveMonitorSettings::default(), 0.017, 0.242, 1e-3)?;
/// assert_eq!(monitor.creep(&ValveMonitorState::default()), Creep::None);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Creep {
    /// It does not.
    None,
    /// It may have, this far, m: the table would be so far below its reading.
    Possible(f32),
    /// It has.
    Certain,
}

/// The witness's configuration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CreepWitness {
    dt: f32,
    /// Farthest that the LVDT is followed in a turn, m.
    step: f32,
    /// Way of an unknown null in a turn, m.
    null: f32,
    mismatch: f32,
}

/// What it remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct CreepState {
    /// The LVDT less its spikes, m.
    followed: Option<f32>,
    /// By the limit in force, and by the one that is set.
    in_force: Both,
    possible: Both,
}

/// Beyond the command in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Both {
    up: Beyond,
    down: Beyond,
}

/// Way beyond the command, m, and what an unknown null may have hidden of it, m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Beyond {
    way: f32,
    hidden: f32,
}

impl Both {
    #[inline]
    fn advance(&mut self, unexplained: f32, null: f32) {
        self.up.advance(unexplained, null);
        self.down.advance(-unexplained, null);
    }
}

impl Beyond {
    #[inline]
    fn advance(&mut self, unexplained: f32, null: f32) {
        self.way += unexplained - null;
        if self.way > 0.0 {
            self.hidden += 2.0 * null;
        } else {
            *self = Self::default();
        }
    }
}

impl CreepWitness {
    /// A witness that allows for `mismatch` (m) of the model, forgotten over `memory` (s), of a table of `velocity_limit` (m/s), at
    /// turns of `dt` (s).
    pub(super) fn new(mismatch: f32, memory: f32, velocity_limit: f32, dt: f32) -> Self {
        Self { dt, step: 2.0 * velocity_limit * dt, null: NULL * mismatch / memory * dt, mismatch }
    }

    /// One turn: displacement (m) and the velocity expected under the limit in force and under the one that is set, m/s.
    #[inline(always)]
    pub(super) fn advance(&self, state: &mut CreepState, displacement: f32, in_force: f32, most: f32) {
        let followed = state.followed.unwrap_or(displacement);
        let step = (displacement - followed).bounded(self.step);
        state.followed = Some(followed + step);
        state.in_force.advance(step - self.dt * in_force, self.null);
        state.possible.advance(step - self.dt * most, self.null);
    }

    /// Between two of these: how far the LVDT has crept, by a table whose gain is `known` or not.
    #[inline(always)]
    pub(super) fn found(&self, state: &CreepState, known: bool) -> Creep {
        let Both { up, down } = state.possible;
        let least = if known { 0.5 * self.mismatch } else { self.mismatch };
        let certain = |in_force: Beyond, set: Beyond| min(in_force.way, set.way) > 2.0 * self.mismatch;
        if certain(state.in_force.up, up) || certain(state.in_force.down, down) {
            Creep::Certain
        } else if up.way > least && up.way > down.way {
            Creep::Possible(up.way + up.hidden)
        } else if down.way > least {
            Creep::Possible(-(down.way + down.hidden))
        } else {
            Creep::None
        }
    }
}
