//! The independent judge of a run: it knows the truth, the fault and what the class promises, and nothing of how the guard
//! works.

mod measures;
mod reach;

use super::case::Case;
use super::class::{Clock, Fault, HIDDEN, Promise};
use super::rig::{self, Pair, RigError, TruthSample};
use measures::{Lately, Outrun, Shaken, Stands, Unexplained};
pub(super) use reach::softened;
use reach::{farthest, told_of};
use serde::{Deserialize, Serialize};
use shakedown_core::{Mode, Relay, State};

/// Half the table's travel, m.
pub const STROKE: f64 = 0.12;
/// Room that the envelope keeps free at each end, m; a table beyond it has made an excursion.
pub const MARGIN: f64 = 0.005;
/// Largest acceleration within the envelope, m/s2.
pub const ROUGH: f64 = 30.0;
/// Ticks by which a rate below 1 kHz may make a report later: three until a monitor's next turn, and one.
const TURNS: f64 = 4.0;

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
    /// Farthest that it was until it was reported, m, both from where it would have been without the fault and from the reference that
    /// the device reports.
    pub deviation_m: f64,
    /// The same less what an even [`HIDDEN`] since the fault makes: what a promise on it is held to.
    pub beyond_null_m: f64,
    /// Whether the test ended before the fault by what the guard said and was so: the table was at a limit switch, as far from its
    /// reference as the envelope lets it be, or shook harder than its accelerometer reads.
    pub ended: bool,
    /// Whether the table left its stroke less the margin, or its stroke where the valve does not obey, promised or not.
    pub outside: bool,
    /// Largest acceleration of the table and its specimen, mean over `SHAKEN`, m/s2.
    pub acceleration_m_s2: f64,
    /// What was not kept.
    pub broken: Vec<Violation>,
}

/// What a run may not keep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Violation {
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
    shaken: Shaken,
    outrun: Outrun,
    unexplained: Unexplained,
    lately: Lately,
    began: Option<f64>,
    started: Option<f64>,
    reported: Option<(f64, String)>,
    relay: Option<f64>,
    farthest: f64,
    deviation: f64,
    /// The same less what an even [`HIDDEN`] since the onset makes.
    beyond_null: f64,
    mean_error: f64,
    alarm: bool,
    ended: bool,
    stands: Stands,
    /// How long the table moved at more than a tenth of its speed before the fault, s.
    moved: f64,
    now: f64,
}

/// What the device says of the fault, if anything: a trip, or a test that is not where it would be.
fn report(seen: &TruthSample, expected: State) -> Option<String> {
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
            shaken: Shaken::default(),
            outrun: Outrun::default(),
            unexplained: Unexplained::default(),
            lately: Lately::default(),
            began: None,
            started: None,
            reported: None,
            relay: None,
            farthest: 0.0,
            deviation: 0.0,
            beyond_null: 0.0,
            mean_error: 0.0,
            alarm: false,
            ended: false,
            stands: Stands::default(),
            moved: 0.0,
            now: 0.0,
        }
    }

    /// Whether the run goes on.
    fn see(&mut self, seen: &TruthSample) -> bool {
        let before = self.now;
        self.now = seen.time;
        self.lately.see(seen, self.case);
        if seen.tick < self.case.onset {
            if seen.v.abs() > 0.1 * self.case.table.limit {
                self.moved += seen.time - before;
            }
            self.ended = seen.trip.is_some_and(|trip| self.lately.bears_out(trip, self.case));
            self.alarm = seen.trip.is_some() && !self.ended;
            self.reported = seen.trip.map(|trip| (seen.time, format!("{trip:?}")));
            return seen.trip.is_none();
        }
        let expected = self.pair.expected.get(seen.tick).copied().unwrap_or(seen.state);
        self.began.get_or_insert(before);
        self.farthest = self.farthest.max(seen.x.abs());
        self.shaken.see(seen, self.rate);
        let off = self.off(seen);
        let hidden = HIDDEN * (seen.time - self.began.unwrap_or(before));
        self.outrun.see(seen.displacement_error, seen.time - before);
        self.unexplained.see(seen, seen.time - before, self.rate);
        // A table without oil is hurt by nothing, and nothing is reported of it before somebody wants to arm it.
        if expected != State::Off {
            self.clock(seen, before, off - hidden);
        }
        if self.reported.is_none() {
            self.reported = report(seen, expected).map(|why| (seen.time, why));
            if self.case.fault == Fault::None {
                self.ended = seen.trip.is_some_and(|trip| self.lately.bears_out(trip, self.case));
            }
        }
        if self.reported.is_none() {
            self.deviation = self.deviation.max(off);
            self.beyond_null = self.beyond_null.max(off - hidden);
        }
        if seen.relay == Relay::Open {
            self.relay.get_or_insert(seen.time);
        }
        match (&self.reported, seen.trip) {
            (Some(_), Some(_)) => self.stands.see(seen),
            _ => true,
        }
    }

    /// How far the table is from where it would have been, and from where the device says that it is to be, m: a test that is modified
    /// more than it would have been is reported as such. A guard in front of an existing controller knows no reference.
    fn off(&self, seen: &TruthSample) -> f64 {
        let from = |place: f64| (seen.x - place).abs();
        let twin = from(self.pair.without.get(seen.tick).copied().unwrap_or(seen.x));
        if self.case.settings.mode == Mode::Guard { twin } else { twin.min(from(seen.reference)) }
    }

    /// Looks whether the clock of the class starts at this tick.
    fn clock(&mut self, seen: &TruthSample, before: f64, off: f64) {
        if seen.acceleration_error.is_finite() {
            // The mean over 50 ms.
            self.mean_error += (seen.acceleration_error - self.mean_error) / (0.05 * self.rate);
        }
        let starts = match self.case.class.promise {
            Promise::Reported(clock, _) | Promise::Relay(clock, _) => match clock {
                Clock::Onset => true,
                Clock::Displacement(least) => seen.displacement_error.abs() > least,
                Clock::Acceleration(least) => self.mean_error.abs() > least,
                Clock::Valve(lately, all) => self.unexplained.exceeds(lately, all),
                Clock::Deviation(least) => off > least,
            },
            Promise::Harmless(_) | Promise::Inside | Promise::Roomy { .. } | Promise::Aided | Promise::Measured => true,
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
        let alone = self.case.fault == Fault::None && self.reported.is_some();
        let broken = if self.ended {
            Vec::new()
        } else if self.alarm || alone {
            vec![Violation::Alarm]
        } else {
            self.promises(latency, from, outside)
        };
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
            beyond_null_m: self.beyond_null,
            ended: self.ended,
            outside,
            acceleration_m_s2: self.shaken.acceleration,
            broken,
        }
    }

    /// What of the promises was not kept.
    fn promises(&self, latency: Option<f64>, from: f64, outside: bool) -> Vec<Violation> {
        let promise = self.case.class.promise;
        let mut broken = Vec::new();
        if promise == Promise::Measured {
            return broken;
        }
        let promised = match promise {
            Promise::Aided => self.case.aided(),
            Promise::Roomy { as_gain } => told_of(self.case, &self.outrun, self.moved, as_gain),
            _ => true,
        };
        if outside && promised {
            broken.push(Violation::Excursion);
        }
        match promise {
            Promise::Reported(_, within) | Promise::Relay(_, within) if self.started.is_some() => match latency {
                Some(latency) if latency > within + self.slack() => broken.push(Violation::Late),
                None if self.now - from > within + self.slack() => broken.push(Violation::Unreported),
                _ => {}
            },
            Promise::Harmless(most) if self.beyond_null > most => broken.push(Violation::Unreported),
            _ => {}
        }
        if self.stands.moving() {
            broken.push(Violation::Moving);
        }
        if self.shaken.acceleration > ROUGH && softened(self.case) {
            broken.push(Violation::Rough);
        }
        broken
    }

    /// How much later than promised is not late, s: half a tick, for times are sums of ticks, and what slow ticks add.
    fn slack(&self) -> f64 {
        0.5 / self.rate + TURNS * (1.0 / self.rate - 1e-3).max(0.0)
    }
}
