//! What passes between the loop and the desk. Every queue has one sender and one receiver and never blocks.

use heapless::spsc::{Consumer, Producer, Queue};
use shakedown_core::link::{Phase, Record, Setup, Trip};

/// Records of telemetry that wait for the desk: 128 ms at 1 kHz.
pub const RECORDS: usize = 129;
/// Points of the reference that wait for their tick: 1 s at 1 kHz.
pub const POINTS: usize = 1025;
/// Orders that wait for a tick.
pub const ORDERS: usize = 4;

/// What the desk tells the loop.
#[derive(Debug, Clone, PartialEq)]
#[allow(clippy::large_enum_variant, reason = "a queue without allocation holds its items whole")]
pub enum Order {
    /// Take this setup, which was validated whole.
    Setup(Setup),
    /// Close the relay and hold the table where it stands.
    Arm,
    /// Run the reference.
    Start,
    /// Ramp to a stand.
    Stop,
    /// Leave the trip.
    ClearTrip,
    /// Put this code on the output while the relay is open; none ends it.
    Probe(Option<u16>),
}

/// One tick for the desk to send.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Tick since the reset.
    pub tick: u32,
    /// Where the loop stood.
    pub phase: Phase,
    /// What it saw and did.
    pub record: Record,
}

/// The loop's standing, small enough to be one atomic word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Standing {
    /// Where it stands.
    pub phase: Phase,
    /// Why it tripped or stopped by itself.
    pub trip: Option<Trip>,
}

impl Standing {
    /// As one word: the phase in the low byte, one more than the trip in the next.
    pub const fn to_word(self) -> u32 {
        let trip = match self.trip {
            Some(trip) => trip as u32 + 1,
            None => 0,
        };
        self.phase as u32 | trip << 8
    }

    /// From the word that [`Self::to_word`] made; any other word reads as tripped.
    pub const fn from_word(word: u32) -> Self {
        let phase = match word & 0xFF {
            0 => Phase::Idle,
            1 => Phase::Armed,
            2 => Phase::Running,
            3 => Phase::Stopping,
            _ => Phase::Tripped,
        };
        let trip = match word >> 8 {
            0 => None,
            1 => Some(Trip::EmergencyStop),
            2 => Some(Trip::Overrun),
            3 => Some(Trip::Converter),
            4 => Some(Trip::Rail),
            5 => Some(Trip::Guard),
            6 => Some(Trip::Underrun),
            7 => Some(Trip::SupplyLow),
            _ => Some(Trip::Restarted),
        };
        Self { phase, trip }
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

    /// The displacement, m; none at the end of the record.
    pub fn displacement(self) -> Option<f32> {
        (!self.0.is_nan()).then_some(self.0)
    }
}

/// The memory of the three queues.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct Queues {
    orders: Queue<Order, ORDERS>,
    points: Queue<Point, POINTS>,
    records: Queue<Entry, RECORDS>,
}

/// The loop's ends.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct LoopEnd<'a> {
    /// What to do.
    pub orders: Consumer<'a, Order>,
    /// The streamed reference, m.
    pub points: Consumer<'a, Point>,
    /// Telemetry.
    pub records: Producer<'a, Entry>,
}

/// The desk's ends.
#[allow(missing_debug_implementations, reason = "the queues have none")]
pub struct DeskEnd<'a> {
    /// What the loop shall do.
    pub orders: Producer<'a, Order>,
    /// The streamed reference, m.
    pub points: Producer<'a, Point>,
    /// Telemetry.
    pub records: Consumer<'a, Entry>,
}

impl Default for Queues {
    fn default() -> Self {
        Self::new()
    }
}

impl Queues {
    /// Empty queues.
    pub const fn new() -> Self {
        Self { orders: Queue::new(), points: Queue::new(), records: Queue::new() }
    }

    /// The two sides.
    pub fn split(&mut self) -> (LoopEnd<'_>, DeskEnd<'_>) {
        let (give_orders, take_orders) = self.orders.split();
        let (give_points, take_points) = self.points.split();
        let (give_records, take_records) = self.records.split();
        (
            LoopEnd { orders: take_orders, points: take_points, records: give_records },
            DeskEnd { orders: give_orders, points: give_points, records: take_records },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_standing_survives_its_word() {
        use Phase::{Armed, Idle, Running, Stopping, Tripped};
        let trips = [
            Trip::EmergencyStop,
            Trip::Overrun,
            Trip::Converter,
            Trip::Rail,
            Trip::Guard,
            Trip::Underrun,
            Trip::SupplyLow,
            Trip::Restarted,
        ];
        for phase in [Idle, Armed, Running, Stopping, Tripped] {
            for trip in trips.map(Some).into_iter().chain([None]) {
                let standing = Standing { phase, trip };
                assert_eq!(Standing::from_word(standing.to_word()), standing);
            }
        }
    }
}
