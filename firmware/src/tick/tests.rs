use super::*;
use crate::defaults;
use crate::queues::{LoopCommand, Queues, ServerEnd};
use shakedown_core::link::StopCause;
use shakedown_core::{OperatorRequest, State, Trip};

/// Converters whose readings, and whose failures, are a test's.
struct Pair {
    codes: [u16; 4],
    reads: bool,
    writes: bool,
    written: u16,
    recovered: u32,
}

impl Converters for Pair {
    type Error = ();
    const FULL_SCALE: u16 = defaults::LIMITS.full_scale;

    fn read(&mut self) -> Result<Codes, ()> {
        if self.reads { Ok(self.codes.into()) } else { Err(()) }
    }

    fn write(&mut self, code: u16) -> Result<(), ()> {
        self.written = code;
        if self.writes { Ok(()) } else { Err(()) }
    }

    fn recover(&mut self) {
        self.recovered += 1;
    }
}

struct Bench {
    pair: Pair,
    stop: bool,
    low: bool,
    late: bool,
    relay: bool,
    fed: u32,
    told: Option<TestStatus>,
}

impl Board for Bench {
    type Pair = Pair;

    fn pair(&mut self) -> &mut Pair {
        &mut self.pair
    }

    fn emergency_stop(&self) -> bool {
        self.stop
    }

    fn supply_low(&self) -> bool {
        self.low
    }

    fn set_relay(&mut self, closed: bool) {
        self.relay = closed;
    }

    fn late(&self) -> bool {
        self.late
    }

    fn feed_watchdog(&mut self) {
        self.fed += 1;
    }

    fn take_setup(&mut self, _: u32, _: ZeroFlow) {}

    fn tell(&mut self, standing: TestStatus, _: u32, _: u32) {
        self.told = Some(standing);
    }
}

/// An armed device after 100 ticks; `spoil` breaks something, and 200 ticks later the standing and the board are judged.
fn after(spoil: impl FnOnce(&mut Bench), judge: impl FnOnce(TestStatus, &Bench)) {
    let mut queues = Queues::new();
    let (loop_end, mut server): (_, ServerEnd<'_>) = queues.split();
    let mut decide = ControlLoop::new(&defaults::setup(), loop_end, false).unwrap();
    let pair = Pair { codes: [32768; 4], reads: true, writes: true, written: 0, recovered: 0 };
    let board = Bench { pair, stop: false, low: false, late: false, relay: false, fed: 0, told: None };
    let mut control = Control::new(&mut decide, board);
    for tick in 0..100 {
        if tick == 50 {
            server.orders.enqueue(LoopCommand::Ask(OperatorRequest::Arm)).unwrap();
        }
        control.tick();
    }
    assert!(control.board.relay && control.board.told.is_some_and(|told| told.state == State::Ready), "not armed");
    spoil(&mut control.board);
    for _ in 0..200 {
        control.tick();
    }
    let fed = control.board.fed;
    judge(control.decide.standing(), &control.board);
    assert!(fed > 0, "the watchdog was never fed");
}

fn trips(spoil: impl FnOnce(&mut Bench), cause: StopCause) {
    after(spoil, |standing, board| {
        assert_eq!((standing, board.relay), (TestStatus { state: State::Tripped, cause: Some(cause) }, false));
        assert_eq!(board.told, Some(standing));
    });
}

#[test]
fn a_board_on_which_all_is_well_stays_armed() {
    after(
        |_| {},
        |standing, board| {
            assert_eq!(
                (standing.state, board.relay, board.pair.written, board.pair.recovered),
                (State::Ready, true, 32768, 0)
            );
        },
    );
}

#[test]
fn whatever_a_board_notices_opens_its_relay() {
    trips(|board| board.stop = true, StopCause::EmergencyStop);
    trips(|board| board.low = true, StopCause::SupplyLow);
    trips(|board| board.late = true, StopCause::Overrun);
}

#[test]
fn converters_that_fail_are_set_up_again_and_trip_in_the_end() {
    trips(|board| board.pair.reads = false, StopCause::Guard(Trip::SensorLost));
    trips(|board| board.pair.writes = false, StopCause::Guard(Trip::SensorLost));
    after(|board| board.pair.reads = false, |_, board| assert_eq!(board.pair.recovered, 200));
}
