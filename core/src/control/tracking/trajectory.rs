//! The reference and its rates, seen from a little behind: seven points of it, as far to the future as to the past.
//!
//! ```text
//! d_i = r[j+ih] - r[j-ih],   s_i = r[j+ih] + r[j-ih] - 2 r[j],   i = 1, 2, 3
//! v = (45 d1 - 9 d2 + d3) / (60 h)          a = (270 s1 - 27 s2 + 2 s3) / (180 h^2)         j = (-13 d1 + 8 d2 - d3) / (8 h^3)
//! ```
//! h in s. Exact for polynomials of the sixth degree (jerk: of the sixth, its error growing with h^4): with h = 2 ms velocity
//! and acceleration are right within 0.1 % up to 50 Hz and jerk up to 20 Hz, without lag. The price is that the table moves
//! `3 h` behind what is sent. Signs as the reference's; m, m/s, m/s2, m/s3.

use crate::block::{BlockError, require};

/// Ticks of the reference that are kept.
pub(crate) const ROOM: usize = 64;
const MASK: u32 = ROOM as u32 - 1;

/// Displacement and rates at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReferenceState {
    /// m.
    pub displacement: f32,
    /// m/s.
    pub velocity: f32,
    /// m/s2.
    pub acceleration: f32,
    /// m/s3.
    pub jerk: f32,
}

/// The last 64 ticks of the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct History {
    ring: [f32; ROOM],
    newest: u32,
}

impl Default for History {
    fn default() -> Self {
        Self::at(0.0)
    }
}

impl History {
    /// A reference that has stood at `displacement` (m) for ever.
    pub fn at(displacement: f32) -> Self {
        Self { ring: [displacement; ROOM], newest: 0 }
    }

    /// Takes the next tick's reference, m.
    #[inline]
    pub fn push(&mut self, reference: f32) {
        self.newest = self.newest.wrapping_add(1);
        self.ring[(self.newest & MASK) as usize] = reference;
    }

    #[inline]
    fn back(&self, ticks: u32) -> f32 {
        self.ring[(self.newest.wrapping_sub(ticks) & MASK) as usize]
    }
}

/// The seven points' configuration.
///
/// ```
/// use shakedown_core::blocks::tracking::{History, Stencil};
///
/// let stencil = Stencil::new(0.002, 1e-3)?;
/// let mut history = History::at(0.0);
/// for k in 0..64 {
///     history.push(0.1 * k as f32 * 1e-3); // 0.1 m/s
/// }
/// assert!((stencil.at(&history, stencil.reach()).velocity - 0.1).abs() < 1e-4);
/// # Ok::<(), shakedown_core::blocks::BlockError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stencil {
    spacing: u32,
    first: f32,
    second: f32,
    third: f32,
}

impl Stencil {
    /// Points `spacing` apart (s, one tick to eight) at ticks of `dt` (s).
    pub fn new(spacing: f32, dt: f32) -> Result<Self, BlockError> {
        let ticks = (require("tracking.spacing", spacing, 0.9 * dt, 8.5 * dt)? / dt + 0.5) as u32;
        let per = 1.0 / (ticks as f32 * dt);
        Ok(Self { spacing: ticks, first: per / 60.0, second: per * per / 180.0, third: per * per * per / 8.0 })
    }

    /// Ticks that it looks to either side.
    pub fn reach(&self) -> u32 {
        3 * self.spacing
    }

    /// The motion `back` ticks ago; from [`Stencil::reach`] to 64 less as much.
    #[inline]
    pub fn at(&self, history: &History, back: u32) -> ReferenceState {
        let h = self.spacing;
        let here = history.back(back);
        let pair = |i: u32| {
            let (after, before) = (history.back(back.wrapping_sub(i * h)), history.back(back + i * h));
            (after - before, (after - here) + (before - here))
        };
        let ((d1, s1), (d2, s2), (d3, s3)) = (pair(1), pair(2), pair(3));
        ReferenceState {
            displacement: here,
            velocity: self.first * (45.0 * d1 - 9.0 * d2 + d3),
            acceleration: self.second * (270.0 * s1 - 27.0 * s2 + 2.0 * s3),
            jerk: self.third * (8.0 * d2 - 13.0 * d1 - d3),
        }
    }
}
