//! The server: takes requests off the link, answers them, and sends telemetry. It runs below the loop and may take its
//! time; what the loop hears of it is an order in a queue.

use shakedown_core::link::{
    Batch, Challenge, Clock, DeviceHealth, HostRequest, Identity, MAX_BATCH, Points, RefusedBecause, Report, Setup,
    StopCause, answer,
};
use shakedown_core::{OperatorRequest as Ask, State};

use crate::control_loop::OpenRelay;
use crate::limits::Limits;
use crate::queues::{LoopCommand, POINTS, Point, ServerEnd, TestStatus};

mod awaited;
mod lease;
use awaited::Awaited;

/// How long a challenge may be answered, ticks of the caller's millisecond clock.
const CHALLENGE_LIFE: u32 = 1000;

/// What the server wants done that only the board can do.
#[derive(Debug, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "lives on the stack for one call")]
pub enum Action {
    /// Send this report.
    Send(Report),
    /// Nothing yet: the answer is up to the loop, and [`LinkServer::heed`] has it after a tick. No request is taken before.
    Wait,
    /// Write [`LinkServer::setup`] to flash, then give the proof back to [`LinkServer::saved`].
    Save(OpenRelay),
    /// Send the option bytes that the board reads.
    TellOptions,
}

/// What the loop published last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LoopStatus {
    /// Where the loop stands.
    pub standing: TestStatus,
    /// Ticks since the reset.
    pub ticks: u32,
    /// Records that found no room.
    pub dropped: u32,
    /// A cause of a trip that stands on the board's inputs.
    pub cause: Option<StopCause>,
}

/// The server's own state.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct LinkServer<'a> {
    queues: ServerEnd<'a>,
    setup: Setup,
    stored: bool,
    clock: Clock,
    limits: Limits,
    entropy: u64,
    challenge: Option<(Challenge, u32)>,
    next_point: u32,
    credit_due: bool,
    told: Option<TestStatus>,
    garbled: u32,
    /// When the host was last heard, or its silence last told, in units of 16 ticks modulo 2^16.
    heard: u16,
    awaited: Option<Awaited>,
}

impl<'a> LinkServer<'a> {
    /// A server for a loop that runs `setup` on a board of these `limits`. `entropy` differs from reset to reset; `stored` says that
    /// the setup came from flash, `clock` what the ticks are counted by.
    pub const fn new(
        setup: Setup,
        stored: bool,
        clock: Clock,
        limits: Limits,
        entropy: u64,
        queues: ServerEnd<'a>,
    ) -> Self {
        Self {
            queues,
            setup,
            stored,
            clock,
            limits,
            entropy,
            challenge: None,
            next_point: 0,
            credit_due: false,
            told: None,
            garbled: 0,
            heard: 0,
            awaited: None,
        }
    }

    /// Counts a frame that came garbled.
    pub const fn count_garbled(&mut self) {
        self.garbled = self.garbled.wrapping_add(1);
    }

    /// The setup in force.
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// `ticks` as milliseconds, for challenges.
    pub fn milliseconds(&self, ticks: u32) -> u32 {
        (u64::from(ticks) * 1000 / u64::from((self.setup.control.rate as u32).max(1))) as u32
    }

    /// What to do about `request`; `now` is in ms.
    pub fn take(&mut self, request: HostRequest, seen: LoopStatus, now: u32) -> Action {
        let state = seen.standing.state;
        self.heard = lease::in_sixteens(seen.ticks);
        let report = match request {
            HostRequest::Identify => Report::Identity(self.identity()),
            HostRequest::ReadSetup => Report::Setup(self.setup),
            HostRequest::WriteSetup(_) | HostRequest::Save if self.waits() => Report::Refused(RefusedBecause::Full),
            HostRequest::WriteSetup(setup) => match self.write(&setup, state) {
                Ok(()) => return Action::Wait,
                Err(because) => Report::Refused(because),
            },
            HostRequest::Save if at_rest(state) => match self.order(LoopCommand::Lend) {
                Report::Done => {
                    self.awaited = Some(Awaited::Proof);
                    return Action::Wait;
                }
                full => full,
            },
            HostRequest::RequestArming => self.challenge(state, now),
            HostRequest::Arm(given) => self.arm(given, state, now),
            HostRequest::Start => self.ask(Ask::Start, state == State::Ready, state),
            HostRequest::Stop => self.ask(Ask::Stop, matches!(state, State::Running | State::Hold), state),
            HostRequest::Disarm => self.ask(Ask::Off, state == State::Ready, state),
            HostRequest::Trip => self.ask(Ask::Trip, true, state),
            HostRequest::ClearTrip => match seen.cause {
                Some(cause) => Report::Refused(RefusedBecause::CauseStands(cause)),
                None => self.ask(Ask::Reset, state == State::Tripped, state),
            },
            HostRequest::Reference(points) => self.reference(&points, state),
            HostRequest::Probe(code) if state == State::Off => self.order(LoopCommand::Probe(Some(code))),
            HostRequest::ReadVitals => Report::Vitals(self.vitals(seen)),
            HostRequest::ReadOptions => return Action::TellOptions,
            HostRequest::Save | HostRequest::Probe(_) => Report::Refused(RefusedBecause::State(state)),
        };
        Action::Send(report)
    }

    /// What the server has to say of its own accord: a change of state, room in the reference buffer, telemetry.
    pub fn volunteer(&mut self, seen: LoopStatus) -> Option<Report> {
        self.keep_lease(seen);
        if self.told != Some(seen.standing) {
            let first = self.told.is_none();
            self.told = Some(seen.standing);
            if !first {
                return Some(Report::Vitals(self.vitals(seen)));
            }
        }
        if self.credit_due && self.room() >= POINTS / 4 {
            self.credit_due = false;
            return Some(self.credit());
        }
        self.telemetry(seen.dropped)
    }

    fn identity(&self) -> Identity {
        Identity {
            firmware: version(),
            full_scale: self.limits.full_scale,
            buffer: POINTS as u16 - 1,
            clock: self.clock,
            highest_rate: self.limits.highest_rate,
        }
    }

    fn vitals(&self, seen: LoopStatus) -> DeviceHealth {
        DeviceHealth {
            state: seen.standing.state,
            cause: seen.standing.cause,
            ticks: seen.ticks,
            dropped: seen.dropped,
            garbled: self.garbled,
            stored: self.stored,
            buffered: self.queues.points.len() as u16,
        }
    }

    fn order(&mut self, order: LoopCommand) -> Report {
        match self.queues.orders.enqueue(order) {
            Ok(()) => Report::Done,
            Err(_) => Report::Refused(RefusedBecause::Full),
        }
    }

    fn ask(&mut self, request: Ask, applies: bool, state: State) -> Report {
        if applies { self.order(LoopCommand::Ask(request)) } else { Report::Refused(RefusedBecause::State(state)) }
    }

    fn challenge(&mut self, state: State, now: u32) -> Report {
        if state != State::Off {
            return Report::Refused(RefusedBecause::State(state));
        }
        // Who asks to arm is done with probing: the valve is back at zero flow before any oil comes.
        if self.queues.orders.enqueue(LoopCommand::Probe(None)).is_err() {
            return Report::Refused(RefusedBecause::Full);
        }
        self.entropy = self.entropy.wrapping_add(1);
        let challenge = Challenge(answer(Challenge(self.entropy)) ^ u64::from(now));
        self.challenge = Some((challenge, now));
        Report::Challenge(challenge)
    }

    fn arm(&mut self, given: u64, state: State, now: u32) -> Report {
        match self.challenge.take() {
            Some((challenge, asked)) if answer(challenge) == given && now.wrapping_sub(asked) < CHALLENGE_LIFE => {
                self.next_point = 0;
                self.ask(Ask::Arm, state == State::Off, state)
            }
            _ => Report::Refused(RefusedBecause::Challenge),
        }
    }

    fn room(&self) -> usize {
        POINTS - 1 - self.queues.points.len()
    }

    fn credit(&self) -> Report {
        Report::Credit { next: self.next_point, room: self.room().saturating_sub(1) as u16 }
    }

    /// Takes all of the points or none, and says either way which is wanted next and how many there is room for. One place stays free for the end of the record.
    fn reference(&mut self, points: &Points, state: State) -> Report {
        if !matches!(state, State::Ready | State::Running) {
            return Report::Refused(RefusedBecause::State(state));
        }
        if points.first != self.next_point {
            return self.credit();
        }
        if points.points.len() >= self.room() {
            self.credit_due = true;
            return self.credit();
        }
        // What the gate would not believe is not begun with: nothing would come after it that it could believe.
        let farthest = self.setup.control.ranges.reference;
        if points.points.iter().any(|&point| Point::within(point, farthest).is_none()) {
            return Report::Refused(RefusedBecause::Setup);
        }
        for point in points.points.iter().filter_map(|&point| Point::within(point, farthest)) {
            let _ = self.queues.points.enqueue(point);
        }
        if points.last {
            let _ = self.queues.points.enqueue(Point::END);
        }
        self.next_point = self.next_point.wrapping_add(points.points.len() as u32);
        self.credit_due = !points.last;
        self.credit()
    }

    /// A batch of consecutive records, when enough wait.
    fn telemetry(&mut self, dropped: u32) -> Option<Report> {
        let every = self.setup.telemetry_every;
        if self.queues.records.len() < MAX_BATCH {
            return None;
        }
        let first = *self.queues.records.peek()?;
        let mut batch = Batch { first: first.tick, every, state: first.state, dropped, records: heapless::Vec::new() };
        let mut tick = first.tick;
        while let Some(entry) = self.queues.records.peek().copied() {
            if entry.tick != tick || entry.state != first.state || batch.records.push(entry.record).is_err() {
                break;
            }
            self.queues.records.dequeue();
            tick = tick.wrapping_add(u32::from(every));
        }
        Some(Report::Telemetry(batch))
    }
}

const fn at_rest(state: State) -> bool {
    matches!(state, State::Off | State::Tripped)
}

/// The crate's version; its three numbers are single bytes.
const fn version() -> [u8; 3] {
    [
        number(env!("CARGO_PKG_VERSION_MAJOR")),
        number(env!("CARGO_PKG_VERSION_MINOR")),
        number(env!("CARGO_PKG_VERSION_PATCH")),
    ]
}

const fn number(digits: &str) -> u8 {
    match u8::from_str_radix(digits, 10) {
        Ok(number) => number,
        Err(_) => u8::MAX,
    }
}

#[cfg(test)]
mod tests;
