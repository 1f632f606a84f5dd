//! Wiring and modes: the hard-wired loop cancels, what passes through passes unchanged, and no change makes a bump.

use proptest::prelude::*;
use shakedown_core::settings::{EnvelopeSettings, Gains, GuardSettings, InnerLoop, InputSettings, ValveSettings};
use shakedown_core::{Controller, Mode, Modification, OperatorRequest, Sample, Settings};

use crate::table::Table;

/// Fig. 2, first verification: from an offset the table tracks a zero reference with no steady error. Gives its last
/// displacement, m.
fn settled(controller_knows: InnerLoop, null_bias: f32) -> f64 {
    let settings = Settings {
        displacement: Gains::new(5.0, 0.0),
        inner_loop: controller_knows,
        valve: ValveSettings { null_bias, ..ValveSettings::default() },
        ..Settings::default()
    };
    let mut controller = Controller::new(&settings).unwrap();
    let mut table = Table::new(1000.0).at(0.1);
    table.hardwired = true;
    for _ in 0..5000 {
        let sample = table.sample(0.05);
        table.advance(f64::from(controller.step(&sample).valve));
    }
    table.x
}

#[test]
fn the_hardwired_loop_cancels() {
    assert!((settled(InnerLoop::Hardwired, 0.0) - 0.05).abs() < 1e-4);
    // Without the cancellation the inner loop pulls toward zero: 5 (0.05 - x) = x.
    assert!((settled(InnerLoop::Absent, 0.0) - 5.0 / 6.0 * 0.05).abs() < 1e-4);
}

#[test]
fn inner_and_outer_loop_give_the_same_response() {
    // Second verification: a bare valve under our law, and a hard-wired loop that our law cancels.
    let (mut bare, mut wired) = (Table::new(1000.0), Table::new(1000.0));
    wired.hardwired = true;
    let settings = Settings { displacement: Gains::new(3.7, 0.6), ..Settings::default() };
    let mut plain = Controller::new(&settings).unwrap();
    let mut cancelling = Controller::new(&Settings { inner_loop: InnerLoop::Hardwired, ..settings }).unwrap();
    let mut apart = 0.0_f64;
    for k in 0..10_000 {
        let t = f64::from(k) * 1e-3;
        let reference = 0.08 * (4.0 * t).sin() * (0.7 * t).sin();
        let (a, b) = (bare.sample(reference), wired.sample(reference));
        bare.advance(f64::from(plain.step(&a).valve));
        wired.advance(f64::from(cancelling.step(&b).valve));
        apart = apart.max((bare.x - wired.x).abs());
    }
    // Between ticks the inner loop sees the LVDT move and ours does not: 0.242 m/s for half a tick is 0.12 mm of command.
    assert!(apart < 3e-4, "{apart}");
}

proptest! {
    #[test]
    fn guard_mode_without_a_guard_passes_the_command_on(external in -9.0..9.0f32, x in -0.12..0.12f32, hardwired: bool) {
        let inner_loop = if hardwired { InnerLoop::Hardwired } else { InnerLoop::Absent };
        let settings = Settings { mode: Mode::Guard, inner_loop, ..Settings::default() };
        let mut controller = Controller::new(&settings).unwrap();
        let sample = Sample { external, displacement: x, ..Sample::default() };
        prop_assert_eq!(controller.step(&sample).valve, external);
    }

    #[test]
    fn modifier_mode_hands_on_the_modified_reference(references in proptest::collection::vec(-0.1..0.1f32, 1..100), x in -0.1..0.1f32) {
        let settings = Settings { mode: Mode::Modifier, modification: Modification::Causal, ..Settings::default() };
        let mut controller = Controller::new(&settings).unwrap();
        for reference in references {
            let command = controller.step(&Sample::new(reference, x, 0.0));
            prop_assert_eq!(command.valve, command.reference);
        }
    }

    #[test]
    fn a_change_of_settings_makes_no_bump(
        before in (1.0..10.0f32, 0.0..2.0f32), after in (1.0..10.0f32, 0.0..2.0f32),
        error in -0.02..0.02f32, mode in 0..3_usize, hardwired: bool,
    ) {
        let inner_loop = if hardwired { InnerLoop::Hardwired } else { InnerLoop::Absent };
        let old = Settings { displacement: Gains::new(before.0, before.1), inner_loop, ..Settings::default() };
        let mode = [Mode::Controller, Mode::Guard, Mode::Modifier][mode];
        let new = Settings { displacement: Gains::new(after.0, after.1), mode, ..old };
        let steepest = steepest_step(&old, &new, error);
        // The jump that would have been, at most: both outputs are within 0.6 m here. Blended over 100 ticks by the
        // smooth step, whose steepest slope is 1.5.
        prop_assert!(steepest < 1.5 * 0.6 / 100.0 + 1e-4, "{steepest}");
    }
}

/// The largest step of the output in the second after a change of settings, at a constant error.
fn steepest_step(old: &Settings, new: &Settings, error: f32) -> f32 {
    let mut controller = Controller::new(old).unwrap();
    let sample = Sample { external: 0.1, ..Sample::new(0.05 + error, 0.05, 0.0) };
    let mut last = 0.0;
    for _ in 0..100 {
        last = controller.step(&sample).valve;
    }
    controller.retune(new).unwrap();
    let mut steepest = 0.0_f32;
    for _ in 0..1000 {
        let now = controller.step(&sample).valve;
        steepest = steepest.max((now - last).abs());
        last = now;
    }
    steepest
}

#[test]
fn a_change_without_blending_would_be_seen() {
    let old = Settings { displacement: Gains::new(1.0, 0.0), ..Settings::default() };
    let new = Settings { displacement: Gains::new(10.0, 0.0), ..old };
    assert!(steepest_step(&old, &new, 0.02) < 0.004);
    assert!(steepest_step(&old, &Settings { blend: 0.0, ..new }, 0.02) > 0.05);
}

#[test]
fn settings_that_do_not_hold_leave_the_running_law_alone() {
    let mut changed = Controller::new(&Settings::default()).unwrap();
    let mut left = Controller::new(&Settings::default()).unwrap();
    let sample = Sample::new(0.03, 0.01, 0.0);
    changed.step(&sample);
    left.step(&sample);
    assert!(changed.retune(&Settings { rate: f32::NAN, ..Settings::default() }).is_err());
    assert_eq!(changed.step(&sample), left.step(&sample));
}

/// An observer that a change of settings turns on begins where the table is: away from zero it makes no velocity.
#[test]
fn an_observer_turned_on_away_from_zero_makes_no_velocity() {
    let plain = Settings { displacement: Gains::new(1.0, 0.0), blend: 0.0, ..Settings::default() };
    let mut controller = Controller::new(&plain).unwrap();
    controller.step(&Sample::default());
    let at = Sample::new(0.1, 0.1, 0.0);
    (0..100).for_each(|_| {
        controller.step(&at);
    });
    controller.retune(&Settings { velocity: Gains::new(1.0, 0.0), ..plain }).unwrap();
    // The velocity loop is an integral of the velocity error: any false velocity would stay in the command.
    for _ in 0..1000 {
        let command = controller.step(&at);
        assert!(command.valve.abs() < 1e-6, "{}", command.valve);
    }
}

/// A reference that asks for all of the stroke is led to where a table can still be stopped that brakes as the reference does, at 1 m/s2: for
/// v up to 0.242 m/s, max(v latency + v^2 / (2 deceleration) - v^2 / 2) beyond it and one and a half margins are left, in closed form.
#[test]
fn a_modified_reference_comes_as_far_as_the_guard_lets_it() {
    for (latency, deceleration) in [(0.05, 5.0), (0.1, 10.0), (0.05, 20.0), (0.2, 5.0)] {
        let envelope = EnvelopeSettings {
            stopping_latency: latency as f32,
            stopping_deceleration: deceleration as f32,
            ..EnvelopeSettings::default()
        };
        let guard = GuardSettings { envelope, ..GuardSettings::default() };
        let modified = Settings { modification: Modification::Causal, mode: Mode::Modifier, ..Settings::default() };
        let settings = Settings { guard: Some(guard), ..modified };
        let mut controller = Controller::new(&settings).unwrap();
        controller.step(&Sample::default());
        controller.request(OperatorRequest::Arm).unwrap();
        controller.request(OperatorRequest::Start).unwrap();
        // The table is where its reference was a tick ago.
        let (mut farthest, mut ways) = (0.0_f32, [0.0_f32; 3]);
        for _ in 0..6000 {
            let acceleration = (ways[0] - 2.0 * ways[1] + ways[2]) * 1e6;
            let command = controller.step(&Sample::new(0.3, ways[0], acceleration));
            assert_eq!(command.status.trip, None);
            ways = [command.reference, ways[0], ways[1]];
            farthest = farthest.max(command.reference);
        }
        let needed = |v: f64| v * latency + v * v * (0.5 / deceleration - 0.5);
        let most = (0..=242).map(|v| needed(1e-3 * f64::from(v))).fold(0.0, f64::max);
        let wall = 0.12 - 1.5 * 0.005 - most;
        assert!((f64::from(farthest) - wall).abs() < 5e-5, "{latency} s, {deceleration} m/s2: {farthest} m for {wall}");
    }
}

/// A second displacement sensor is read where the settings name one, and missed nowhere else.
#[test]
fn a_second_displacement_sensor_is_missed_where_it_is_fitted() {
    for second_displacement in [None, Some(0.01)] {
        let inputs = InputSettings { second_displacement, ..InputSettings::default() };
        let guard = GuardSettings { inputs, ..GuardSettings::default() };
        let settings = Settings { guard: Some(guard), ..Settings::default() };
        let mut controller = Controller::new(&settings).unwrap();
        let missing = controller.step(&Sample { second_displacement: f32::NAN, ..Sample::default() }).status.missing;
        assert_eq!(!missing.is_empty(), second_displacement.is_some());
    }
}
