use super::*;
use crate::defaults;
use crate::queues::{LoopCommand, Point, Queues, ServerEnd};

const REST: [u16; 4] = [32768; 4];

fn with_loop(test: impl FnOnce(&mut ControlLoop<'_>, &mut ServerEnd<'_>)) {
    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let mut setup = defaults::setup();
    if let Some(guard) = &mut setup.control.guard {
        guard.ramps.test = 0.0;
    }
    test(&mut ControlLoop::new(&setup, loop_end, false).unwrap(), &mut server);
}

fn ask(server: &mut ServerEnd<'_>, request: OperatorRequest) {
    server.orders.enqueue(LoopCommand::Ask(request)).unwrap();
}

fn tick(decide: &mut ControlLoop<'_>, events: Events) -> Outcome {
    decide.tick_with(Codes::of(|input| REST[input]), events)
}

/// Armed and started, with `points` to run.
fn running(decide: &mut ControlLoop<'_>, server: &mut ServerEnd<'_>, points: usize) {
    // Nothing is armed before the sensors were read once.
    tick(decide, Events::default());
    ask(server, OperatorRequest::Arm);
    tick(decide, Events::default());
    ask(server, OperatorRequest::Start);
    for _ in 0..points {
        server.points.enqueue(Point::new(0.0).unwrap()).unwrap();
    }
    tick(decide, Events::default());
    assert_eq!(decide.standing(), TestStatus { state: State::Running, cause: None });
}

#[test]
fn a_restart_begins_tripped_and_only_a_reset_clears_it() {
    let mut queues = Queues::new();
    let (loop_end, mut server) = queues.split();
    let setup = defaults::setup();
    let mut decide = ControlLoop::new(&setup, loop_end, true).unwrap();
    let tripped = TestStatus { state: State::Tripped, cause: Some(StopCause::Restarted) };
    for request in [OperatorRequest::Arm, OperatorRequest::Start, OperatorRequest::Off] {
        ask(&mut server, request);
        tick(&mut decide, Events::default());
        assert!(!decide.relay());
        assert_eq!(decide.standing(), tripped);
    }
    ask(&mut server, OperatorRequest::Reset);
    tick(&mut decide, Events::default());
    assert_eq!(decide.standing(), TestStatus { state: State::Off, cause: None });
}

#[test]
fn what_only_the_board_sees_trips_with_its_own_cause_and_opens_the_relay_after_the_safe_ramp() {
    let all = [
        (Events { emergency_stop: true, ..Events::default() }, StopCause::EmergencyStop),
        (Events { supply_low: true, ..Events::default() }, StopCause::SupplyLow),
    ];
    for (events, cause) in all {
        with_loop(|decide, server| {
            running(decide, server, 10);
            tick(decide, events);
            assert_eq!(decide.standing(), TestStatus { state: State::Tripped, cause: Some(cause) });
            let opened = (1..200).find(|_| {
                tick(decide, Events::default());
                !decide.relay()
            });
            assert!(opened.is_some_and(|ticks| ticks <= 51), "{opened:?}");
            assert_eq!(tick(decide, Events::default()).output, 32768);
        });
    }
}

#[test]
fn a_tick_that_takes_too_long_trips_with_its_own_cause() {
    with_loop(|decide, server| {
        running(decide, server, 10);
        decide.overrun();
        assert!(tick(decide, Events::default()).news && decide.news().tell);
        assert_eq!(decide.standing(), TestStatus { state: State::Tripped, cause: Some(StopCause::Overrun) });
    });
}

#[test]
fn no_samples_for_ten_milliseconds_trip() {
    with_loop(|decide, server| {
        running(decide, server, 100);
        let lost = Events { no_sample: true, ..Events::default() };
        let ticks = (1..50).find(|_| {
            tick(decide, lost);
            decide.standing().state == State::Tripped
        });
        assert!(ticks.is_some_and(|ticks| ticks <= 12), "{ticks:?}");
        assert_eq!(decide.standing().cause, Some(StopCause::Guard(Trip::SensorLost)));
    });
}

#[test]
fn a_stream_that_runs_dry_fades_the_test_out_and_says_so() {
    with_loop(|decide, server| {
        running(decide, server, 3);
        for _ in 0..10 {
            tick(decide, Events::default());
        }
        assert_eq!(decide.standing(), TestStatus { state: State::Ready, cause: Some(StopCause::Underrun) });
    });
}

/// A test whose host is silent fades out, then the device is disarmed; the cause says why both times.
#[test]
fn a_silent_host_ends_its_test_and_then_disarms() {
    with_loop(|decide, server| {
        running(decide, server, 100);
        for state in [State::Ready, State::Off, State::Off] {
            server.orders.enqueue(LoopCommand::HostSilent).unwrap();
            (0..10).for_each(|_| _ = tick(decide, Events::default()));
            assert_eq!(decide.standing(), TestStatus { state, cause: Some(StopCause::HostSilent) });
        }
        assert!(!decide.relay());
    });
}

#[test]
fn a_stream_that_ends_fades_the_test_out_in_order() {
    with_loop(|decide, server| {
        running(decide, server, 3);
        server.points.enqueue(Point::END).unwrap();
        for _ in 0..10 {
            tick(decide, Events::default());
        }
        assert_eq!(decide.standing(), TestStatus { state: State::Ready, cause: None });
    });
}

#[test]
fn a_full_queue_drops_records_and_counts_them() {
    with_loop(|decide, server| {
        for _ in 0..200 {
            tick(decide, Events::default());
        }
        let (ticks, dropped) = decide.counts();
        let mut kept = 0;
        while server.records.dequeue().is_some() {
            kept += 1;
        }
        assert_eq!((ticks, kept + dropped), (200, 200));
        assert!(dropped > 0);
    });
}

#[test]
fn a_probe_acts_only_while_off() {
    with_loop(|decide, server| {
        server.orders.enqueue(LoopCommand::Probe(Some(3000))).unwrap();
        assert_eq!(tick(decide, Events::default()).output, 3000);
        ask(server, OperatorRequest::Arm);
        assert_ne!(tick(decide, Events::default()).output, 3000);
    });
}
