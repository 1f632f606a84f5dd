//! Exchanges of settings that are refused because the state of one law means nothing to another, or because oil may flow; and what is
//! taken over at a stand.

use shakedown_core::blocks::math;
use shakedown_core::settings::{
    GuardSettings, InnerLoop, Modification, ObserverSettings, RampSettings, TrackingSettings,
};
use shakedown_core::{Controller, Mode, OperatorRequest, Relay, Sample, Settings, SettingsError, State};

/// The states in which oil may flow, that of the safe ramp among them.
const CLOSED: [State; 5] = [State::Ready, State::Running, State::Hold, State::RampDown, State::Tripped];

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
    for state in CLOSED {
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

/// What a modifier holds back, and what of a preview is in view, means nothing to another: the reference would step, or stop dead, and
/// stay where the table is not.
#[test]
fn another_modifier_is_taken_only_while_the_relay_is_open() {
    let of = |modification: Modification| Settings { modification, ..guarded() };
    let preview = |seconds: f32| of(Modification::Preview { seconds });
    let pairs = [
        (preview(0.4), preview(0.1)),
        (preview(0.4), of(Modification::Causal)),
        (of(Modification::Causal), of(Modification::Off)),
        (of(Modification::Causal), of(Modification::Clip)),
        (of(Modification::Clip), of(Modification::Off)),
        (of(Modification::Off), preview(0.1)),
    ];
    for (old, new) in pairs {
        for state in CLOSED {
            assert_eq!(refused(&mut in_state(&old, state), &new), Some("modification"), "{state:?}");
            assert_eq!(refused(&mut in_state(&old, state), &Settings { blend: 0.2, ..old }), None, "{state:?}");
        }
        assert_eq!(refused(&mut in_state(&old, State::Off), &new), None);
        let mut bare = Controller::new(&Settings { guard: None, ..old }).unwrap();
        assert_eq!(refused(&mut bare, &Settings { guard: None, ..new }), None);
        assert_eq!(refused(&mut bare, &Settings { guard: None, ..old }), None);
        rest(&mut bare, 0.0, 0.0, 1);
        assert_eq!(refused(&mut bare, &Settings { guard: None, ..new }), Some("modification"));
    }
}

/// A preview made shorter while off follows the reference to its end, with nothing of the old one between them.
#[test]
fn a_shorter_preview_ends_where_the_reference_does() {
    let of = |seconds: f32| Settings { modification: Modification::Preview { seconds }, ..guarded() };
    let mut controller = in_state(&of(0.4), State::Off);
    assert_eq!(refused(&mut controller, &of(0.1)), None);
    controller.request(OperatorRequest::Arm).unwrap();
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

/// Another law sees its first reference as a step, and differentiates it twice.
#[test]
fn another_law_is_taken_only_while_the_relay_is_open() {
    let tracking = Settings { tracking: Some(TrackingSettings::default()), ..guarded() };
    for state in CLOSED {
        assert_eq!(refused(&mut in_state(&guarded(), state), &tracking), Some("tracking"), "{state:?}");
        assert_eq!(refused(&mut in_state(&tracking, state), &guarded()), Some("tracking"), "{state:?}");
    }
    assert_eq!(refused(&mut in_state(&guarded(), State::Off), &tracking), None);
}
