//! A run of a record on a device, as a machine that is fed reports and the time, and says what to send.
//!
//! `identify, setup, clear trip, challenge, arm, fill the buffer, start, stream, wait for the stand, disarm`. One request is under
//! way at a time and is repeated when no answer comes; the stream goes back to the point that the device wants next, so a
//! lost or garbled frame costs time and never a point.

use shakedown_core::State;
use shakedown_core::link::{
    Cause, MAX_POINTS, Points, RefusedBecause, Report, Request, Setup, VERSION, Vitals, answer,
};

use super::{Talker, Telemetry};

/// Time after which a request is repeated, ms; for points of the reference, of which a second's worth waits in the
/// device while a third of its frames may be lost, less.
const PATIENCE: u64 = 100;
const STREAM_PATIENCE: u64 = 25;
/// Repeats before the line counts as dead.
const REPEATS: u32 = 30;
/// Points in the buffer before the run starts, at most.
const PREFILL: u32 = 768;

/// Why a run ended early.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DriveError {
    /// Nothing answers.
    #[error("the device does not answer {0}; check port, cable and power")]
    Silent(&'static str),
    /// The device speaks another version.
    #[error("the device speaks version {theirs} of the link, this tool version {VERSION}; flash the matching firmware")]
    Version {
        /// The device's version.
        theirs: u8,
    },
    /// The device refused a request.
    #[error("the device refuses {request}: {because:?}")]
    Refused {
        /// What was asked.
        request: &'static str,
        /// Why not.
        because: RefusedBecause,
    },
    /// The device tripped, stopped by itself, or does not arm.
    #[error("the device stopped the run at tick {tick}: {cause:?}")]
    Stopped {
        /// Why.
        cause: Cause,
        /// When.
        tick: u32,
    },
}

/// How far a run is.
#[derive(Debug, Clone, PartialEq)]
pub enum Progress {
    /// Under way; so many points sent.
    Points(u32),
    /// Over, at rest.
    Done,
    /// Ended early.
    Failed(DriveError),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Identify,
    Setup,
    Vitals,
    ClearTrip,
    Challenge,
    Arm(u64),
    Fill,
    Start,
    Stream,
    Stand,
    Disarm,
    Done,
}

/// A run of a record.
#[derive(Debug)]
pub struct Drive {
    setup: Option<Setup>,
    record: Vec<f32>,
    step: Step,
    asked: Option<u64>,
    repeats: u32,
    wanted: u32,
    room: u32,
    telemetry: Telemetry,
    failed: Option<DriveError>,
}

impl Drive {
    /// A run of `record`, m, one point a tick; `setup` is written first where given.
    pub fn new(setup: Option<Setup>, record: Vec<f32>) -> Self {
        Self {
            setup,
            record,
            step: Step::Identify,
            asked: None,
            repeats: 0,
            wanted: 0,
            room: 0,
            telemetry: Telemetry::default(),
            failed: None,
        }
    }

    /// What the device reported of its ticks.
    pub const fn telemetry(&self) -> &Telemetry {
        &self.telemetry
    }

    /// Takes every report heard, and puts on the line what is due at `now`, ms.
    pub fn advance(&mut self, line: &mut Talker, now: u64) -> Progress {
        while let Some(report) = line.report() {
            self.take(report);
        }
        if let Some(theirs) = line.heard().other_version {
            self.failed.get_or_insert(DriveError::Version { theirs });
        }
        if let Some(error) = &self.failed {
            return Progress::Failed(error.clone());
        }
        if self.step == Step::Done {
            return Progress::Done;
        }
        self.speak(line, now);
        self.failed.clone().map_or(Progress::Points(self.wanted), Progress::Failed)
    }

    fn speak(&mut self, line: &mut Talker, now: u64) {
        let patience = if self.step == Step::Stream { STREAM_PATIENCE } else { PATIENCE };
        if self.asked.is_some_and(|asked| now < asked + patience) {
            return;
        }
        if self.asked.is_some() {
            self.repeats += 1;
            if u64::from(self.repeats) * patience > u64::from(REPEATS) * PATIENCE {
                self.failed = Some(DriveError::Silent(self.name()));
                return;
            }
        }
        if let Some(request) = self.request() {
            line.say(&request);
            self.asked = Some(now);
        }
    }

    /// What this step asks.
    fn request(&self) -> Option<Request> {
        Some(match self.step {
            Step::Identify => Request::Identify,
            Step::Setup => self.setup.map_or(Request::ReadSetup, Request::WriteSetup),
            Step::Vitals | Step::Stand => Request::ReadVitals,
            Step::ClearTrip => Request::ClearTrip,
            Step::Challenge => Request::RequestArming,
            Step::Arm(answer) => Request::Arm(answer),
            Step::Start => Request::Start,
            Step::Disarm => Request::Disarm,
            Step::Fill | Step::Stream => self.points(),
            Step::Done => return None,
        })
    }

    fn points(&self) -> Request {
        let from = self.wanted as usize;
        let to = self.record.len().min(from + (self.room.max(1) as usize).min(MAX_POINTS));
        let points = heapless::Vec::from_slice(self.record.get(from..to).unwrap_or_default()).unwrap_or_default();
        Request::Reference(Points { first: self.wanted, points, last: to == self.record.len() })
    }

    const fn name(&self) -> &'static str {
        match self.step {
            Step::Identify => "who it is",
            Step::Setup => "its setup",
            Step::Vitals | Step::Stand => "how it fares",
            Step::ClearTrip => "clearing the trip",
            Step::Challenge | Step::Arm(_) => "arming",
            Step::Fill | Step::Stream => "the reference",
            Step::Start => "the start",
            Step::Disarm => "disarming",
            Step::Done => "nothing",
        }
    }

    fn go(&mut self, step: Step) {
        self.step = step;
        self.asked = None;
        self.repeats = 0;
    }

    fn take(&mut self, report: Report) {
        match (self.step, report) {
            (_, Report::Telemetry(batch)) => self.telemetry.take(&batch),
            (step, Report::Vitals(vitals)) => self.vitals(step, vitals),
            (Step::Identify, Report::Identity(_)) => self.go(Step::Setup),
            (Step::Setup, Report::Setup(_) | Report::Done) => self.go(Step::Vitals),
            (Step::ClearTrip, Report::Done) => self.go(Step::Vitals),
            (Step::Challenge, Report::Challenge(challenge)) => self.go(Step::Arm(answer(challenge))),
            (Step::Start, Report::Done) => self.go(Step::Stream),
            (Step::Disarm, Report::Refused(RefusedBecause::State(State::Off))) => self.go(Step::Done),
            (Step::Fill | Step::Stream, Report::Credit { next, room }) => self.credit(next, u32::from(room)),
            // The answer to an earlier asking was lost on the way.
            (Step::ClearTrip, Report::Refused(RefusedBecause::State(State::Off))) => self.go(Step::Vitals),
            (Step::Challenge | Step::Arm(_), Report::Refused(RefusedBecause::State(State::Ready))) => {
                self.go(Step::Fill);
            }
            (Step::Start, Report::Refused(RefusedBecause::State(State::Running))) => self.go(Step::Stream),
            (Step::Challenge | Step::Arm(_), Report::Refused(RefusedBecause::Challenge)) => self.go(Step::Challenge),
            (Step::Stream, Report::Refused(RefusedBecause::State(_))) => self.go(Step::Stand),
            // It is armed; this answers the asking once more.
            (Step::Fill | Step::Start | Step::Stream, Report::Refused(RefusedBecause::Challenge)) => {}
            (_, Report::Refused(because)) => {
                self.failed = Some(DriveError::Refused { request: self.name(), because });
            }
            _ => {}
        }
    }

    /// The device says where it stands: the answer to a question, or because it changed.
    fn vitals(&mut self, step: Step, vitals: Vitals) {
        let moving = matches!(step, Step::Fill | Step::Start | Step::Stream | Step::Stand | Step::Disarm);
        let stopped = |cause: Option<Cause>| {
            let cause = cause.unwrap_or(Cause::Asked);
            DriveError::Stopped { cause, tick: vitals.ticks }
        };
        match (step, vitals.state) {
            (Step::Vitals, State::Tripped) => self.go(Step::ClearTrip),
            (Step::Vitals, State::Off) => self.go(Step::Challenge),
            (Step::Vitals | Step::Challenge | Step::Arm(_), State::Ready) => self.go(Step::Fill),
            (Step::Arm(_), State::Off) if vitals.cause.is_some() => self.failed = Some(stopped(vitals.cause)),
            (Step::Start, State::Running) => self.go(Step::Stream),
            (Step::Stream | Step::Stand, State::Ready) if vitals.cause.is_some() => {
                self.failed = Some(stopped(vitals.cause));
            }
            (Step::Stream | Step::Stand, State::Ready) => self.go(Step::Disarm),
            (Step::Disarm, State::Off) => self.go(Step::Done),
            (_, State::Tripped) if moving => self.failed = Some(stopped(vitals.cause)),
            // It answers: the stand may take as long as it takes.
            (Step::Stand, _) => self.repeats = 0,
            _ => {}
        }
    }

    fn credit(&mut self, next: u32, room: u32) {
        self.wanted = next;
        self.room = room;
        self.repeats = 0;
        let all = next as usize >= self.record.len();
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
