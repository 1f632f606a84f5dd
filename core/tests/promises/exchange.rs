//! Exchanges of settings that are refused because the state of one law means nothing to another, or because oil may flow; and what is
//! taken over at a stand.

use shakedown_core::blocks::math;
use shakedown_core::settings::{
    GuardSettings, InnerLoop, Modification, ObserverSettings, RampSettings, TrackingSettings,
};
use shakedown_core::{Controller, Mode, OperatorRequest, Relay, Sample, Settings, SettingsError, State};

fn guarded() -> Settings {
    let ramps = RampSettings { test: 0.2, ..RampSettings::default() };
    let guard = Some(GuardSettings { ramps, ..GuardSettings::default() });
    Settings { guard, observer: ObserverSettings { accelerometer: false, ..Default::default() }, ..Settings::default() }
}

/// Some ticks of a table at rest at `at` (m) under a reference at rest at `reference` (m); the last command.
fn rest(controller: &mut Controller, reference: f32, at: f32, ticks: u32) -> f32 {
    (0..ticks)
        .map(|_| controller.step(&Sample { external: at, ..Sample::new(reference, at, 0.0) }).valve)
        .last()
        .unwrap()
}

/// A controller in this state, its table at rest in the middle.
fn in_state(settings: &Settings, state: State) -> Controller {
    let mut controller = Controller::new(settings).unwrap();
    rest(&mut controller, 0.0, 0.0, 20);
    let requests: &[OperatorRequest] = match state {
        State::Off => &[],
        State::Ready => &[OperatorRequest::Arm],
        State::Running => &[OperatorRequest::Arm, OperatorRequest::Start],
        State::Hold => &[OperatorRequest::Arm, OperatorRequest::Start, OperatorRequest::Hold],
        State::RampDown => &[OperatorRequest::Arm, OperatorRequest::Start, OperatorRequest::Stop],
        State::Tripped => &[OperatorRequest::Arm, OperatorRequest::Trip],
    };
    for request in requests {
        controller.request(*request).unwrap();
        if *request == OperatorRequest::Start {
            rest(&mut controller, 0.0, 0.0, 100);
        }
    }
    assert_eq!(controller.state(), state);
    controller
}

fn refused(controller: &mut Controller, settings: &Settings) -> Option<&'static str> {
    match controller.retune(settings) {
        Ok(()) => None,
        Err(SettingsError::Contradiction { field, .. }) => Some(field),
        Err(other) => panic!("{other}"),
    }
}

/// What says what the output is wired to: in the safe ramp another zero would step the valve, and in motion another mode would take the
/// table to a reference that it never saw.
#[test]
fn mode_and_inner_loop_change_only_while_the_relay_is_open() {
    let old = guarded();
    let guard = Settings { mode: Mode::Guard, ..old };
    let modifier = Settings { mode: Mode::Modifier, ..old };
    let hardwired = Settings { inner_loop: InnerLoop::Hardwired, ..old };
    for state in [State::Ready, State::Running, State::Hold, State::RampDown, State::Tripped] {
        for (new, field) in [(guard, "mode"), (modifier, "mode"), (hardwired, "inner_loop")] {
            let mut controller = in_state(&old, state);
            assert_eq!(controller.relay(), Relay::Closed);
            assert_eq!(refused(&mut controller, &new), Some(field), "{state:?}");
            // Gains are another matter.
            assert_eq!(refused(&mut controller, &Settings { blend: 0.2, ..old }), None, "{state:?}");
        }
    }
    for new in [guard, modifier, hardwired] {
        assert_eq!(refused(&mut in_state(&old, State::Off), &new), None);
    }
}

/// The state of a preview is as long as its delay: another one would leave what was in view between reference and table for ever.
#[test]
fn a_preview_keeps_its_delay_while_a_test_is_under_way() {
    let of = |seconds: f32| Settings { modification: Modification::Preview { seconds }, ..guarded() };
    let causal = Settings { modification: Modification::Causal, ..guarded() };
    for state in [State::Running, State::Hold, State::RampDown] {
        for new in [of(0.1), causal] {
            let field = Some("modification.preview.seconds");
            assert_eq!(refused(&mut in_state(&of(0.4), state), &new), field, "{state:?}");
        }
        assert_eq!(refused(&mut in_state(&of(0.4), state), &Settings { blend: 0.2, ..of(0.4) }), None);
    }
    // At a stand it is exchanged, and what follows the reference again ends where the reference does.
    let mut controller = in_state(&of(0.4), State::Ready);
    assert_eq!(refused(&mut controller, &of(0.1)), None);
    controller.request(OperatorRequest::Start).unwrap();
    let mut command = controller.step(&Sample::default());
    for k in 0..20_000 {
        let reference = 0.03 * math::sin(k.min(1571) as f32 * 2e-3);
        command = controller.step(&Sample::new(reference, command.reference, 0.0));
        if k == 1000 {
            assert!((command.reference - reference).abs() > 1e-4, "nothing moved");
        }
    }
    assert_eq!(controller.state(), State::Running, "{:?}", controller.trip());
    let rest = 0.03 * math::sin(1571.0 * 2e-3);
    assert!((command.reference - rest).abs() < 1e-6, "{} for {rest}", command.reference);
}

/// Another law is not switched on in motion; at a stand, with the table millimetres from its reference, it begins without a kick. One that
/// takes the reference to have come there in one step differentiates that twice.
#[test]
fn another_law_begins_at_a_stand_and_without_a_kick() {
    let tracking = Settings { tracking: Some(TrackingSettings::default()), ..guarded() };
    for state in [State::Running, State::Hold, State::RampDown] {
        assert_eq!(refused(&mut in_state(&guarded(), state), &tracking), Some("tracking"), "{state:?}");
        assert_eq!(refused(&mut in_state(&tracking, state), &guarded()), Some("tracking"), "{state:?}");
    }
    let felt = |settings: Settings| Settings { observer: ObserverSettings::default(), ..settings };
    let mut controller = in_state(&felt(guarded()), State::Ready);
    (0..=200).for_each(|k| _ = rest(&mut controller, 0.0, -2e-5 * k as f32, 1));
    let mut last = rest(&mut controller, 0.0, -0.004, 10);
    assert!((last - 3.7 * 0.004).abs() < 1e-3, "{last}: {:?}", controller.trip());
    assert_eq!(refused(&mut controller, &felt(tracking)), None);
    let (mut x, mut v, mut a, mut steepest) = (-0.004, 0.0, 0.0, 0.0_f32);
    for _ in 0..500 {
        let now = controller.step(&Sample::new(0.0, x, a)).valve;
        steepest = steepest.max((now - last).abs());
        last = now;
        // The valve's gain and lag of the settings.
        a = (2.39 * now - v) / 0.0173;
        v += 1e-3 * a;
        x += 1e-3 * v;
    }
    assert_eq!(controller.state(), State::Ready, "{:?}", controller.trip());
    // What is left of the old command pushes the table, and the feedback holds against it by 2 mm of command a tick; a kick is 600.
    assert!(steepest < 4e-3, "{steepest}");
    assert!(x.abs() < 5e-4, "{x}");
}
