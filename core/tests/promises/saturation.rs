//! Velocity saturation is seen when it is there, at whatever limit it is, and not when it is not.

use proptest::prelude::*;
use shakedown_core::blocks::control::Blocked;
use shakedown_core::blocks::guard::{Detector, Evidence};
use shakedown_core::settings::{Detection, Gains, InnerLoop};
use shakedown_core::{Controller, Mode, Modification, Sample, Settings};

use crate::table::Table;

/// How a run went.
#[derive(Debug, Default)]
struct Run {
    /// Ticks for which the table had stood at its limit for 30 ms, and those of them that were reported.
    saturated: u32,
    seen: u32,
    /// Ticks reported while the table was below 90 % of its limit.
    invented: u32,
    /// The estimate at the end, m/s.
    limit: f32,
    /// Fastest true speed, m/s.
    fastest: f64,
}

fn settings() -> Settings {
    Settings { displacement: Gains::new(10.0, 1.0), saturation: Some(Detection::default()), ..Settings::default() }
}

/// Drives `table` along a sine for 6 s.
fn sine(settings: &Settings, mut table: Table, amplitude: f64, frequency: f64) -> Run {
    let mut controller = Controller::new(settings).unwrap();
    let mut run = Run::default();
    let mut at_limit = 0;
    // In guard and modifier mode an existing proportional controller closes the loop, of the same gain.
    let existing = f64::from(settings.displacement.proportional);
    for k in 0..6000 {
        let reference = amplitude * (std::f64::consts::TAU * frequency * f64::from(k) * 1e-3).sin();
        let mut sample = table.sample(reference);
        if settings.mode == Mode::Guard {
            sample.external = (existing * (reference - f64::from(sample.displacement))) as f32;
        }
        let command = controller.step(&sample);
        let valve = match settings.mode {
            Mode::Modifier => existing * (f64::from(command.valve) - f64::from(sample.displacement)),
            _ => f64::from(command.valve),
        };
        let limit = if table.v > 0.0 { table.limits.0 } else { table.limits.1 };
        at_limit = if table.v.abs() >= 0.999 * limit { at_limit + 1 } else { 0 };
        if at_limit > 30 {
            run.saturated += 1;
            run.seen += u32::from(command.status.saturated);
        }
        run.invented += u32::from(command.status.saturated && table.v.abs() < 0.9 * limit);
        run.limit = command.status.velocity_limit;
        run.fastest = run.fastest.max(table.v.abs());
        table.advance(valve);
    }
    run
}

const MODES: [Mode; 3] = [Mode::Controller, Mode::Guard, Mode::Modifier];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// However the loop lags that follows the reference: ours, or one whose command is not ours to see.
    #[test]
    fn a_table_below_its_limit_is_never_held_to_be_at_it(
        frequency in 0.1..5.0f64, speed in 0.01..0.15f64, kp in 3.0..10.0f32, mode in 0..3_usize,
    ) {
        let mode = MODES[mode];
        let settings = Settings { displacement: Gains::new(kp, 1.0), mode, ..settings() };
        let run = sine(&settings, Table::new(1000.0).noisy(), speed / (std::f64::consts::TAU * frequency), frequency);
        prop_assume!(run.fastest < 0.8 * 0.242);
        prop_assert_eq!(run.invented, 0);
        prop_assert!(run.limit > 0.98 * 0.242, "{}", run.limit);
    }

    #[test]
    fn a_table_at_its_limit_is_seen_whatever_the_limit_is(
        frequency in 0.4..2.0f64, excess in 2.0..4.0f64, share in 0.6..1.0f64, mode in 0..3_usize,
    ) {
        let mode = MODES[mode];
        let limit = 0.242 * share;
        let mut table = Table::new(1000.0).noisy();
        table.limits = (limit, limit);
        let amplitude = excess * limit / (std::f64::consts::TAU * frequency);
        let settings = Settings { mode, stroke: 1.0, ..settings() };
        let run = sine(&settings, table, amplitude, frequency);
        prop_assert!(run.saturated > 500);
        prop_assert!(f64::from(run.seen) > 0.85 * f64::from(run.saturated), "{run:?}");
        prop_assert!(f64::from(run.invented) < 0.05 * f64::from(run.saturated), "{run:?}");
        prop_assert!((f64::from(run.limit) - limit).abs() < 0.08 * limit, "{run:?} at {limit}");
    }
}

/// Swings that the accelerometer's noise alone lifts over the plateau: what an existing loop asks for is learned in few turns, and
/// those are chosen by the noise.
#[test]
fn an_existing_loop_is_not_learned_from_the_noise() {
    for (frequency, speed, kp) in [(0.428_991_5, 0.098_409_26, 3.0), (0.526_832, 0.096_238_6, 3.0)] {
        let settings = Settings { displacement: Gains::new(kp, 1.0), mode: Mode::Modifier, ..settings() };
        let run = sine(&settings, Table::new(1000.0).noisy(), speed / (std::f64::consts::TAU * frequency), frequency);
        assert_eq!(run.invented, 0, "{frequency} Hz");
        assert!(run.limit > 0.98 * 0.242, "{}", run.limit);
    }
}

#[test]
fn unequal_limits_are_told_apart() {
    let mut table = Table::new(1000.0).noisy();
    table.limits = (0.242, 0.17);
    let detector = Detector::new(&Detection::default(), 0.242, 0.017, 1e-3).unwrap();
    let mut state = detector.start();
    for k in 0..6000 {
        let reference = 0.1 * (std::f64::consts::TAU * f64::from(k) * 1e-3).sin();
        let sample = table.sample(reference);
        let error = 10.0 * (reference - f64::from(sample.displacement));
        let seen = Evidence {
            velocity: table.v as f32,
            acceleration: sample.acceleration,
            error: error as f32,
            demand: (2.39 * error) as f32,
        };
        detector.advance(&mut state, seen);
        table.advance(error);
    }
    let (positive, negative) = state.limits();
    assert!((positive - 0.242).abs() < 0.005 && (negative - 0.17).abs() < 0.012, "{positive} {negative}");
}

#[test]
fn a_detector_blind_to_demand_would_be_seen() {
    // Without "wanting", a limit that sank by a third is out of sight: nothing comes near the one that is believed.
    let blind = Detection { shortfall: 10.0, ..Detection::default() };
    let mut table = Table::new(1000.0).noisy();
    table.limits = (0.16, 0.16);
    let run = sine(&Settings { saturation: Some(blind), ..settings() }, table, 0.05, 1.0);
    assert!(f64::from(run.seen) < 0.5 * f64::from(run.saturated), "{run:?}");
}

#[test]
fn the_limit_recovers_once_the_supply_does() {
    let detector = Detector::new(&Detection::default(), 0.242, 0.017, 1e-3).unwrap();
    let mut state = detector.start();
    let sagging = Evidence { velocity: 0.15, acceleration: 0.0, error: 0.05, demand: 1.0 };
    for _ in 0..500 {
        detector.advance(&mut state, sagging);
    }
    assert_eq!(state.blocked(), Blocked::Positive);
    assert!((state.limit() - 0.15).abs() < 1e-3);
    let moving = Evidence { velocity: 0.05, acceleration: 0.0, error: 0.0, demand: 0.05 };
    for _ in 0..15_000 {
        detector.advance(&mut state, moving);
    }
    assert_eq!(state.blocked(), Blocked::Neither);
    assert!((state.limit() - (0.242 - 0.092 * libm::expf(-3.0))).abs() < 0.002);
}

/// Ticks after the reference has come back for which the table is still driven outward.
fn overshoot(anti_windup: bool, inner_loop: InnerLoop) -> f64 {
    let settings = Settings {
        displacement: Gains::new(5.0, 20.0),
        anti_windup,
        inner_loop,
        saturation: Some(Detection::default()),
        stroke: 1.0,
        ..Settings::default()
    };
    let mut controller = Controller::new(&settings).unwrap();
    let mut table = Table::new(1000.0);
    table.hardwired = inner_loop == InnerLoop::Hardwired;
    let mut farthest = 0.0_f64;
    for _ in 0..4000 {
        let sample = table.sample(0.3);
        table.advance(f64::from(controller.step(&sample).valve));
        farthest = farthest.max(table.x);
    }
    farthest - 0.3
}

#[test]
fn integrators_stop_while_the_table_is_at_its_limit() {
    for inner_loop in [InnerLoop::Absent, InnerLoop::Hardwired] {
        let (without, with) = (overshoot(false, inner_loop), overshoot(true, inner_loop));
        assert!(without > 0.15, "{without}");
        assert!(with < 0.35 * without, "{with} against {without}");
    }
}

#[test]
fn any_evidence_leaves_a_limit_between_floor_and_set() {
    let detector = Detector::new(&Detection::default(), 0.242, 0.017, 1e-3).unwrap();
    let mut state = detector.start();
    let mut seed = 1_u32;
    let mut next = || {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as f32 / 8_388_608.0 - 1.0
    };
    for _ in 0..200_000 {
        let seen = Evidence { velocity: next(), acceleration: 0.5 * next(), error: next(), demand: 3.0 * next() };
        detector.advance(&mut state, seen);
        assert!(state.limit() <= 0.242 && state.limit() >= 0.25 * 0.242 * 0.999);
    }
}

/// The fastest the modified reference moves in the last 2 s of 8 s, m/s, on a table that can do 0.15 m/s.
fn fastest_reference(modification: Modification, saturation: Option<Detection>) -> f32 {
    let mut controller = Controller::new(&Settings { modification, saturation, ..settings() }).unwrap();
    let mut table = Table::new(1000.0).noisy();
    table.limits = (0.15, 0.15);
    let (mut before, mut allowed, mut fastest) = (0.0f32, 0.242f32, 0.0f32);
    for k in 0..8000 {
        let reference = 0.08 * (std::f64::consts::TAU * f64::from(k) * 1e-3).sin();
        let command = controller.step(&table.sample(reference));
        let speed = (command.reference - before).abs() * 1000.0;
        assert!(speed <= allowed.max(command.status.velocity_limit) + 2e-5, "{k}: {speed} of {allowed}");
        (before, allowed) = (command.reference, command.status.velocity_limit);
        if k >= 6000 {
            fastest = fastest.max(speed);
        }
        table.advance(f64::from(command.valve));
    }
    fastest
}

/// What detection finds out reaches the modifier: it asks for what this table can do, not for what it was set to.
#[test]
fn a_limit_that_was_detected_slows_both_modifiers() {
    for modification in [Modification::Causal, Modification::Preview { seconds: 0.2 }] {
        let (seen, blind) =
            (fastest_reference(modification, Some(Detection::default())), fastest_reference(modification, None));
        assert!(seen < 0.2 && blind > 0.24, "{modification:?}: {seen} m/s with detection, {blind} without");
    }
}

#[test]
fn a_sample_of_rest_is_no_saturation() {
    let mut controller = Controller::new(&settings()).unwrap();
    for _ in 0..1000 {
        assert!(!controller.step(&Sample::new(0.1, 0.0, 0.0)).status.saturated);
    }
}
