//! Questions and answers over a line, by the clock on the wall.

use std::io;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use shakedown_core::link::{DeviceHealth, HostRequest, RefusedBecause, Report, Setup, VERSION};

use super::{DriveError, LinkClient, Progress, Telemetry, TestRunner};

/// Time after which a question is repeated, and how often: longer than a busy host takes to see the answer, for an order
/// given twice is refused the second time.
const PATIENCE: Duration = Duration::from_millis(500);
const REPEATS: u32 = 6;
/// Between two looks at a silent line.
const NAP: Duration = Duration::from_millis(1);

/// Bytes both ways; neither call waits.
pub trait Line {
    /// Takes bytes that have come; 0 where none have.
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize>;
    /// Hands bytes over; gives how many were taken.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;
}

/// Why a device did not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The line failed.
    #[error("the line failed: {0}")]
    Line(#[from] io::Error),
    /// Nothing answers.
    #[error("the device does not answer; check port, cable and power")]
    Silent,
    /// The device speaks another version.
    #[error("the device speaks version {theirs} of the link, this tool version {VERSION}; flash the matching firmware")]
    Version {
        /// The device's version.
        theirs: u8,
    },
    /// The device refused.
    #[error("the device refuses: {0:?}")]
    Refused(RefusedBecause),
    /// A run ended early.
    #[error(transparent)]
    Drive(#[from] DriveError),
}

/// A conversation with a device.
#[derive(Debug)]
pub struct Session<L> {
    line: L,
    talker: LinkClient,
    telemetry: Telemetry,
    start: Instant,
}

impl<L: Line> Session<L> {
    /// Over `line`, on which nothing was said yet.
    pub fn new(line: L) -> Self {
        Self { line, talker: LinkClient::new(), telemetry: Telemetry::default(), start: Instant::now() }
    }

    /// Asks until `wanted` finds its answer. Telemetry that comes meanwhile is kept.
    pub fn ask<T>(&mut self, request: &HostRequest, wanted: impl Fn(&Report) -> Option<T>) -> Result<T, SessionError> {
        for _ in 0..REPEATS {
            self.talker.say(request);
            let until = Instant::now() + PATIENCE;
            while Instant::now() < until {
                self.pump()?;
                while let Some(report) = self.talker.report() {
                    match report {
                        Report::Telemetry(batch) => self.telemetry.take(&batch),
                        Report::Refused(because) => return Err(SessionError::Refused(because)),
                        report => {
                            if let Some(answer) = wanted(&report) {
                                return Ok(answer);
                            }
                        }
                    }
                }
            }
        }
        Err(SessionError::Silent)
    }

    /// The setup in force.
    pub fn setup(&mut self) -> Result<Setup, SessionError> {
        self.ask(&HostRequest::ReadSetup, |report| if let Report::Setup(setup) = report { Some(*setup) } else { None })
    }

    /// Its health.
    pub fn vitals(&mut self) -> Result<DeviceHealth, SessionError> {
        self.ask(
            &HostRequest::ReadVitals,
            |report| if let Report::Vitals(vitals) = report { Some(*vitals) } else { None },
        )
    }

    /// Has something done.
    pub fn order(&mut self, request: &HostRequest) -> Result<(), SessionError> {
        self.ask(request, |report| (*report == Report::Done).then_some(()))
    }

    /// Listens for `time`; gives the telemetry heard since the last time.
    pub fn listen(&mut self, time: Duration) -> Result<Telemetry, SessionError> {
        let until = Instant::now() + time;
        while Instant::now() < until {
            self.pump()?;
            while let Some(report) = self.talker.report() {
                if let Report::Telemetry(batch) = report {
                    self.telemetry.take(&batch);
                }
            }
        }
        Ok(std::mem::take(&mut self.telemetry))
    }

    /// Runs a test to its end. `tell` gets the run, for its telemetry, and how many points were sent, or how many ms of an
    /// attended test are gone; where it breaks, the test is faded out and the device disarmed.
    pub fn drive(
        &mut self,
        drive: &mut TestRunner,
        mut tell: impl FnMut(&mut TestRunner, u32) -> ControlFlow<()>,
    ) -> Result<(), SessionError> {
        loop {
            self.pump()?;
            let now = self.start.elapsed().as_millis() as u64;
            match drive.advance(&mut self.talker, now) {
                Progress::Going(gone) => {
                    if tell(drive, gone).is_break() {
                        drive.end();
                    }
                }
                Progress::Done => return Ok(()),
                Progress::Failed(error) => return Err(error.into()),
            }
        }
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
}
