//! A device, or its twin, attended: requests and reports, the run in the operator's hands, its recording.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use shakedown_core::State;
use shakedown_core::link::{DeviceHealth, HostRequest, Report, Setup, Source};

use super::bench::{Answer, BenchError, Facts, Phase};
use crate::device::{
    DriveError, Kept, Line, LinkClient, Progress, ProofTest, Recorder, SessionError, Telemetry, TestRunner,
};

mod arming;
mod as_bench;
mod samples;

use arming::Arming;
use samples::Samples;

/// How often a device is asked for its health, and after what silence it counts as gone, ms.
const ASK_EVERY: u64 = 250;
const GONE_AFTER: u64 = 2000;
/// How often a trip is repeated until the device says that it has tripped, ms.
const TRIP_EVERY: u64 = 50;
/// Between two looks at a silent line.
const NAP: Duration = Duration::from_millis(1);

/// What a test plays and where it is recorded.
#[derive(Debug, Clone, Default)]
pub struct Storage {
    /// The reference, m, one point a tick; empty where nothing is streamed.
    pub reference: Vec<f32>,
    /// Length of a test of what is at the converter, ms; none where there is none.
    pub attended: Option<u64>,
    /// Folder for the recordings, one folder a test; none where nothing is kept.
    pub folder: Option<PathBuf>,
    /// The proof test that arming asks for; none where it asks for none.
    pub proof: Option<ProofTest>,
}

/// A device at the other end of a line.
#[derive(Debug)]
pub struct Attendant<L> {
    line: L,
    talker: LinkClient,
    telemetry: Telemetry,
    samples: Samples,
    facts: Facts,
    setup: Setup,
    storage: Storage,
    drive: Option<TestRunner>,
    recorder: Option<Recorder>,
    arming: Arming,
    vitals: Option<DeviceHealth>,
    start: Instant,
    heard: u64,
    asked: u64,
    /// When a trip was last sent that the device has not confirmed, ms.
    tripping: Option<u64>,
    stopping: bool,
    gone: u64,
    message: (u64, String),
}

impl<L: Line> Attendant<L> {
    /// Attends the device at the other end of `line`, whose setup is `setup`.
    pub fn new(line: L, kind: &'static str, name: String, setup: Setup, storage: Storage) -> Self {
        let control = &setup.control;
        let full = control.velocity_limit / control.valve.gain;
        let has_test = match setup.wiring.source {
            Source::Streamed | Source::Rehearsal => !storage.reference.is_empty(),
            Source::Analog => storage.attended.is_some(),
        };
        let facts = Facts {
            kind,
            name,
            rate: f64::from(control.rate) / f64::from(setup.telemetry_every.max(1)),
            full_opening: (full.is_finite() && full > 0.0).then_some(f64::from(full)),
            stroke: Some(f64::from(control.stroke)),
            has_test,
            recorded_in: storage.folder.as_ref().map(|folder| folder.display().to_string()),
        };
        Self {
            line,
            talker: LinkClient::new(),
            telemetry: Telemetry::default(),
            samples: Samples::new(&setup),
            facts,
            setup,
            storage,
            drive: None,
            recorder: None,
            arming: Arming::default(),
            vitals: None,
            start: Instant::now(),
            heard: 0,
            asked: 0,
            tripping: None,
            stopping: false,
            gone: 0,
            message: (0, "connected".into()),
        }
    }

    fn now(&self) -> u64 {
        self.start.elapsed().as_millis() as u64
    }

    fn say(&mut self, message: impl Into<String>) {
        self.message = (self.message.0 + 1, message.into());
    }

    fn state(&self) -> Option<State> {
        self.vitals.map(|vitals| vitals.state)
    }

    /// Moves bytes both ways; naps where there were none.
    fn pump(&mut self) -> Result<(), SessionError> {
        let mut bytes = [0; 4096];
        let read = self.line.read(&mut bytes)?;
        self.talker.hear(bytes.get(..read).unwrap_or_default().iter().copied());
        if let Some(theirs) = self.talker.heard().other_version {
            return Err(SessionError::Version { theirs });
        }
        let outgoing = self.talker.outgoing();
        let written = self.line.write(outgoing.make_contiguous())?;
        outgoing.drain(..written);
        if read == 0 && written == 0 {
            std::thread::sleep(NAP);
        }
        Ok(())
    }

    /// Takes what was heard.
    fn listen(&mut self, now: u64) {
        while let Some(report) = self.talker.report() {
            self.heard = now;
            match &report {
                Report::Telemetry(batch) => self.telemetry.take(batch),
                Report::Vitals(vitals) => {
                    self.vitals = Some(*vitals);
                    if vitals.state == State::Tripped {
                        self.tripping = None;
                    }
                }
                _ => {}
            }
            if let Some(drive) = &mut self.drive
                && !matches!(report, Report::Telemetry(_))
            {
                drive.take(report);
            }
        }
    }

    /// Says what is due: a trip first, then the run's next request, then the question of its health.
    fn speak(&mut self, now: u64) -> Result<(), BenchError> {
        if self.tripping.is_some_and(|sent| now >= sent + TRIP_EVERY) {
            self.talker.say(&HostRequest::Trip);
            self.tripping = Some(now);
        }
        if let Some(drive) = &mut self.drive {
            match drive.advance(&mut self.talker, now) {
                Progress::Going(gone) => self.gone = u64::from(gone),
                Progress::Done => self.finished("the test is over; the relay is open".into())?,
                Progress::Failed(DriveError::Version { theirs }) => return Err(SessionError::Version { theirs }.into()),
                Progress::Failed(error) => self.finished(error.to_string())?,
            }
        }
        if now >= self.asked + ASK_EVERY {
            self.talker.say(&HostRequest::ReadVitals);
            self.asked = now;
        }
        Ok(())
    }

    /// The run is over, one way or another: its recording is put in its place.
    fn finished(&mut self, message: String) -> Result<(), BenchError> {
        (self.drive, self.stopping) = (None, false);
        let place = match self.recorder.take() {
            Some(recorder) => recorder.end()?,
            None => None,
        };
        self.say(match place {
            Some(place) => format!("{message}; recorded in {}", place.display()),
            None => message,
        });
        Ok(())
    }

    /// The first half of arming: what speaks against it, or a number to confirm with.
    fn arm(&mut self) -> Result<Answer, String> {
        self.may_arm()?;
        Ok(Answer { confirm: Some(self.arming.ask(self.now())) })
    }

    fn may_arm(&self) -> Result<(), String> {
        if self.drive.is_some() {
            return Err("a test is under way; stop it first".into());
        }
        if !self.facts.has_test {
            return Err("there is nothing to play; start `shakedown live` with a reference".into());
        }
        if let Some(overdue) = self.storage.proof.as_ref().and_then(ProofTest::overdue) {
            return Err(format!("{overdue}; end this and walk through it with `device commission --daily`"));
        }
        match self.state() {
            Some(State::Off | State::Tripped) => Ok(()),
            Some(state) => Err(format!("the device is {state:?}, from an earlier test; stop it first")),
            None => Err("the device has not answered yet".into()),
        }
    }

    /// The second half: the run begins, up to where it waits for the start.
    fn confirm(&mut self, number: u32) -> Result<(), String> {
        self.may_arm()?;
        self.arming.confirm(number, self.now())?;
        if let Some(folder) = &self.storage.folder {
            let recorder = Recorder::begin(&arming::next_folder(folder), &self.setup, Kept::Run);
            self.recorder = Some(recorder.map_err(|e| e.to_string())?);
        }
        let drive = match self.storage.attended {
            Some(time) if self.setup.wiring.source == Source::Analog => TestRunner::attended(None, time),
            _ => TestRunner::new(None, self.storage.reference.clone()),
        };
        self.drive = Some(drive.operated());
        self.gone = 0;
        self.say("arming");
        Ok(())
    }

    fn begin(&mut self) -> Result<(), String> {
        let Some(drive) = self.drive.as_mut().filter(|drive| drive.waits()) else {
            return Err("nothing waits for a start; arm first".into());
        };
        drive.begin();
        self.say("started");
        Ok(())
    }

    fn hold(&mut self) -> Result<(), String> {
        let running = matches!(self.phase(), Phase::Running | Phase::Held);
        let Some(drive) = self.drive.as_mut().filter(|_| running) else {
            return Err("no test runs that could be held".into());
        };
        drive.hold();
        self.say("fading out, to be held");
        Ok(())
    }

    /// Ends whatever is under way, and what another host left armed.
    fn stop(&mut self) {
        self.arming.forget();
        let at_rest = matches!(self.state(), Some(State::Off | State::Tripped));
        match &mut self.drive {
            Some(drive) => drive.end(),
            None if at_rest => return self.say("nothing is under way; the relay is open"),
            None => self.drive = Some(TestRunner::closing()),
        }
        self.stopping = true;
        self.say("stopping");
    }

    fn phase(&self) -> Phase {
        match &self.drive {
            None => Phase::Idle,
            Some(_) if self.stopping => Phase::Stopping,
            Some(drive) if drive.waits() => Phase::Armed,
            Some(drive) if drive.holds() => Phase::Held,
            Some(drive) if drive.is_running() => Phase::Running,
            Some(drive) if drive.is_armed() => Phase::Stopping,
            Some(_) => Phase::Arming,
        }
    }
}
