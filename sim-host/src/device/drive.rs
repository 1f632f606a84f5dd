//! A run of a test on a device, as a machine that is fed reports and the time, and says what to send.
//!
//! `identify, setup, clear trip, challenge, arm, fill the buffer, start, stream, wait for the stand, disarm`. One request is under
//! way at a time and is repeated when no answer comes; the stream goes back to the point that the device wants next, so a
//! lost or garbled frame costs time and never a point. Where the reference, or an existing controller's command, is at the
//! converter there is nothing to stream: the run is attended for its time, and then stopped.

use shakedown_core::State;
use shakedown_core::link::{
    DeviceHealth, HostRequest, MAX_POINTS, Points, RefusedBecause, Report, Setup, StopCause, answer,
};

use super::{LinkClient, Row, Telemetry};

mod operator;
mod progress;
mod step;
#[cfg(test)]
mod tests;

use operator::Operator;
pub use progress::{DriveError, Progress};
use step::Step;

/// Time after which a request is repeated, ms; for points of the reference, of which a second's worth waits in the
/// device while a third of its frames may be lost, less.
const PATIENCE: u64 = 100;
const STREAM_PATIENCE: u64 = 25;
/// Repeats before the line counts as dead.
const REPEATS: u32 = 30;
/// Points in the buffer before the run starts, at most.
const PREFILL: u32 = 768;

/// What a run plays.
#[derive(Debug)]
enum Play {
    /// A record through the link, m, one point a tick.
    Streamed(Vec<f32>),
    /// The analogue input, for so long, ms.
    Attended(u64),
}

/// A run of a test.
#[derive(Debug)]
pub struct TestRunner {
    setup: Option<Setup>,
    play: Play,
    step: Step,
    /// To be ended as soon as it can be.
    ending: bool,
    /// What an operator decides during the run.
    operator: Operator,
    now: u64,
    asked: Option<u64>,
    repeats: u32,
    wanted: u32,
    room: u32,
    telemetry: Telemetry,
    failed: Option<DriveError>,
}

impl TestRunner {
    /// A run of `record`, m, one point a tick; `setup` is written first where given.
    pub fn new(setup: Option<Setup>, record: Vec<f32>) -> Self {
        Self { setup, ..Self::playing(Play::Streamed(record)) }
    }

    /// A test from the device's analogue input, for `time`, ms; `setup` is written first where given.
    pub fn attended(setup: Option<Setup>, time: u64) -> Self {
        Self { setup, ..Self::playing(Play::Attended(time)) }
    }

    fn playing(play: Play) -> Self {
        Self {
            setup: None,
            play,
            step: Step::Identify,
            ending: false,
            operator: Operator::default(),
            now: 0,
            asked: None,
            repeats: 0,
            wanted: 0,
            room: 0,
            telemetry: Telemetry::default(),
            failed: None,
        }
    }

    /// Fades the test out, if it runs, and disarms: the way to end it before its time.
    pub const fn end(&mut self) {
        self.ending = true;
    }

    /// What the device reported of its ticks.
    pub const fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// The records reported since the last time, which are not kept any longer.
    pub fn take_rows(&mut self) -> Vec<Row> {
        self.telemetry.take_rows()
    }

    /// Takes every report heard, and puts on the line what is due at `now`, ms.
    pub fn advance(&mut self, line: &mut LinkClient, now: u64) -> Progress {
        self.now = now;
        while let Some(report) = line.report() {
            self.take(report);
        }
        if let Some(theirs) = line.heard().other_version {
            self.failed.get_or_insert(DriveError::Version { theirs });
        }
        if let Some(error) = &self.failed {
            return Progress::Failed(error.clone());
        }
        self.see_to_the_end();
        if self.step == Step::Done {
            return Progress::Done;
        }
        self.speak(line, now);
        self.failed.clone().map_or_else(|| Progress::Going(self.gone()), Progress::Failed)
    }

    /// A test that has had its time, or is to end before it, is stopped; one that is not armed yet is not armed any more.
    fn see_to_the_end(&mut self) {
        let over = match (&self.play, self.step) {
            (Play::Attended(time), Step::Attend(begun)) => self.now >= begun.saturating_add(*time),
            _ => false,
        };
        match self.step {
            Step::Identify | Step::Setup | Step::Vitals | Step::ClearTrip | Step::Challenge if self.ending => {
                self.go(Step::Done);
            }
            Step::Arm(_) | Step::Fill | Step::Start | Step::Stream | Step::Attend(_) if self.ending || over => {
                self.go(Step::Stop);
            }
            Step::Stream | Step::Attend(_) if self.operator.hold => self.go(Step::Stop),
            Step::Held | Step::Release if self.ending => self.go(Step::Disarm),
            _ => {}
        }
    }

    fn gone(&self) -> u32 {
        match (&self.play, self.step) {
            (Play::Streamed(_), _) => self.wanted,
            (Play::Attended(_), Step::Attend(begun)) => (self.now - begun) as u32,
            (Play::Attended(time), Step::Stop | Step::Stand | Step::Disarm | Step::Done) => *time as u32,
            (Play::Attended(_), _) => 0,
        }
    }

    fn speak(&mut self, line: &mut LinkClient, now: u64) {
        let patience = if self.step == Step::Stream { STREAM_PATIENCE } else { PATIENCE };
        if self.asked.is_some_and(|asked| now < asked + patience) {
            return;
        }
        if self.asked.is_some() {
            self.repeats += 1;
            if u64::from(self.repeats) * patience > u64::from(REPEATS) * PATIENCE {
                self.failed = Some(DriveError::Silent(self.step.name()));
                return;
            }
        }
        if let Some(request) = self.request() {
            line.say(&request);
            self.asked = Some(now);
        }
    }

    /// What this step asks.
    fn request(&self) -> Option<HostRequest> {
        Some(match self.step {
            Step::Identify => HostRequest::Identify,
            Step::Setup => self.setup.map_or(HostRequest::ReadSetup, HostRequest::WriteSetup),
            Step::Start if self.waits() => HostRequest::ReadVitals,
            Step::Vitals | Step::Attend(_) | Step::Stand | Step::Held => HostRequest::ReadVitals,
            Step::ClearTrip => HostRequest::ClearTrip,
            Step::Challenge => HostRequest::RequestArming,
            Step::Arm(answer) => HostRequest::Arm(answer),
            Step::Start => HostRequest::Start,
            Step::Stop => HostRequest::Stop,
            Step::Release | Step::Disarm => HostRequest::Disarm,
            Step::Fill | Step::Stream => self.points(),
            Step::Done => return None,
        })
    }

    fn points(&self) -> HostRequest {
        let record = self.record();
        let from = self.wanted as usize;
        let to = record.len().min(from + (self.room.max(1) as usize).min(MAX_POINTS));
        let points = heapless::Vec::from_slice(record.get(from..to).unwrap_or_default()).unwrap_or_default();
        // Asked for once more, what was sent whole before the start has no second end.
        let last = to == record.len() && (from < to || record.is_empty());
        HostRequest::Reference(Points { first: self.wanted, points, last })
    }

    fn record(&self) -> &[f32] {
        if let Play::Streamed(record) = &self.play { record } else { &[] }
    }

    /// Armed: what comes before the start.
    const fn armed(&self) -> Step {
        if let Play::Streamed(_) = self.play { Step::Fill } else { Step::Start }
    }

    /// Started: what the test is kept going by.
    const fn started(&self) -> Step {
        if let Play::Streamed(_) = self.play { Step::Stream } else { Step::Attend(self.now) }
    }

    fn go(&mut self, step: Step) {
        self.step = step;
        self.asked = None;
        self.repeats = 0;
    }

    /// Takes a report.
    pub(crate) fn take(&mut self, report: Report) {
        match (self.step, report) {
            (_, Report::Telemetry(batch)) => self.telemetry.take(&batch),
            (step, Report::Vitals(vitals)) => self.vitals(step, vitals),
            (Step::Identify, Report::Identity(_)) => self.go(Step::Setup),
            (Step::Setup, Report::Setup(_) | Report::Done) => self.go(Step::Vitals),
            (Step::ClearTrip | Step::Release, Report::Done) => self.go(Step::Vitals),
            (Step::Challenge, Report::Challenge(challenge)) => self.go(Step::Arm(answer(challenge))),
            // Before the operator's start it answers something earlier.
            (Step::Start, Report::Done) if self.waits() => {}
            (Step::Start, Report::Done) => self.go(self.started()),
            (step, Report::Refused(RefusedBecause::State(state))) if step.comes_after(state) => {}
            (Step::Stop, Report::Done | Report::Refused(RefusedBecause::State(_))) => self.go(Step::Stand),
            (Step::Disarm, Report::Refused(RefusedBecause::State(State::Off))) => self.go(Step::Done),
            (Step::Fill | Step::Stream, Report::Credit { next, room }) => self.credit(next, u32::from(room)),
            // The answer to an earlier asking was lost on the way.
            (Step::ClearTrip | Step::Release, Report::Refused(RefusedBecause::State(State::Off))) => {
                self.go(Step::Vitals);
            }
            (Step::Challenge | Step::Arm(_), Report::Refused(RefusedBecause::State(State::Ready))) => {
                self.go(self.armed());
            }
            (Step::Start, Report::Refused(RefusedBecause::State(State::Running))) => self.go(self.started()),
            (Step::Challenge | Step::Arm(_), Report::Refused(RefusedBecause::Challenge)) => self.go(Step::Challenge),
            (Step::Stream, Report::Refused(RefusedBecause::State(_))) => self.go(Step::Stand),
            // It is armed; this answers the asking once more.
            (
                Step::Fill | Step::Start | Step::Stream | Step::Attend(_) | Step::Stop | Step::Stand | Step::Held,
                Report::Refused(RefusedBecause::Challenge),
            ) => {}
            // A device that is busy with what was asked before is asked again when patience is at an end.
            (_, Report::Refused(RefusedBecause::Full)) => {}
            (_, Report::Refused(because)) => {
                self.failed = Some(DriveError::Refused { request: self.step.name(), because });
            }
            _ => {}
        }
    }

    /// The device says where it stands: the answer to a question, or because it changed.
    fn vitals(&mut self, step: Step, vitals: DeviceHealth) {
        use Step::{Arm, Attend, Challenge, Disarm, Done, Fill, Held, Stand, Start, Stop, Stream};
        let moving = matches!(step, Fill | Start | Stream | Attend(_) | Stop | Stand | Held | Disarm);
        let stopped = |cause: Option<StopCause>| {
            let cause = cause.unwrap_or(StopCause::Asked);
            DriveError::Stopped { cause, tick: vitals.ticks }
        };
        match (step, vitals.state) {
            (Step::Vitals, State::Tripped) => self.go(Step::ClearTrip),
            (Step::Vitals, State::Off) => self.go(Challenge),
            (Step::Vitals, State::Ready) if !self.record().is_empty() => self.go(Step::Release),
            (Step::Vitals | Challenge | Arm(_), State::Ready) => self.go(self.armed()),
            (Arm(_), State::Off) if vitals.cause.is_some() => self.failed = Some(stopped(vitals.cause)),
            (Start, State::Running) => self.go(self.started()),
            // An operator's stop disarms whatever ended the test before it: one that ran dry included.
            (Stand, State::Ready) if self.ending && self.operator.present => self.go(Disarm),
            (Stream | Attend(_) | Stand, State::Ready) if vitals.cause.is_some() => {
                self.failed = Some(stopped(vitals.cause));
            }
            (Stand, State::Ready) if self.operator.hold && !self.ending => self.go(Held),
            (Stream | Attend(_) | Stand, State::Ready) => self.go(Disarm),
            (Disarm | Held, State::Off) => self.go(Done),
            // Another host disarmed it.
            (Start, State::Off) if self.waits() => self.failed = Some(stopped(vitals.cause)),
            // It was to be ended before it was armed.
            (Stand, State::Off) if self.ending => self.go(Done),
            // What was done was the start.
            (Stand, State::Running) if self.ending || self.operator.hold || matches!(self.play, Play::Attended(_)) => {
                self.go(Stop);
            }
            (_, State::Tripped) if moving => self.failed = Some(stopped(vitals.cause)),
            // It answers: the test, the stand and the operator may take as long as they take.
            (Attend(_) | Stand | Held, _) => self.repeats = 0,
            (Start, State::Ready) if self.waits() => self.repeats = 0,
            _ => {}
        }
    }

    fn credit(&mut self, next: u32, room: u32) {
        self.wanted = next;
        self.room = room;
        self.repeats = 0;
        let all = next as usize >= self.record().len();
        let step = match self.step {
            Step::Fill if all || next >= PREFILL => Step::Start,
            Step::Stream if all => Step::Stand,
            step => step,
        };
        if room > MAX_POINTS as u32 || step != self.step {
            self.go(step);
        }
    }
}
