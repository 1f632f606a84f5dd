use super::*;
use crate::defaults;
use crate::queues::{LoopEnd, Queues, Verdict};
use proptest::prelude::*;
use shakedown_core::Mode;
use shakedown_core::link::{Assembler, MAX_POINTS};
use shakedown_core::settings::InnerLoop;

fn seen(state: State) -> LoopStatus {
    LoopStatus { standing: TestStatus { state, cause: None }, ticks: 0, dropped: 0, cause: None }
}

fn with_server(test: impl FnOnce(&mut LinkServer<'_>, &mut LoopEnd<'_>)) {
    let mut queues = Queues::new();
    let (mut loop_end, server_end) = queues.split();
    test(
        &mut LinkServer::new(defaults::setup(), false, Clock::Crystal, defaults::LIMITS, 1, server_end),
        &mut loop_end,
    );
}

fn report(server: &mut LinkServer<'_>, request: HostRequest, state: State, now: u32) -> Report {
    match server.take(request, seen(state), now) {
        Action::Send(report) => report,
        other => panic!("{other:?}"),
    }
}

fn challenge(server: &mut LinkServer<'_>, now: u32) -> Challenge {
    match report(server, HostRequest::RequestArming, State::Off, now) {
        Report::Challenge(challenge) => challenge,
        other => panic!("{other:?}"),
    }
}

#[test]
fn arming_takes_the_answer_to_this_challenge_in_time_and_once() {
    with_server(|server, decide| {
        let refused = Report::Refused(RefusedBecause::Challenge);
        assert_eq!(report(server, HostRequest::Arm(7), State::Off, 0), refused);
        let first = challenge(server, 0);
        assert_eq!(report(server, HostRequest::Arm(answer(first)), State::Off, CHALLENGE_LIFE), refused);
        let second = challenge(server, 5000);
        assert_ne!(first, second);
        assert_eq!(report(server, HostRequest::Arm(answer(second) ^ 1), State::Off, 5001), refused);
        assert_eq!(report(server, HostRequest::Arm(answer(second)), State::Off, 5001), refused);
        let third = challenge(server, 6000);
        // Each asking took a probe off the valve, and nothing else came of it.
        for _ in 0..3 {
            assert_eq!(decide.orders.dequeue(), Some(LoopCommand::Probe(None)));
        }
        assert_eq!(decide.orders.dequeue(), None);
        assert_eq!(report(server, HostRequest::Arm(answer(third)), State::Off, 6001), Report::Done);
        assert_eq!(decide.orders.dequeue(), Some(LoopCommand::Ask(Ask::Arm)));
    });
}

#[test]
fn wiring_and_rate_change_only_at_rest_and_nothing_is_taken_by_half() {
    with_server(|server, decide| {
        let mut other = defaults::setup();
        other.wiring.output.per_code *= 2.0;
        let running = Report::Refused(RefusedBecause::State(State::Running));
        assert_eq!(report(server, HostRequest::WriteSetup(other), State::Running, 0), running);
        other.control.guard = None;
        let bad = Report::Refused(RefusedBecause::Setup);
        assert_eq!(report(server, HostRequest::WriteSetup(other), State::Off, 0), bad);
        assert!(!decide.orders.ready());
        assert_eq!(report(server, HostRequest::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        let mut tuned = defaults::setup();
        tuned.control.displacement.proportional = 2.0;
        assert_eq!(server.take(HostRequest::WriteSetup(tuned), seen(State::Running), 0), Action::Wait);
        // One waits at a time, and what is not taken yet is not in force.
        let full = Report::Refused(RefusedBecause::Full);
        assert_eq!(report(server, HostRequest::WriteSetup(defaults::setup()), State::Running, 0), full);
        assert_eq!(report(server, HostRequest::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        assert_eq!(decide.orders.dequeue(), Some(LoopCommand::TakeSetup));
        assert!(decide.setups.dequeue().is_some());
        assert_eq!((decide.orders.dequeue(), server.heed()), (None, None));
        decide.verdicts.enqueue(Verdict::Taken).unwrap();
        assert_eq!(server.heed(), Some(Action::Send(Report::Done)));
        assert_eq!(report(server, HostRequest::ReadSetup, State::Off, 0), Report::Setup(tuned));
    });
}

/// What was published last may be old: the loop has the last word.
#[test]
fn a_setup_or_a_save_that_the_loop_refuses_changes_nothing() {
    with_server(|server, decide| {
        let mut other = defaults::setup();
        other.wiring.output.per_code *= 2.0;
        for request in [HostRequest::WriteSetup(other), HostRequest::Save] {
            assert_eq!(server.take(request, seen(State::Tripped), 0), Action::Wait);
            assert!(server.waits());
            decide.verdicts.enqueue(Verdict::Refused(State::Tripped)).unwrap();
            let refused = Report::Refused(RefusedBecause::State(State::Tripped));
            assert_eq!(server.heed(), Some(Action::Send(refused)));
            assert!(!server.waits());
            assert_eq!(report(server, HostRequest::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        }
    });
}

/// What the simulator takes at 20 kHz no board keeps up with: the server says so, and how far it goes.
#[test]
fn a_rate_that_no_tick_keeps_up_with_is_refused_by_its_bound() {
    with_server(|server, decide| {
        let mut fast = defaults::setup();
        fast.control.rate = 20_000.0;
        let Report::Identity(who) = report(server, HostRequest::Identify, State::Off, 0) else { panic!("no identity") };
        let refused = Report::Refused(RefusedBecause::RateAbove(who.highest_rate));
        assert_eq!(report(server, HostRequest::WriteSetup(fast), State::Off, 0), refused);
        assert!(!decide.orders.ready() && !decide.setups.ready());
        fast.control.rate = who.highest_rate as f32;
        assert_eq!(server.take(HostRequest::WriteSetup(fast), seen(State::Off), 0), Action::Wait);
    });
}

#[test]
fn a_trip_is_not_cleared_while_its_cause_stands() {
    with_server(|server, decide| {
        let stands = LoopStatus { cause: Some(StopCause::EmergencyStop), ..seen(State::Tripped) };
        let refused = Report::Refused(RefusedBecause::CauseStands(StopCause::EmergencyStop));
        assert_eq!(server.take(HostRequest::ClearTrip, stands, 0), Action::Send(refused));
        assert!(!decide.orders.ready());
        assert_eq!(report(server, HostRequest::ClearTrip, State::Tripped, 0), Report::Done);
    });
}

/// A point that the gate would not believe trips the test and leaves a device that cannot be armed: it is refused, with its frame.
#[test]
fn a_point_beyond_what_is_believed_is_refused() {
    with_server(|server, decide| {
        let farthest = defaults::setup().control.ranges.reference;
        let frame = |last: f32| {
            let points = [0.0, last].into_iter().collect();
            HostRequest::Reference(Points { first: 0, points, last: false })
        };
        for beyond in [1.001 * farthest, -1.001 * farthest, f32::NAN, f32::INFINITY] {
            let refused = Report::Refused(RefusedBecause::Setup);
            assert_eq!(report(server, frame(beyond), State::Ready, 0), refused, "{beyond}");
            assert!(!decide.points.ready());
        }
        assert!(matches!(report(server, frame(-farthest), State::Ready, 0), Report::Credit { next: 2, .. }));
    });
}

/// What says what the output is wired to is wiring.
#[test]
fn mode_and_inner_loop_change_only_at_rest() {
    with_server(|server, _| {
        let (mut guard, mut hardwired) = (defaults::setup(), defaults::setup());
        guard.control.mode = Mode::Guard;
        hardwired.control.inner_loop = InnerLoop::Hardwired;
        for other in [guard, hardwired] {
            let running = Report::Refused(RefusedBecause::State(State::Running));
            assert_eq!(report(server, HostRequest::WriteSetup(other), State::Running, 0), running);
        }
        assert_eq!(server.take(HostRequest::WriteSetup(guard), seen(State::Off), 0), Action::Wait);
    });
}

proptest! {
    /// Whatever is lost, repeated or sent in the wrong order, the loop gets the record's points in order, each once.
    #[test]
    fn points_arrive_in_order_and_once(frames in proptest::collection::vec((0..2000u32, 1..=MAX_POINTS), 1..60)) {
        with_server(|server, decide| {
            let mut wanted = 0;
            for (guess, length) in frames {
                let first = if guess % 3 == 0 { guess } else { wanted };
                let points = (first..first + length as u32).map(|index| index as f32 * 1e-6).collect();
                let request = HostRequest::Reference(Points { first, points, last: false });
                match report(server, request, State::Running, 0) {
                    Report::Credit { next, .. } => wanted = next,
                    other => panic!("{other:?}"),
                }
            }
            let mut next = 0;
            while let Some(point) = decide.points.dequeue() {
                assert_eq!(point.displacement(), Some(next as f32 * 1e-6));
                next += 1;
            }
            assert_eq!(next, wanted);
        });
    }

    /// Noise on the line moves nothing.
    #[test]
    fn noise_gives_no_order(noise in proptest::collection::vec(any::<u8>(), 0..4000)) {
        with_server(|server, decide| {
            let mut assembler = Assembler::new();
            for byte in noise {
                if let Some(Ok(request)) = assembler.push::<HostRequest>(byte) {
                    let _ = server.take(request, seen(State::Off), 0);
                }
            }
            assert!(!decide.orders.ready());
        });
    }
}

/// A host that is silent for longer than its lease is missed while the device is armed, again and again until it is not; one that speaks
/// in time is not, nor is any where none is asked for.
#[test]
fn a_silent_host_is_missed_while_the_device_is_armed() {
    let missed = |lease_ms: u16, state: State, says_every: u32| {
        let mut queues = Queues::new();
        let (mut loop_end, server_end) = queues.split();
        let setup = Setup { lease_ms, ..defaults::setup() };
        let mut server = LinkServer::new(setup, false, Clock::Crystal, defaults::LIMITS, 1, server_end);
        let mut missed = 0;
        // Across the end of the count of ticks.
        for tick in 0..10_000 {
            let ticks = 0_u32.wrapping_sub(5000).wrapping_add(tick);
            let seen = LoopStatus { ticks, ..seen(state) };
            if tick % says_every == 0 {
                server.take(HostRequest::ReadVitals, seen, server.milliseconds(ticks));
            }
            server.volunteer(seen);
            while let Some(order) = loop_end.orders.dequeue() {
                assert_eq!(order, LoopCommand::HostSilent);
                missed += 1;
            }
        }
        missed
    };
    for state in [State::Ready, State::Running, State::Hold] {
        assert_eq!(missed(2000, state, u32::MAX), 4, "{state:?}");
        assert_eq!((missed(2000, state, 2000), missed(0, state, u32::MAX)), (0, 0), "{state:?}");
    }
    for state in [State::Off, State::RampDown, State::Tripped] {
        assert_eq!(missed(2000, state, u32::MAX), 0, "{state:?}");
    }
}

/// A host may be silent for less than half a second.
#[test]
fn a_lease_that_no_host_keeps_is_refused() {
    let lease = |lease_ms| Setup { lease_ms, ..defaults::setup() }.validate();
    assert_eq!([0, 500, u16::MAX].map(lease), [Ok(()); 3]);
    assert_eq!([1, 499].map(lease), [1, 499].map(|given| Err(shakedown_core::link::SetupError::Lease { given })));
}
