//! What the monitors are told, and what they say.

use super::TURNS;
use crate::guard::Trip;
use crate::sample::Relay;

/// What a monitor has to say after its turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Word {
    /// Nothing, which is nearly always.
    Nothing,
    /// Something is unusual, and why the guard should trip, if it should.
    Unusual(Option<Trip>),
}

/// Why the guard would trip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cause {
    /// As of the last tick.
    pub(super) now: Option<Trip>,
    /// As of the last turn of the monitor that found it, and how many ticks ago that was.
    found: Option<Trip>,
    since: u8,
}

impl Cause {
    /// This one, until there is something else to say.
    pub(super) fn of(trip: Trip) -> Self {
        Self { now: Some(trip), found: None, since: 0 }
    }

    /// Takes in how the envelope was `left` in this tick and the `doubt` of the monitor whose turn it was; gives the cause.
    pub(super) fn hear(&mut self, left: Option<Trip>, doubt: Option<Trip>) -> Option<Trip> {
        self.since = if doubt.is_some() { 0 } else { self.since.saturating_add(1) };
        if doubt.is_some() || self.since >= TURNS {
            self.found = doubt;
        }
        self.now = left.or(doubt);
        self.now
    }

    /// What stands: a monitor has its turn at every third tick, and what it found stands until its next.
    pub(super) fn standing(self) -> Option<Trip> {
        self.now.or(self.found)
    }
}

/// What pushes the table, as the monitors see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Drive {
    /// Reference after modification, m.
    pub(crate) reference: f32,
    /// Command beyond zero flow, m.
    pub(crate) excess: f32,
    /// Whether a law moves the table, rather than the safe ramp or nothing.
    pub(crate) moves: bool,
    /// What the relay is told to be.
    pub(crate) relay: Relay,
}
