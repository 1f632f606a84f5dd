//! The independent judge of a run: it knows the truth, the fault and what the class promises, and nothing of how the guard
//! works.

use super::case::Case;
use super::class::{Clock, Fault, Promise, ROOM};
use super::machine::Break;
use super::rig::{self, AFTER, Pair, RigError, Seen};
use serde::{Deserialize, Serialize};
use shakedown_core::{Relay, State};
use std::collections::VecDeque;

/// Half the table's travel, m.
pub const STROKE: f64 = 0.12;
/// Room that the envelope keeps free at each end, m; a table beyond it has made an excursion.
pub const MARGIN: f64 = 0.005;
/// Largest acceleration within the envelope, m/s2.
const ROUGH: f64 = 30.0;
/// How long it may last, s: the guard lets it persist for 20 ms, sees it through a lag of 6 ms, and judges it at every third tick.
pub const SHAKEN: f64 = 0.029;
/// Ticks by which a rate below 1 kHz may make a report later: three until a monitor's next turn, and one.
const TURNS: f64 = 4.0;
/// A table stands a while after a trip when it is slower than this, m/s.
const STAND: f64 = 0.01;

/// What became of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Its number.
    pub run: u64,
    /// Class of its fault.
    pub class: String,
    /// Where the device sat, or which law ran.
    pub mode: String,
    /// When the fault began, s.
    pub onset_s: f64,
    /// Why it tripped, or `faded` where it was faded out.
    pub reported: Option<String>,
    /// From the clock's start to the report, or where the class promises the relay to its opening, s.
    pub latency_s: Option<f64>,
    /// Whether the clock of the class started: whether there was anything to see.
    pub visible: bool,
    /// Farthest from the middle from the fault on, m.
    pub farthest_m: f64,
    /// Farthest from where it would have been without the fault until it was reported, m.
    pub deviation_m: f64,
    /// Whether the table left its stroke less the margin, or its stroke where the valve does not obey, promised or not.
    pub outside: bool,
    /// Largest acceleration of the table and its specimen, mean over [`SHAKEN`], m/s2.
    pub acceleration_m_s2: f64,
    /// What was not kept.
    pub broken: Vec<Broken>,
}

/// What a run may not keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Broken {
    /// The table left its stroke less the margin.
    Excursion,
    /// What had to be reported was not.
    Unreported,
    /// It was reported, or the relay opened, later than promised.
    Late,
    /// It still moved long after the trip.
    Moving,
    /// The specimen was accelerated beyond the envelope.
    Rough,
    /// A trip with no fault.
    Alarm,
}

struct Watcher<'a> {
    case: &'a Case,
    /// The run without the fault as well.
    pair: &'a Pair,
    rate: f64,
    /// Velocity so long ago as accelerations are averaged, m/s.
    velocities: VecDeque<f64>,
    acceleration: f64,
    began: Option<f64>,
    started: Option<f64>,
    reported: Option<(f64, String)>,
    relay: Option<f64>,
    farthest: f64,
    deviation: f64,
    mean_error: f64,
    alarm: bool,
    moving: bool,
    now: f64,
}

/// What the device says of the fault, if anything: a trip, or a test that is not where it would be.
fn report(seen: &Seen, expected: State) -> Option<String> {
    let faded =
        matches!(seen.state, State::RampDown | State::Ready | State::Hold | State::Off) && seen.state != expected;
    seen.trip.map(|trip| format!("{trip:?}")).or_else(|| faded.then(|| "faded".into()))
}

/// Runs and judges `case`.
pub fn judge(case: &Case) -> Result<Outcome, RigError> {
    Ok(judge_pair(case, &rig::run(case)?))
}

/// Judges a run of `case`.
pub fn judge_pair(case: &Case, pair: &Pair) -> Outcome {
    let mut watcher = Watcher::new(case, pair);
    for seen in &pair.seen {
        if !watcher.see(seen) {
            break;
        }
    }
    watcher.outcome()
}

impl<'a> Watcher<'a> {
    fn new(case: &'a Case, pair: &'a Pair) -> Self {
        Self {
            case,
            pair,
            rate: case.rate(),
            velocities: VecDeque::new(),
            acceleration: 0.0,
            began: None,
            started: None,
            reported: None,
            relay: None,
            farthest: 0.0,
            deviation: 0.0,
            mean_error: 0.0,
            alarm: false,
            moving: false,
            now: 0.0,
        }
    }

    /// Whether the run goes on.
    fn see(&mut self, seen: &Seen) -> bool {
        let before = self.now;
        self.now = seen.time;
        if seen.tick < self.case.onset {
            self.alarm = seen.trip.is_some();
            self.reported = seen.trip.map(|trip| (seen.time, format!("{trip:?}")));
            return !self.alarm;
        }
        let expected = self.pair.expected.get(seen.tick).copied().unwrap_or(seen.state);
        self.began.get_or_insert(before);
        self.farthest = self.farthest.max(seen.x.abs());
        self.shaken(seen);
        let off = (seen.x - self.pair.without.get(seen.tick).copied().unwrap_or(seen.x)).abs();
        // A table without oil is hurt by nothing, and nothing is reported of it before somebody wants to arm it.
        if expected != State::Off {
            self.clock(seen, before, off);
        }
        if self.reported.is_none() {
            self.reported = report(seen, expected).map(|why| (seen.time, why));
        }
        if self.reported.is_none() {
            self.deviation = self.deviation.max(off);
        }
        if seen.relay == Relay::Open {
            self.relay.get_or_insert(seen.time);
        }
        match (&self.reported, seen.trip) {
            (Some((at, _)), Some(_)) if seen.time - at > AFTER - 0.01 => {
                self.moving = seen.v.abs() > STAND;
                false
            }
            _ => true,
        }
    }

    /// How hard the specimen is shaken.
    fn shaken(&mut self, seen: &Seen) {
        self.velocities.push_back(seen.v);
        if self.velocities.len() as f64 > SHAKEN * self.rate
            && let Some(before) = self.velocities.pop_front()
        {
            self.acceleration = self.acceleration.max((seen.v - before).abs() / SHAKEN);
        }
    }

    /// Looks whether the clock of the class starts at this tick.
    fn clock(&mut self, seen: &Seen, before: f64, off: f64) {
        if seen.acceleration_error.is_finite() {
            // The mean over 50 ms.
            self.mean_error += (seen.acceleration_error - self.mean_error) / (0.05 * self.rate);
        }
        let starts = match self.case.class.promise {
            Promise::Reported(clock, _) | Promise::Relay(clock, _) => match clock {
                Clock::Onset => true,
                Clock::Displacement(least) => seen.displacement_error.abs() > least,
                Clock::Acceleration(least) => self.mean_error.abs() > least,
                Clock::Valve(least) => seen.unexplained.abs() > least,
                Clock::Deviation(least) => off > least,
            },
            Promise::Harmless(_) | Promise::Inside | Promise::Roomy | Promise::Aided | Promise::Measured => true,
        };
        if starts && self.started.is_none() {
            self.started = Some(before);
        }
    }

    fn outcome(&self) -> Outcome {
        let began = self.began.unwrap_or(self.now);
        let from = self.started.unwrap_or(began);
        let at = match self.case.class.promise {
            Promise::Relay(..) => self.relay,
            _ => self.reported.as_ref().map(|(at, _)| *at),
        };
        let latency = at.map(|at| (at - from).max(0.0));
        let outside = self.farthest > farthest(self.case);
        let mut broken = Vec::new();
        if self.alarm || self.case.fault == Fault::None && self.reported.is_some() {
            broken.push(Broken::Alarm);
        } else {
            broken = self.promises(latency, from, outside);
        }
        Outcome {
            run: self.case.number,
            class: self.case.class.id.into(),
            mode: self.case.mode().into(),
            onset_s: began,
            reported: self.reported.as_ref().map(|(_, why)| why.clone()),
            latency_s: latency,
            visible: self.started.is_some(),
            farthest_m: self.farthest,
            deviation_m: self.deviation,
            outside,
            acceleration_m_s2: self.acceleration,
            broken,
        }
    }

    /// What of the promises was not kept.
    fn promises(&self, latency: Option<f64>, from: f64, outside: bool) -> Vec<Broken> {
        let promise = self.case.class.promise;
        let mut broken = Vec::new();
        if promise == Promise::Measured {
            return broken;
        }
        let promised = match promise {
            Promise::Aided => self.case.aided(),
            Promise::Roomy => self.case.aided() || self.case.peak() <= STROKE - ROOM,
            _ => true,
        };
        if outside && promised {
            broken.push(Broken::Excursion);
        }
        match promise {
            Promise::Reported(_, within) | Promise::Relay(_, within) if self.started.is_some() => match latency {
                Some(latency) if latency > within + self.slack() => broken.push(Broken::Late),
                None if self.now - from > within + self.slack() => broken.push(Broken::Unreported),
                _ => {}
            },
            Promise::Harmless(most) if self.deviation > most => broken.push(Broken::Unreported),
            _ => {}
        }
        if self.moving {
            broken.push(Broken::Moving);
        }
        if self.acceleration > ROUGH && softened(self.case) {
            broken.push(Broken::Rough);
        }
        broken
    }

    /// How much later than promised is not late, s: half a tick, for times are sums of ticks, and what slow ticks add.
    fn slack(&self) -> f64 {
        0.5 / self.rate + TURNS * (1.0 / self.rate - 1e-3).max(0.0)
    }
}

/// How far the table may come from the middle, m. A valve that does not obey is stopped by the block alone: the stroke itself is
/// all that is promised of it.
fn farthest(case: &Case) -> f64 {
    let disobeys = |fault: Fault| match fault {
        Fault::Table(how) | Fault::Behind(how) => match how {
            Break::Stuck(at) => at != 0.0,
            Break::Frozen | Break::Bit(..) => true,
            Break::Supply(_) | Break::Payload { .. } => false,
        },
        _ => false,
    };
    let disobeyed = disobeys(case.fault) || case.second.is_some_and(|(fault, _)| disobeys(fault));
    if disobeyed { STROKE } else { STROKE - MARGIN }
}

/// Whether a command softens what the specimen feels: none does where the loop behind the device follows a broken wire, the valve
/// nothing, or a payload knocks.
fn softened(case: &Case) -> bool {
    let knocks = matches!(case.fault, Fault::Table(Break::Payload { .. }));
    !matches!(case.class.promise, Promise::Relay(..)) && !case.shares() && !knocks
}
