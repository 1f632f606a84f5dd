use super::*;
use crate::defaults;
use crate::queues::{LoopEnd, Queues, Verdict};
use proptest::prelude::*;
use shakedown_core::link::{Assembler, MAX_POINTS};

fn seen(state: State) -> Seen {
    Seen { standing: Standing { state, cause: None }, ticks: 0, dropped: 0, cause: None }
}

fn with_desk(test: impl FnOnce(&mut Desk<'_>, &mut LoopEnd<'_>)) {
    let mut queues = Queues::new();
    let (mut loop_end, desk_end) = queues.split();
    test(&mut Desk::new(defaults::setup(), false, Clock::Crystal, defaults::LIMITS, 1, desk_end), &mut loop_end);
}

fn report(desk: &mut Desk<'_>, request: Request, state: State, now: u32) -> Report {
    match desk.take(request, seen(state), now) {
        Action::Send(report) => report,
        other => panic!("{other:?}"),
    }
}

fn challenge(desk: &mut Desk<'_>, now: u32) -> Challenge {
    match report(desk, Request::RequestArming, State::Off, now) {
        Report::Challenge(challenge) => challenge,
        other => panic!("{other:?}"),
    }
}

#[test]
fn arming_takes_the_answer_to_this_challenge_in_time_and_once() {
    with_desk(|desk, decide| {
        let refused = Report::Refused(RefusedBecause::Challenge);
        assert_eq!(report(desk, Request::Arm(7), State::Off, 0), refused);
        let first = challenge(desk, 0);
        assert_eq!(report(desk, Request::Arm(answer(first)), State::Off, CHALLENGE_LIFE), refused);
        let second = challenge(desk, 5000);
        assert_ne!(first, second);
        assert_eq!(report(desk, Request::Arm(answer(second) ^ 1), State::Off, 5001), refused);
        assert_eq!(report(desk, Request::Arm(answer(second)), State::Off, 5001), refused);
        let third = challenge(desk, 6000);
        // Each asking took a probe off the valve, and nothing else came of it.
        for _ in 0..3 {
            assert_eq!(decide.orders.dequeue(), Some(Order::Probe(None)));
        }
        assert_eq!(decide.orders.dequeue(), None);
        assert_eq!(report(desk, Request::Arm(answer(third)), State::Off, 6001), Report::Done);
        assert_eq!(decide.orders.dequeue(), Some(Order::Ask(Ask::Arm)));
    });
}

#[test]
fn wiring_and_rate_change_only_at_rest_and_nothing_is_taken_by_half() {
    with_desk(|desk, decide| {
        let mut other = defaults::setup();
        other.wiring.output.per_code *= 2.0;
        let running = Report::Refused(RefusedBecause::State(State::Running));
        assert_eq!(report(desk, Request::WriteSetup(other), State::Running, 0), running);
        other.control.guard = None;
        let bad = Report::Refused(RefusedBecause::Setup);
        assert_eq!(report(desk, Request::WriteSetup(other), State::Off, 0), bad);
        assert!(!decide.orders.ready());
        assert_eq!(report(desk, Request::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        let mut tuned = defaults::setup();
        tuned.control.displacement.proportional = 2.0;
        assert_eq!(desk.take(Request::WriteSetup(tuned), seen(State::Running), 0), Action::Wait);
        // One waits at a time, and what is not taken yet is not in force.
        let full = Report::Refused(RefusedBecause::Full);
        assert_eq!(report(desk, Request::WriteSetup(defaults::setup()), State::Running, 0), full);
        assert_eq!(report(desk, Request::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        assert_eq!(decide.orders.dequeue(), Some(Order::TakeSetup));
        assert!(decide.setups.dequeue().is_some());
        assert_eq!((decide.orders.dequeue(), desk.heed()), (None, None));
        decide.verdicts.enqueue(Verdict::Taken).unwrap();
        assert_eq!(desk.heed(), Some(Action::Send(Report::Done)));
        assert_eq!(report(desk, Request::ReadSetup, State::Off, 0), Report::Setup(tuned));
    });
}

/// What was published last may be old: the loop has the last word.
#[test]
fn a_setup_or_a_save_that_the_loop_refuses_changes_nothing() {
    with_desk(|desk, decide| {
        let mut other = defaults::setup();
        other.wiring.output.per_code *= 2.0;
        for request in [Request::WriteSetup(other), Request::Save] {
            assert_eq!(desk.take(request, seen(State::Tripped), 0), Action::Wait);
            assert!(desk.waits());
            decide.verdicts.enqueue(Verdict::Refused(State::Tripped)).unwrap();
            let refused = Report::Refused(RefusedBecause::State(State::Tripped));
            assert_eq!(desk.heed(), Some(Action::Send(refused)));
            assert!(!desk.waits());
            assert_eq!(report(desk, Request::ReadSetup, State::Off, 0), Report::Setup(defaults::setup()));
        }
    });
}

/// What the simulator takes at 20 kHz no board keeps up with: the desk says so, and how far it goes.
#[test]
fn a_rate_that_no_tick_keeps_up_with_is_refused_by_its_bound() {
    with_desk(|desk, decide| {
        let mut fast = defaults::setup();
        fast.control.rate = 20_000.0;
        let Report::Identity(who) = report(desk, Request::Identify, State::Off, 0) else { panic!("no identity") };
        let refused = Report::Refused(RefusedBecause::RateAbove(who.highest_rate));
        assert_eq!(report(desk, Request::WriteSetup(fast), State::Off, 0), refused);
        assert!(!decide.orders.ready() && !decide.setups.ready());
        fast.control.rate = who.highest_rate as f32;
        assert_eq!(desk.take(Request::WriteSetup(fast), seen(State::Off), 0), Action::Wait);
    });
}

#[test]
fn a_trip_is_not_cleared_while_its_cause_stands() {
    with_desk(|desk, decide| {
        let stands = Seen { cause: Some(Cause::EmergencyStop), ..seen(State::Tripped) };
        let refused = Report::Refused(RefusedBecause::CauseStands(Cause::EmergencyStop));
        assert_eq!(desk.take(Request::ClearTrip, stands, 0), Action::Send(refused));
        assert!(!decide.orders.ready());
        assert_eq!(report(desk, Request::ClearTrip, State::Tripped, 0), Report::Done);
    });
}

proptest! {
    /// Whatever is lost, repeated or sent in the wrong order, the loop gets the record's points in order, each once.
    #[test]
    fn points_arrive_in_order_and_once(frames in proptest::collection::vec((0..2000u32, 1..=MAX_POINTS), 1..60)) {
        with_desk(|desk, decide| {
            let mut wanted = 0;
            for (guess, length) in frames {
                let first = if guess % 3 == 0 { guess } else { wanted };
                let points = (first..first + length as u32).map(|index| index as f32).collect();
                let request = Request::Reference(Points { first, points, last: false });
                match report(desk, request, State::Running, 0) {
                    Report::Credit { next, .. } => wanted = next,
                    other => panic!("{other:?}"),
                }
            }
            let mut next = 0;
            while let Some(point) = decide.points.dequeue() {
                assert_eq!(point.displacement(), Some(next as f32));
                next += 1;
            }
            assert_eq!(next, wanted);
        });
    }

    /// Noise on the line moves nothing.
    #[test]
    fn noise_gives_no_order(noise in proptest::collection::vec(any::<u8>(), 0..4000)) {
        with_desk(|desk, decide| {
            let mut assembler = Assembler::new();
            for byte in noise {
                if let Some(Ok(request)) = assembler.push::<Request>(byte) {
                    let _ = desk.take(request, seen(State::Off), 0);
                }
            }
            assert!(!decide.orders.ready());
        });
    }
}
