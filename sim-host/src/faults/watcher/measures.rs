//! What the watcher measures of a run over time: how hard the specimen is shaken, how far LVDT and valve go wrong, and whether a trip
//! says what is so.

use crate::faults::case::Case;
use crate::faults::class::{HIDDEN, WINDOW};
use crate::faults::rig::{AFTER, TruthSample};
use shakedown_core::Trip;
use std::collections::VecDeque;

/// How long an acceleration beyond the envelope may last, s: the guard lets it persist for 20 ms, sees it through a lag of 6 ms, and
/// judges it at every third tick.
const SHAKEN: f64 = 0.029;
/// How long what a trip says of the table may lie behind it, s: persistence, and a monitor's turn.
const LATELY: f64 = 0.05;
/// How long an acceleration that was not read goes on to contradict the LVDT, s: the window of `guard.witness`.
const UNREAD: f64 = 0.6;

/// A table stands [`AFTER`] a trip when it is slower than this, m/s.
const STAND: f64 = 0.01;

/// Whether the table stands when [`AFTER`] a trip, and a payload's last blow, is over.
#[derive(Debug, Default)]
pub(super) struct Stands {
    /// When it was tripped, or last knocked on, s.
    since: Option<f64>,
    /// Speed at the end, m/s.
    speed: f64,
}

impl Stands {
    /// One tick after a trip; whether the run goes on.
    pub(super) fn see(&mut self, seen: &TruthSample) -> bool {
        if seen.knocked || self.since.is_none() {
            self.since = Some(seen.time);
        }
        let ends = self.since.is_some_and(|since| seen.time - since > AFTER - 0.01);
        if ends {
            self.speed = seen.v.abs();
        }
        !ends
    }

    /// Whether it moves.
    pub(super) fn moving(&self) -> bool {
        self.speed > STAND
    }
}

/// How hard the specimen is shaken, before the trip and after it: what is left to ring on when it comes is the table's own.
#[derive(Debug, Default)]
pub(super) struct Shaken {
    /// Velocity so long ago as accelerations are averaged, m/s.
    velocities: VecDeque<f64>,
    tripped: bool,
    /// Largest mean over [`SHAKEN`], m/s2.
    pub(super) acceleration: f64,
}

impl Shaken {
    /// One tick of so many a second (1/s).
    pub(super) fn see(&mut self, seen: &TruthSample, rate: f64) {
        if seen.trip.is_some() && !std::mem::replace(&mut self.tripped, true) {
            self.velocities.clear();
        }
        self.velocities.push_back(seen.v);
        if self.velocities.len() as f64 > SHAKEN * rate
            && let Some(before) = self.velocities.pop_front()
        {
            self.acceleration = self.acceleration.max((seen.v - before).abs() / SHAKEN);
        }
    }
}

/// How far something has outrun an even [`HIDDEN`].
#[derive(Debug, Default)]
pub(super) struct Outrun {
    at: f64,
    ways: [f64; 2],
    /// At most, m.
    pub(super) farthest: f64,
}

impl Outrun {
    /// It is `at` (m) after another `dt` (s).
    pub(super) fn see(&mut self, at: f64, dt: f64) {
        if !at.is_finite() {
            return;
        }
        let step = at - self.at;
        self.at = at;
        let [up, down] = self.ways;
        self.ways = [(up + step - HIDDEN * dt).max(0.0), (down - step - HIDDEN * dt).max(0.0)];
        self.farthest = self.ways.iter().fold(self.farthest, |most, way| most.max(*way));
    }
}

/// The way of a table that its command does not explain.
#[derive(Debug, Default)]
pub(super) struct Unexplained {
    of_late: VecDeque<f64>,
    lately: f64,
    all: Outrun,
}

impl Unexplained {
    /// One tick of `dt` (s), of so many a second (1/s).
    pub(super) fn see(&mut self, seen: &TruthSample, dt: f64, rate: f64) {
        self.of_late.push_back(seen.unexplained);
        self.all.see(seen.unexplained, dt);
        if self.of_late.len() as f64 > WINDOW * rate
            && let Some(before) = self.of_late.pop_front()
        {
            self.lately = (seen.unexplained - before).abs();
        } else {
            self.lately = seen.unexplained.abs();
        }
    }

    /// Whether it is more than this within [`WINDOW`], m, or than this in all, m.
    pub(super) fn exceeds(&self, lately: f64, all: f64) -> bool {
        self.lately > lately || self.all.farthest > all
    }
}

/// What a trip may be about.
#[derive(Debug, Default)]
pub(super) struct Lately {
    /// Where the table was of late, and how far from its reference, m.
    ways: VecDeque<[f64; 2]>,
    velocity: f64,
    /// When the table last shook harder than its accelerometer reads, s.
    unread: Option<f64>,
    now: f64,
}

impl Lately {
    /// One tick of `case`.
    pub(super) fn see(&mut self, seen: &TruthSample, case: &Case) {
        self.ways.push_back([seen.x.abs(), (seen.x - seen.reference).abs()]);
        if self.ways.len() as f64 > LATELY * case.rate() {
            self.ways.pop_front();
        }
        if ((seen.v - self.velocity) * case.rate()).abs() > f64::from(case.settings.ranges.acceleration) {
            self.unread = Some(seen.time);
        }
        (self.velocity, self.now) = (seen.v, seen.time);
    }

    /// Whether the table of `case` was what `trip` says of it, for those that need nothing but the truth to tell. Sensors do contradict
    /// each other where the accelerometer is at its rail, and the velocity that is observed then lacks what was not read.
    pub(super) fn bears_out(&self, trip: Trip, case: &Case) -> bool {
        let reached = |what: usize, limit: f64| self.ways.iter().any(|tick| tick[what] > limit);
        match trip {
            Trip::External => case.limit_switches.is_some_and(|at| reached(0, at)),
            Trip::Tracking => case.settings.guard.is_some_and(|guard| reached(1, guard.envelope.tracking.into())),
            Trip::SensorsDisagree | Trip::Velocity => self.unread.is_some_and(|at| self.now - at < UNREAD),
            _ => false,
        }
    }
}
