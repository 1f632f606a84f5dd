//! The valve command as a second witness of where the table is: how far the LVDT may have gone beyond what the command moved it.
//!
//! ```text
//! f[k] = f[k-1] + clamp(x - f[k-1], -2 dt V, +2 dt V)              the LVDT less its spikes, m
//! s[k] = max(0, s[k-1] + (f[k] - f[k-1]) - dt clamp(g w, -V, +V) - dt n)          way beyond the command and an unknown null, m
//! h[k] = h[k-1] + 2 dt n while s > 0, else 0                       most that such a null has hidden meanwhile, m
//! m[k] = m[k-1] + dt w,   e[k] = e[k-1] + dt g w                   the same for s > 0, where g was not known when that began, else 0, m
//! b[k] = b[k-1] + dt w                                             of m, while there is no g at all and 1 stands for it, m
//! d1 = s + e - max(g1 m, g2 m),   d2 = s + h + e - min(g1 m, g2 m) least and farthest that it has crept, m
//! d3 = s + b - max(g1 b, g2 b)                                     least if g is right as far as there is one, m
//! ```
//! and the same for the other direction with x and w turned. w is the velocity that the model makes of the command (m/s), g the
//! table's gain as learned since arming, V the velocity limit that is set, n the largest even speed that an error of the null bias
//! makes, g1 and g2 the least and the largest gain of a table that the model is still good for. An LVDT that creeps while g is learned
//! spoils g: a loop that carries the table along under a reading that stands makes it look a slow table, which explains the creep.
//! So it may have crept where `d3 > mismatch / 2`, and where `d1 > mismatch`, which no gain explains; and by what s has counted, the
//! table is nowhere beyond x - d2. It trips where the envelope, with its stopping distance, would not let the table be there. Both
//! directions are judged: an LVDT that creeps up and part of the way back is still too high if it was right at first, and too low if
//! it was right where it turned.
//! Up to that, and up to an even 2 n, a creep is not distinguished from the errors of model and null.
//!
//! Where `d3 > 2 mismatch` it trips wherever the table may be, if s says so under the limit in force as well: a table that does less
//! than it is told looks saturated, and one whose limit was estimated lower than it is moves beyond it. An LVDT that creeps against its
//! motion looks saturated too, so for where the table may be only the one that is set counts.

use super::gain::{BELIEVED, Gain};
use crate::math::{max, min};
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
    /// It may have: the table is at most `below` under its reading and at most `above` over it, m. One that creeps up and part of the
    /// way back may be either, for nobody knows where it was right; 0 where it is not.
    Possible {
        /// How far the table may be under its reading, m.
        below: f32,
        /// How far it may be over it, m.
        above: f32,
    },
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
    /// Way beyond the command in either direction by the limit in force, m.
    in_force: [f32; 2],
    /// The same by the one that is set, with what it may be wrong by.
    up: Beyond,
    down: Beyond,
}

/// Way beyond the command, and what of a creep the model may have explained away meanwhile; all m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Beyond {
    way: f32,
    /// By an unknown null.
    hidden: f32,
    /// What the command asked for where the gain was not known when this began: at a gain of 1, by the gain as learned, and while there was
    /// none.
    asked: f32,
    learned: f32,
    blind: f32,
}

/// What the model makes of a command: way at a gain of 1, and at the one learned so far, m; and how well that is known.
#[derive(Debug, Clone, Copy)]
struct Move {
    asked: f32,
    learned: f32,
    gain: Gain,
}

impl Beyond {
    /// One turn: `step` of the LVDT and way of an unknown `null` (m), and what the command moved the table.
    #[inline]
    fn advance(&mut self, null: f32, step: f32, Move { asked, learned, gain }: Move) {
        self.way += step - learned - null;
        if self.way > 0.0 {
            self.hidden += 2.0 * null;
            // A gain that becomes known under a creep was learned of it.
            if !matches!(gain, Gain::Known(_)) || self.asked != 0.0 {
                self.asked += asked;
                self.learned += learned;
            }
            if gain == Gain::Unknown {
                self.blind += asked;
            }
        } else {
            *self = Self::default();
        }
    }

    /// How far the LVDT has crept at least if the gain is right as far as there is one, m.
    #[inline]
    fn as_learned(&self) -> f32 {
        self.way + self.blind - max(BELIEVED.0 * self.blind, BELIEVED.1 * self.blind)
    }

    /// How far the LVDT may have crept, m, if it has at all: if the gain as learned leaves more than half of the `mismatch` (m)
    /// unexplained, or whatever gain the model is still good for leaves all of it.
    #[inline]
    fn farthest(&self, mismatch: f32) -> Option<f32> {
        let (low, high) = (BELIEVED.0 * self.asked, BELIEVED.1 * self.asked);
        let way = self.way + self.learned;
        let whatever = way - max(low, high);
        (whatever > mismatch || self.as_learned() > 0.5 * mismatch).then_some(self.hidden + way - min(low, high))
    }
}

impl CreepWitness {
    /// A witness that allows for `mismatch` (m) of the model, forgotten over `memory` (s), of a table of `velocity_limit` (m/s), at
    /// turns of `dt` (s).
    pub(super) fn new(mismatch: f32, memory: f32, velocity_limit: f32, dt: f32) -> Self {
        Self { dt, step: 2.0 * velocity_limit * dt, null: NULL * mismatch / memory * dt, mismatch }
    }

    /// One turn: displacement (m), the velocity that the command asks for under the limit in force and under the one that is set
    /// (m/s), and the table's gain as learned.
    #[inline(always)]
    pub(super) fn advance(&self, state: &mut CreepState, displacement: f32, [in_force, most]: [f32; 2], gain: Gain) {
        let followed = state.followed.unwrap_or(displacement);
        let step = (displacement - followed).bounded(self.step);
        state.followed = Some(followed + step);
        // No gain makes a table faster than it is.
        let moved = |velocity: f32| (self.dt * gain.value() * velocity).bounded(0.5 * self.step);
        let unexplained = step - moved(in_force);
        let [up, down] = state.in_force;
        state.in_force = [max(0.0, up + unexplained - self.null), max(0.0, down - unexplained - self.null)];
        let (asked, learned) = (self.dt * most, moved(most));
        state.up.advance(self.null, step, Move { asked, learned, gain });
        state.down.advance(self.null, -step, Move { asked: -asked, learned: -learned, gain });
    }

    /// Between two of these: how far the LVDT has crept.
    #[inline(always)]
    pub(super) fn found(&self, state: &CreepState) -> Creep {
        let (up, down) = (&state.up, &state.down);
        let certain = |in_force: f32, set: f32| min(in_force, set) > 2.0 * self.mismatch;
        let [up_in_force, down_in_force] = state.in_force;
        if certain(up_in_force, up.as_learned()) || certain(down_in_force, down.as_learned()) {
            Creep::Certain
        } else {
            match (up.farthest(self.mismatch), down.farthest(self.mismatch)) {
                (None, None) => Creep::None,
                (below, above) => Creep::Possible { below: below.unwrap_or(0.0), above: above.unwrap_or(0.0) },
            }
        }
    }
}
