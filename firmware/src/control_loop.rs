//! One tick: codes in, the core's decision, a code out.
//!
//! What the valve gets is decided by [`Controller::step`] alone, and so are the state of the test, the safe ramp and the
//! relay. This file turns codes into the core's units and back, feeds it the reference, and passes on what only the
//! board can see.

use shakedown_core::link::{MAX_BATCH, Setup, StopCause};
use shakedown_core::{Controller, OperatorRequest, Relay, Sample, SettingsError, State, Trip};
use shakedown_rehearsal::{Behind, Rehearsal};

mod housekeeping;
mod open_relay;
mod orders;
mod outcome;
mod prepared;
mod rehearsed;
mod stream;

pub use open_relay::OpenRelay;
pub use outcome::{Codes, Events, Notifications, Outcome};
pub use prepared::Prepared;

use crate::input_scaling::InputScaling;
use crate::output::ZeroFlow;
use crate::queues::{LoopEnd, TestStatus};

/// Most ticks after which the board is given something to do even when there is no news, to tell the others and to feed its
/// watchdog: as many as a frame of telemetry has records. And the longest time, s, well within the watchdog's.
const ROUND: u8 = MAX_BATCH as u8;
const ROUND_TIME: f32 = 0.016;

/// Everything that decides the output.
#[allow(missing_debug_implementations, reason = "the queues have none")]
// In this order, so that all that a tick touches lies within reach of one base register.
#[repr(C)]
pub struct ControlLoop<'a> {
    wires: InputScaling,
    queues: LoopEnd<'a>,
    /// Ticks until there is something to do beside the output, and how many there will have been then. So an ordinary tick
    /// counts down, and everything that is due now and then shares one question.
    left: u32,
    due: u32,
    /// Reference of the last tick, m.
    reference: f32,
    /// The core's count of changes when the standing was last told; none of its counts after a change of the cause.
    told: u16,
    /// What the board, the stream or a refusal has to say beside the core.
    cause: Option<StopCause>,
    /// The tick of the next record.
    record_at: u32,
    dropped: u32,
    news: Notifications,
    /// Whether points of a streamed reference are still taken, and whether those that are left are of a record that was broken off.
    flows: bool,
    broken_off: bool,
    probe: Option<u16>,
    /// Whether the proof of an open relay is lent: no order is carried out meanwhile.
    lent: bool,
    /// Ticks of a round.
    round: u8,
    /// A record of telemetry every so many ticks.
    every: u16,
    /// By how much a streamed reference moved in the last tick, m.
    step: f32,
    controller: Controller,
    /// Control rate, Hz.
    rate: f32,
    zero_flow: ZeroFlow,
    /// The table that a rehearsal moves.
    rehearsal: Rehearsal,
}

/// Ticks of a round at `rate`, Hz.
fn round(rate: f32) -> u8 {
    ((rate * ROUND_TIME) as u8).clamp(1, ROUND)
}

impl<'a> ControlLoop<'a> {
    /// A loop under `setup`. `restarted` when the last reset was none that anyone asked for: it begins tripped.
    pub fn new(setup: &Setup, queues: LoopEnd<'a>, restarted: bool) -> Result<Self, SettingsError> {
        let mut new = Self::wired(setup, queues);
        new.begin(setup, restarted)?;
        Ok(new)
    }

    /// A loop wired as `setup` says that decides nothing before [`Self::begin`]: the half of [`Self::new`] that needs little
    /// stack.
    pub fn wired(setup: &Setup, queues: LoopEnd<'a>) -> Self {
        Self {
            controller: Controller::inert(),
            wires: InputScaling::new(setup),
            queues,
            left: 1,
            due: 1,
            reference: 0.0,
            told: u16::MAX,
            cause: None,
            record_at: 0,
            dropped: 0,
            news: Notifications::default(),
            flows: true,
            broken_off: false,
            probe: None,
            lent: false,
            round: round(setup.control.rate),
            every: setup.telemetry_every,
            step: 0.0,
            rate: setup.control.rate,
            zero_flow: ZeroFlow::new(setup),
            rehearsal: Rehearsal::new(setup.control.rate, Behind::of(&setup.control)),
        }
    }

    /// The other half: works out the control of the same `setup`, in place.
    #[inline(never)]
    pub fn begin(&mut self, setup: &Setup, restarted: bool) -> Result<(), SettingsError> {
        self.controller.retune(&setup.control)?;
        if restarted {
            let _ = self.controller.request(OperatorRequest::Trip);
            self.cause = Some(StopCause::Restarted);
        }
        Ok(())
    }

    /// Where the test stands and why.
    #[inline]
    pub const fn standing(&self) -> TestStatus {
        let cause = match self.controller.trip() {
            None | Some(Trip::External) => self.cause,
            Some(trip) => Some(StopCause::Guard(trip)),
        };
        TestStatus { state: self.controller.state(), cause }
    }

    /// Ticks so far, and records that found no room.
    #[inline]
    pub const fn counts(&self) -> (u32, u32) {
        (self.due.wrapping_sub(self.left), self.dropped)
    }

    /// What the last tick left to do beside the output, where its outcome says that it did.
    pub const fn news(&self) -> Notifications {
        self.news
    }

    /// Whether the relay of the hydraulic block is closed. Never in a rehearsal: whatever table is wired to the board gets no oil.
    pub fn relay(&self) -> bool {
        self.controller.relay() == Relay::Closed && !self.lent && !self.wires.rehearses
    }

    /// The control rate in force, Hz.
    pub const fn rate(&self) -> f32 {
        self.rate
    }

    /// What a program that fails is to leave on the output, under the setup in force.
    pub const fn zero_flow(&self) -> ZeroFlow {
        self.zero_flow
    }

    /// One tick. `input` gives the codes of reference, displacement, acceleration and existing command by number.
    pub fn tick(&mut self, input: impl Fn(usize) -> u16) -> Outcome {
        self.tick_with(Codes::of(input), Events::default())
    }

    /// One tick, and whatever the board has noticed.
    pub fn tick_with(&mut self, inputs: Codes, events: Events) -> Outcome {
        let new_setup = (self.lent || self.queues.orders.ready()) && self.apply_commands();
        if events.emergency_stop {
            self.trip(StopCause::EmergencyStop);
        } else if events.supply_low {
            self.trip(StopCause::SupplyLow);
        }
        let inputs = if self.wires.rehearses { self.rehearsed_codes() } else { inputs };
        let mut sample = self.sample(inputs.each());
        if events.no_sample {
            let reference = if self.wires.streamed { sample.reference } else { f32::NAN };
            sample = Sample { external: f32::NAN, ..Sample::new(reference, f32::NAN, f32::NAN) };
        }
        let outcome = self.decide(inputs, sample, new_setup);
        if self.wires.rehearses { self.rehearse(outcome) } else { outcome }
    }

    /// What the core decides, and what is due beside it: now and then in the middle of a test, and at every tick else.
    fn decide(&mut self, inputs: Codes, sample: Sample, new_setup: bool) -> Outcome {
        self.reference = sample.reference;
        let command = self.controller.step(&sample);
        self.left = self.left.wrapping_sub(1);
        let changed = u16::from(self.controller.changes()) != self.told;
        if self.left != 0 && !changed && !new_setup && command.status.state == State::Running {
            return Outcome { output: self.wires.output.code(command.valve), news: false };
        }
        self.housekeeping(inputs, &command, new_setup)
    }

    /// Codes in SI; an input that tells nothing is no number, and the core knows what to do about that.
    #[inline]
    fn sample(&mut self, inputs: [u16; 4]) -> Sample {
        let [reference, displacement, acceleration, external] = inputs;
        let wires = &self.wires;
        let mut sample = Sample {
            displacement: wires.read(wires.displacement, displacement),
            acceleration: wires.read(wires.acceleration, acceleration),
            ..Sample::default()
        };
        if wires.guards {
            sample.external = wires.read(wires.external, external);
        }
        sample.reference = if wires.streamed { self.next_point() } else { wires.read(wires.reference, reference) };
        sample
    }

    /// Keeps what the board, the stream or a refusal has to say, and has it told.
    fn attribute_trip(&mut self, cause: Option<StopCause>) {
        self.cause = cause;
        self.told = u16::MAX;
    }

    /// The tick that has just ended took too long: the next one has come already, and finds the test tripped.
    #[cold]
    #[inline(never)]
    pub fn overrun(&mut self) {
        self.trip(StopCause::Overrun);
    }

    fn trip(&mut self, cause: StopCause) {
        if self.controller.state() != State::Tripped {
            self.attribute_trip(Some(cause));
            let _ = self.controller.request(OperatorRequest::Trip);
        }
    }
}

#[cfg(test)]
mod interleavings;
#[cfg(test)]
mod tests;
