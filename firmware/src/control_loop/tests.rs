use super::*;
use crate::defaults;
use crate::queues::{DeskEnd, Order, Point, Queues};

const REST: [u16; 4] = [2048; 4];

fn with_loop(test: impl FnOnce(&mut Loop<'_>, &mut DeskEnd<'_>)) {
    let mut queues = Queues::new();
    let (loop_end, mut desk) = queues.split();
    let mut setup = defaults::setup();
    if let Some(guard) = &mut setup.control.guard {
        guard.ramps.test = 0.0;
    }
    test(&mut Loop::new(&setup, loop_end, false).unwrap(), &mut desk);
}

fn ask(desk: &mut DeskEnd<'_>, request: Request) {
    desk.orders.enqueue(Order::Ask(request)).unwrap();
}

fn tick(decide: &mut Loop<'_>, events: Events) -> Outcome {
    decide.tick_with(Codes::of(|input| REST[input]), events)
}

/// Armed and started, with `points` to run.
fn running(decide: &mut Loop<'_>, desk: &mut DeskEnd<'_>, points: usize) {
    // Nothing is armed before the sensors were read once.
    tick(decide, Events::default());
    ask(desk, Request::Arm);
    tick(decide, Events::default());
    ask(desk, Request::Start);
    for _ in 0..points {
        desk.points.enqueue(Point::new(0.0).unwrap()).unwrap();
    }
    tick(decide, Events::default());
    assert_eq!(decide.standing(), Standing { state: State::Running, cause: None });
}

#[test]
fn a_restart_begins_tripped_and_only_a_reset_clears_it() {
    let mut queues = Queues::new();
    let (loop_end, mut desk) = queues.split();
    let setup = defaults::setup();
    let mut decide = Loop::new(&setup, loop_end, true).unwrap();
    let tripped = Standing { state: State::Tripped, cause: Some(Cause::Restarted) };
    for request in [Request::Arm, Request::Start, Request::Off] {
        ask(&mut desk, request);
        tick(&mut decide, Events::default());
        assert!(!decide.relay());
        assert_eq!(decide.standing(), tripped);
    }
    ask(&mut desk, Request::Reset);
    tick(&mut decide, Events::default());
    assert_eq!(decide.standing(), Standing { state: State::Off, cause: None });
}

#[test]
fn what_only_the_board_sees_trips_with_its_own_cause_and_opens_the_relay_after_the_safe_ramp() {
    let all = [
        (Events { emergency_stop: true, ..Events::default() }, Cause::EmergencyStop),
        (Events { supply_low: true, ..Events::default() }, Cause::SupplyLow),
    ];
    for (events, cause) in all {
        with_loop(|decide, desk| {
            running(decide, desk, 10);
            tick(decide, events);
            assert_eq!(decide.standing(), Standing { state: State::Tripped, cause: Some(cause) });
            let opened = (1..200).find(|_| {
                tick(decide, Events::default());
                !decide.relay()
            });
            assert!(opened.is_some_and(|ticks| ticks <= 51), "{opened:?}");
            assert_eq!(tick(decide, Events::default()).output, 2048);
        });
    }
}

#[test]
fn a_tick_that_takes_too_long_trips_with_its_own_cause() {
    with_loop(|decide, desk| {
        running(decide, desk, 10);
        decide.overrun();
        assert!(tick(decide, Events::default()).news && decide.news().tell);
        assert_eq!(decide.standing(), Standing { state: State::Tripped, cause: Some(Cause::Overrun) });
    });
}

#[test]
fn no_samples_for_ten_milliseconds_trip() {
    with_loop(|decide, desk| {
        running(decide, desk, 100);
        let lost = Events { no_sample: true, ..Events::default() };
        let ticks = (1..50).find(|_| {
            tick(decide, lost);
            decide.standing().state == State::Tripped
        });
        assert!(ticks.is_some_and(|ticks| ticks <= 12), "{ticks:?}");
        assert_eq!(decide.standing().cause, Some(Cause::Guard(Trip::SensorLost)));
    });
}

#[test]
fn a_stream_that_runs_dry_fades_the_test_out_and_says_so() {
    with_loop(|decide, desk| {
        running(decide, desk, 3);
        for _ in 0..10 {
            tick(decide, Events::default());
        }
        assert_eq!(decide.standing(), Standing { state: State::Ready, cause: Some(Cause::Underrun) });
    });
}

#[test]
fn a_stream_that_ends_fades_the_test_out_in_order() {
    with_loop(|decide, desk| {
        running(decide, desk, 3);
        desk.points.enqueue(Point::END).unwrap();
        for _ in 0..10 {
            tick(decide, Events::default());
        }
        assert_eq!(decide.standing(), Standing { state: State::Ready, cause: None });
    });
}

#[test]
fn a_full_queue_drops_records_and_counts_them() {
    with_loop(|decide, desk| {
        for _ in 0..200 {
            tick(decide, Events::default());
        }
        let (ticks, dropped) = decide.counts();
        let mut kept = 0;
        while desk.records.dequeue().is_some() {
            kept += 1;
        }
        assert_eq!((ticks, kept + dropped), (200, 200));
        assert!(dropped > 0);
    });
}

#[test]
fn a_probe_acts_only_while_off() {
    with_loop(|decide, desk| {
        desk.orders.enqueue(Order::Probe(Some(3000))).unwrap();
        assert_eq!(tick(decide, Events::default()).output, 3000);
        ask(desk, Request::Arm);
        assert_ne!(tick(decide, Events::default()).output, 3000);
    });
}
