//! Answers that come later than the patience with them.

use super::step::Step;
use super::{DeviceHealth, HostRequest, Points, RefusedBecause, Report, State, TestRunner};

const fn refused(state: State) -> Report {
    Report::Refused(RefusedBecause::State(state))
}

/// Takes a run as far as its start.
fn started(mut run: TestRunner) -> TestRunner {
    let health = |state| {
        let (cause, ticks, dropped, garbled, stored, buffered) = (None, 1, 0, 0, true, 0);
        Report::Vitals(DeviceHealth { state, cause, ticks, dropped, garbled, stored, buffered })
    };
    run.step = Step::Vitals;
    for report in [health(State::Tripped), Report::Done] {
        run.take(report);
    }
    // The trip was cleared twice.
    run.take(refused(State::Off));
    run.take(health(State::Off));
    assert_eq!(run.step, Step::Challenge);
    run.take(health(State::Ready));
    // It was armed twice.
    run.take(refused(State::Ready));
    if run.step == Step::Fill {
        run.take(Report::Credit { next: 4, room: 100 });
    }
    assert_eq!(run.step, Step::Start);
    run.take(Report::Done);
    run
}

/// A device that answers an order later than the patience with it gets the order twice, and refuses it the second time.
#[test]
fn an_order_that_was_given_twice_ends_no_run() {
    for mut run in [started(TestRunner::new(None, vec![0.0; 4])), started(TestRunner::attended(None, 10))] {
        let step = run.step;
        run.take(refused(State::Running));
        assert_eq!((run.step, &run.failed), (step, &None));
        run.go(Step::Stop);
        run.take(Report::Done);
        run.take(refused(State::Ready));
        assert_eq!((run.step, &run.failed), (Step::Stand, &None));
    }
}

/// What no order before it explains is a refusal.
#[test]
fn a_device_that_lost_its_state_ends_the_run() {
    let mut run = started(TestRunner::attended(None, 10));
    run.take(refused(State::Off));
    assert!(run.failed.is_some());
}

/// The end of a record that was sent whole before the start is not sent again: it would end the next.
#[test]
fn a_short_record_has_one_end() {
    let mut run = TestRunner::new(None, vec![0.0; 4]);
    run.go(Step::Fill);
    run.take(Report::Credit { next: 0, room: 100 });
    let last = |run: &TestRunner| match run.request() {
        Some(HostRequest::Reference(Points { points, last, .. })) => (points.len(), last),
        other => panic!("{other:?}"),
    };
    assert_eq!(last(&run), (4, true));
    run.take(Report::Credit { next: 4, room: 100 });
    run.take(Report::Done);
    assert_eq!((run.step, last(&run)), (Step::Stream, (0, false)));
}

/// A device that is armed already counts its points from an arming that is not this run's.
#[test]
fn a_device_that_is_armed_is_disarmed_before_a_record() {
    let health = |state| {
        let (cause, ticks, dropped, garbled, stored, buffered) = (None, 1, 0, 0, true, 0);
        Report::Vitals(DeviceHealth { state, cause, ticks, dropped, garbled, stored, buffered })
    };
    let mut run = TestRunner::new(None, vec![0.0; 4]);
    run.go(Step::Vitals);
    run.take(health(State::Ready));
    assert_eq!((run.step, run.request()), (Step::Release, Some(HostRequest::Disarm)));
    run.take(Report::Done);
    run.take(health(State::Off));
    assert_eq!(run.step, Step::Challenge);
}
