//! What the monitors are told, and how long what they found is remembered.

use super::TURNS;
use crate::guard::Trip;
use crate::sample::Relay;

/// Why the guard would trip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TripLatch {
    /// As of the last tick.
    pub(super) now: Option<Trip>,
    /// As of the last turn of the monitor that found it, and how many ticks ago that was.
    pub(super) found: Option<Trip>,
    since: u8,
}

impl TripLatch {
    /// Holds `trip` until there is something else to say.
    pub(super) fn of(trip: Trip) -> Self {
        Self { now: Some(trip), found: None, since: 0 }
    }

    /// Takes what was found `at_once` in this tick and by the monitor whose `turn` it was; gives the cause to trip.
    pub(super) fn update(&mut self, at_once: Option<Trip>, turn: Option<Trip>) -> Option<Trip> {
        self.since = if turn.is_some() { 0 } else { self.since.saturating_add(1) };
        if turn.is_some() || self.since >= TURNS {
            self.found = turn;
        }
        self.now = at_once.or(turn);
        self.now
    }

    /// The cause that refuses arming: a monitor has its turn at every third tick, and what it found holds until its next.
    pub(super) fn cause(self) -> Option<Trip> {
        self.now.or(self.found)
    }
}

/// What drives the table, as the monitors see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MonitorInput {
    /// Reference after modification, m.
    pub(crate) reference: f32,
    /// Flow command: command less zero flow, m.
    pub(crate) flow_command: f32,
    /// Whether a law moves the table, rather than the safe ramp or nothing.
    pub(crate) moves: bool,
    /// What the relay is told to be.
    pub(crate) relay: Relay,
}
