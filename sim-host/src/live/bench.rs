//! What can be watched: its samples, its status, and what it can be ordered to do.

use serde::Serialize;
use shakedown_core::State;

use crate::device::{RecorderError, SessionError};

/// One record of telemetry in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Since the first sample, s.
    pub time: f64,
    /// Records missing between the sample before and this one.
    pub gap: u32,
    /// Reference as it came, m.
    pub reference: f64,
    /// Reference after modification, m.
    pub modified: f64,
    /// Measured displacement, m.
    pub displacement: f64,
    /// Measured acceleration, m/s2.
    pub acceleration: f64,
    /// Valve command, m.
    pub command: f64,
    /// State of the test.
    pub state: State,
    /// The table's velocity is at its limit.
    pub saturated: bool,
    /// The command is at its limit.
    pub limited: bool,
    /// An input was unusable and the last output held.
    pub held: bool,
}

/// What a page is told once about a bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Facts {
    /// What it is: `device`, `twin` or `recording`.
    pub kind: &'static str,
    /// Its name: a port, a file, a table.
    pub name: String,
    /// Samples a second, Hz.
    pub rate: f64,
    /// Valve command that opens the valve fully, m; none where it is not known.
    pub full_opening: Option<f64>,
    /// Largest displacement to either side, m; none where it is not known.
    pub stroke: Option<f64>,
    /// Whether a test can be started.
    pub has_test: bool,
    /// Where tests are recorded; none where they are not.
    pub recorded_in: Option<String>,
}

/// What is under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// Nothing.
    Idle,
    /// The arming handshake.
    Arming,
    /// The relay is closed, the table is held and the reference buffered: it waits for the start.
    Armed,
    /// The test.
    Running,
    /// The test was faded out; the table is held, the relay closed.
    Held,
    /// On the way to a stand and to the open relay.
    Stopping,
}

/// How a bench fares.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Status {
    /// What is under way.
    pub phase: Phase,
    /// The device's own state; none before it was heard.
    pub state: Option<State>,
    /// Why it tripped or stopped by itself, last.
    pub cause: Option<String>,
    /// Whether it answers.
    pub answers: bool,
    /// Points or ms of the test that are gone, and of how many.
    pub gone: u64,
    /// Length of the test in the same unit.
    pub total: u64,
    /// Samples received.
    pub samples: u64,
    /// Records missing between them.
    pub missing: u64,
    /// Records that the device says it had no room for.
    pub dropped: u64,
    /// Frames lost to a wrong check sum.
    pub garbled: u64,
    /// Rows of the present test on the disk.
    pub recorded: u64,
    /// What happened last, in words.
    pub message: String,
    /// Which one that is: it rises with every message.
    pub message_number: u64,
}

/// What an operator may order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Order {
    /// First half of arming: asks for a number to confirm with.
    Arm,
    /// Second half: arms, where the number is the last one given and not older than ten seconds.
    Confirm(u32),
    /// Starts the test.
    Start,
    /// Fades the test out and holds the table, the relay closed.
    Hold,
    /// Fades the test out, waits for the stand and disarms. Never refused.
    Stop,
    /// Trips: the safe ramp, then the relay opens. Never refused.
    Trip,
}

/// What an order came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Answer {
    /// The number to confirm arming with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confirm: Option<u32>,
}

/// Why a bench can no longer be watched.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The line failed, or the device does not speak this version.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// The recording could not go on; the test was ended.
    #[error("the test was ended, for its recording could not go on: {0}")]
    Recorder(#[from] RecorderError),
}

/// Something to watch.
pub trait Bench {
    /// What it is.
    fn facts(&self) -> Facts;
    /// Does what is due, waits a millisecond where nothing is, and gives the samples that came.
    fn advance(&mut self) -> Result<Vec<Sample>, BenchError>;
    /// Its status.
    fn status(&self) -> Status;
    /// Carries out an order, or says why not.
    fn order(&mut self, order: Order) -> Result<Answer, String>;
    /// Whether nothing is under way that would have to be ended.
    fn is_idle(&self) -> bool;
}
