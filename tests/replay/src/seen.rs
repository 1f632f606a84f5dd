//! The world around the emulated board: the bench at its converters, a host's [`TestRunner`] at its line.

use shakedown::blocks::device::{DriveError, LinkClient, Progress, TestRunner};
use shakedown_core::link::{Setup, StopCause};

use crate::bench::Bench;
use crate::world::SCANS;
use crate::{Fitted, Oscillator, Tick, World};

/// What was at the converters in one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Codes {
    /// Read: reference, displacement, acceleration, existing command.
    pub inputs: [u16; 4],
    /// Written.
    pub output: u16,
    /// Whether the relay is closed.
    pub relay: bool,
}

/// What goes wrong, and when.
pub type Mischief = Box<dyn FnMut(&mut Tick<'_>, &mut LinkClient) + Send>;

/// What sums of scans become scan by scan.
pub type Scanner = Box<dyn FnMut([u16; 4]) -> [[u16; 4]; SCANS] + Send>;

/// A run of a record on the emulated board.
#[allow(missing_debug_implementations, reason = "what goes wrong is a function")]
pub struct Seen {
    /// The table.
    pub bench: Bench,
    /// The host's side of the run.
    pub drive: TestRunner,
    /// Its end of the line.
    pub talker: LinkClient,
    /// By tick.
    pub codes: Vec<Codes>,
    /// Instructions retired up to each tick.
    pub instructions: Vec<u64>,
    /// Virtual time of each tick, ns.
    pub times: Vec<u64>,
    /// How far the run is.
    pub progress: Progress,
    /// What goes wrong.
    pub mischief: Option<Mischief>,
    /// What the valve gets in place of the output, and from which tick on: the wire to its amplifier is shorted.
    pub shorted: Option<(usize, u16)>,
    /// What the scans of on-chip converters read; none for what is at the converters, without noise.
    pub scanner: Option<Scanner>,
    /// Ticks still to run after the end, so that the last telemetry arrives.
    pub after: u32,
    /// Ticks after which it ends in any case.
    pub limit: usize,
    /// Tick from which the converter is dead, until the next reset.
    pub dead_from: Option<usize>,
    /// Tick whose sample is lost.
    pub lost_at: Option<usize>,
    /// The update in whose tick the core stands, and for how long, ns; none for never.
    pub stands: Option<(usize, u64)>,
    /// What is on the pins of the crystal.
    pub oscillator: Oscillator,
    /// Frequency of the watchdog's clock, Hz.
    pub watchdog_clock: u64,
    /// Resets since power-on.
    pub resets: usize,
    fitted: Fitted,
    relay: bool,
}

impl Seen {
    /// Why the device stopped its test, if it did.
    pub fn cause(&self) -> Option<StopCause> {
        match self.progress {
            Progress::Failed(DriveError::Stopped { cause, .. }) => Some(cause),
            _ => None,
        }
    }

    /// A run of `record`, m, under `setup`.
    pub fn new(setup: Setup, record: Vec<f32>) -> Self {
        let limit = record.len() + 30_000;
        Self {
            bench: Bench::new(setup, record.clone()),
            drive: TestRunner::new(Some(setup), record),
            talker: LinkClient::new(),
            codes: Vec::new(),
            instructions: Vec::new(),
            times: Vec::new(),
            progress: Progress::Going(0),
            mischief: None,
            shorted: None,
            scanner: None,
            after: 100,
            limit,
            dead_from: None,
            lost_at: None,
            stands: None,
            oscillator: Oscillator::Crystal,
            watchdog_clock: 32_000,
            resets: 0,
            fitted: Fitted::of(setup.wiring.full_scale),
            relay: false,
        }
    }

    fn host(&mut self, tick: &mut Tick<'_>) {
        self.talker.hear(tick.line.from_device.drain(..));
        self.progress = self.drive.advance(&mut self.talker, tick.time / 1_000_000);
        tick.line.to_device.extend(self.talker.outgoing().drain(..));
    }
}

impl World for Seen {
    fn tick(&mut self, mut tick: Tick<'_>) -> bool {
        if let (Some(output), Some(last)) = (tick.output, self.codes.last_mut()) {
            last.output = output;
            last.relay = tick.relay;
            let now = self.codes.len();
            let shorted = self.shorted.filter(|&(from, _)| now > from);
            self.bench.advance(shorted.map_or(output, |(_, code)| code), tick.relay);
        }
        if tick.relay && !self.relay && self.bench.played.is_none() {
            self.bench.played = Some(0);
        }
        self.relay = tick.relay;
        self.resets = tick.resets;
        *tick.inputs = self.bench.codes();
        self.host(&mut tick);
        if let Some(mischief) = &mut self.mischief {
            mischief(&mut tick, &mut self.talker);
        }
        self.codes.push(Codes { inputs: *tick.inputs, output: 0, relay: false });
        self.instructions.push(tick.instructions);
        self.times.push(tick.time);
        if !matches!(self.progress, Progress::Going(_)) {
            self.after -= 1;
        }
        self.after > 0 && self.codes.len() < self.limit
    }

    fn fitted(&self) -> Fitted {
        self.fitted
    }

    fn scans(&mut self, inputs: [u16; 4]) -> [[u16; 4]; SCANS] {
        match &mut self.scanner {
            Some(scanner) => scanner(inputs),
            None => crate::world::spread(inputs),
        }
    }

    fn converts(&self) -> bool {
        self.resets > 0 || self.dead_from.is_none_or(|from| self.codes.len() < from)
    }

    fn overruns(&self) -> bool {
        self.lost_at == Some(self.codes.len())
    }

    fn stands(&self) -> Option<u64> {
        self.stands.filter(|&(update, _)| update == self.codes.len()).map(|(_, time)| time)
    }

    fn oscillator(&self) -> Oscillator {
        self.oscillator
    }

    fn watchdog_clock(&self) -> u64 {
        self.watchdog_clock
    }
}
