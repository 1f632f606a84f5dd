//! What passes between the loop and the server. Every queue has one sender and one receiver and never blocks.

use heapless::spsc::{Consumer, Producer, Queue};
use shakedown_core::link::{Record, StopCause};
use shakedown_core::{OperatorRequest, State, Trip};

use crate::control_loop::{OpenRelay, Prepared};

/// Records of telemetry that wait for the server, one place less: 127 ms at 1 kHz. A power of two, like the others, so that
/// places are found by masking.
pub const RECORDS: usize = 128;
/// Points of the reference that wait for their tick, one place less: 1 s at 1 kHz.
pub const POINTS: usize = 1024;
/// Orders that wait for a tick.
pub const ORDERS: usize = 4;

/// What the server tells the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoopCommand {
    /// Take the setup that waits in the queue of setups, validated whole and worked out. There it needs room for one, and
    /// not for as many as there are orders.
    TakeSetup,
    /// Lend the proof of an open relay.
    Lend,
    /// Ask the core for this.
    Ask(OperatorRequest),
    /// The host has said nothing for as long as it may.
    HostSilent,
    /// Put this code on the output while the test is off; none ends it.
    Probe(Option<u16>),
}

/// What the loop says of an order that the server waits for.
#[derive(Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The setup is in force.
    Taken,
    /// It is not: the core refuses it.
    NotTaken,
    /// Not carried out: the relay is closed, in this state.
    Refused(State),
    /// The proof. No order is carried out before it is back.
    Lent(OpenRelay),
}

/// One tick for the server to send.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Tick since the reset.
    pub tick: u32,
    /// Where the test stood.
    pub state: State,
    /// What the loop saw and did.
    pub record: Record,
}

/// Where the test stands and why, small enough to be one atomic word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TestStatus {
    /// Where the test stands.
    pub state: State,
    /// Why it tripped, stopped by itself or did not arm, last.
    pub cause: Option<StopCause>,
}

const STATES: [State; 6] = [State::Off, State::Ready, State::Running, State::Hold, State::RampDown, State::Tripped];

/// In the order of their codes, from 1.
const TRIPS: [Trip; 17] = [
    Trip::Displacement,
    Trip::Velocity,
    Trip::Acceleration,
    Trip::Jerk,
    Trip::Force,
    Trip::Tracking,
    Trip::SensorLost,
    Trip::DisplacementStuck,
    Trip::AccelerationStuck,
    Trip::SensorsDisagree,
    Trip::DisplacementNoisy,
    Trip::AccelerationNoisy,
    Trip::ValveStuck,
    Trip::Internal,
    Trip::External,
    Trip::LimitSwitch,
    Trip::RelayAstray,
];

impl TestStatus {
    /// As one word: the state in the low byte, the cause in the next, the guard's trip in the third.
    #[inline]
    pub const fn to_word(self) -> u32 {
        let cause = match self.cause {
            None => 0,
            Some(StopCause::EmergencyStop) => 1,
            Some(StopCause::Overrun) => 2,
            Some(StopCause::Underrun) => 3,
            Some(StopCause::SupplyLow) => 4,
            Some(StopCause::Restarted) => 5,
            Some(StopCause::Asked) => 6,
            Some(StopCause::HostSilent) => 7,
            Some(StopCause::Guard(trip)) => 8 | (trip as u32) << 8,
        };
        self.state as u32 | cause << 8
    }

    /// From the word that [`Self::to_word`] made; any other word reads as tripped.
    pub fn from_word(word: u32) -> Self {
        let [state, cause, trip, _] = word.to_le_bytes();
        let state = STATES.get(usize::from(state)).copied().unwrap_or(State::Tripped);
        let trip = TRIPS.get(usize::from(trip).wrapping_sub(1)).copied().unwrap_or(Trip::Internal);
        let cause = match cause {
            0 => None,
            1 => Some(StopCause::EmergencyStop),
            2 => Some(StopCause::Overrun),
            3 => Some(StopCause::Underrun),
            4 => Some(StopCause::SupplyLow),
            5 => Some(StopCause::Restarted),
            6 => Some(StopCause::Asked),
            7 => Some(StopCause::HostSilent),
            _ => Some(StopCause::Guard(trip)),
        };
        Self { state, cause }
    }
}

/// A point of the streamed reference, or the end of the record, in one word.
#[derive(Debug, Clone, Copy)]
pub struct Point(f32);

impl Point {
    /// The end of the record.
    pub const END: Self = Self(f32::NAN);

    /// A finite displacement, m; none for what is no number.
    pub fn new(displacement: f32) -> Option<Self> {
        displacement.is_finite().then_some(Self(displacement))
    }

    /// The same of at most `farthest` (m) either way; none for what is beyond.
    pub fn within(displacement: f32, farthest: f32) -> Option<Self> {
        Self::new(displacement).filter(|_| displacement.abs() <= farthest)
    }

    /// The displacement, m; none at the end of the record.
    #[inline]
    pub fn displacement(self) -> Option<f32> {
        (!self.0.is_nan()).then_some(self.0)
    }
}

/// The memory of the queues.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct Queues {
    orders: Queue<LoopCommand, ORDERS>,
    setups: Queue<Prepared, 2>,
    points: Queue<Point, POINTS>,
    records: Queue<Entry, RECORDS>,
    verdicts: Queue<Verdict, 2>,
    returned: Queue<OpenRelay, 2>,
}

/// The loop's ends.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct LoopEnd<'a> {
    /// What to do.
    pub orders: Consumer<'a, LoopCommand>,
    /// What [`LoopCommand::TakeSetup`] is about.
    pub setups: Consumer<'a, Prepared>,
    /// The streamed reference, m.
    pub points: Consumer<'a, Point>,
    /// Telemetry.
    pub records: Producer<'a, Entry>,
    /// What came of [`LoopCommand::TakeSetup`] or [`LoopCommand::Lend`].
    pub verdicts: Producer<'a, Verdict>,
    /// The proof, back.
    pub returned: Consumer<'a, OpenRelay>,
}

/// The server's ends.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct ServerEnd<'a> {
    /// What the loop shall do.
    pub orders: Producer<'a, LoopCommand>,
    /// What [`LoopCommand::TakeSetup`] is about.
    pub setups: Producer<'a, Prepared>,
    /// The streamed reference, m.
    pub points: Producer<'a, Point>,
    /// Telemetry.
    pub records: Consumer<'a, Entry>,
    /// What came of [`LoopCommand::TakeSetup`] or [`LoopCommand::Lend`].
    pub verdicts: Consumer<'a, Verdict>,
    /// The proof, given back.
    pub returned: Producer<'a, OpenRelay>,
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}

impl Queues {
    /// Empty queues.
    pub const fn new() -> Self {
        Self {
            orders: Queue::new(),
            setups: Queue::new(),
            points: Queue::new(),
            records: Queue::new(),
            verdicts: Queue::new(),
            returned: Queue::new(),
        }
    }

    /// The two sides.
    pub fn split(&mut self) -> (LoopEnd<'_>, ServerEnd<'_>) {
        let (give_orders, orders) = self.orders.split();
        let (give_setups, setups) = self.setups.split();
        let (give_points, points) = self.points.split();
        let (records, take_records) = self.records.split();
        let (verdicts, take_verdicts) = self.verdicts.split();
        let (give_back, returned) = self.returned.split();
        (
            LoopEnd { orders, setups, points, records, verdicts, returned },
            ServerEnd {
                orders: give_orders,
                setups: give_setups,
                points: give_points,
                records: take_records,
                verdicts: take_verdicts,
                returned: give_back,
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standing_survives_its_word() {
        use StopCause::{Asked, EmergencyStop, HostSilent, Overrun, Restarted, SupplyLow, Underrun};
        let boards = [EmergencyStop, Overrun, Underrun, SupplyLow, Restarted, Asked, HostSilent];
        let causes = boards.into_iter().chain(TRIPS.map(StopCause::Guard)).map(Some).chain([None]);
        for (cause, state) in causes.flat_map(|cause| STATES.map(|state| (cause, state))) {
            let standing = TestStatus { state, cause };
            assert_eq!(TestStatus::from_word(standing.to_word()), standing);
        }
    }
}
