//! Whatever arrives: finite, within the limits, and said so.

use proptest::prelude::*;
use shakedown_core::settings::{
    Detection, EnvelopeSettings, FlowSettings, Gains, GuardSettings, InnerLoop, ReferenceRates, TrackingSettings,
    VelocitySource,
};
use shakedown_core::{Controller, Mode, Modification, OperatorRequest, Sample, Settings};

use crate::table::any_sample;

/// Settings of every kind: modes, loops, modifiers, with and without guard and detection.
fn any_settings() -> impl Strategy<Value = Settings> {
    let modes = prop_oneof![Just(Mode::Guard), Just(Mode::Modifier), Just(Mode::Controller)];
    let modifications = prop_oneof![
        Just(Modification::Off),
        Just(Modification::Clip),
        Just(Modification::Causal),
        Just(Modification::Preview { seconds: 0.1 }),
    ];
    let rates = prop_oneof![
        Just(ReferenceRates::Differences),
        Just(ReferenceRates::Derived { frequency: 30.0 }),
        Just(ReferenceRates::Supplied),
        Just(ReferenceRates::Zero),
    ];
    let gains = proptest::array::uniform6(prop_oneof![Just(0.0), -20.0..20.0f32]);
    (modes, modifications, rates, gains, any::<[bool; 5]>()).prop_map(|(mode, modification, reference_rates, g, b)| {
        let [hardwired, anti_windup, detects, guarded, sensor] = b;
        Settings {
            mode,
            modification,
            reference_rates,
            displacement: Gains::new(g[0], g[1]),
            velocity: Gains::new(g[2], g[3]),
            acceleration: Gains::new(g[4], g[5]),
            inner_loop: if hardwired { InnerLoop::Hardwired } else { InnerLoop::Absent },
            anti_windup,
            saturation: detects.then(Detection::default),
            guard: guarded.then(GuardSettings::default),
            velocity_source: if sensor { VelocitySource::Sensor } else { VelocitySource::Observer },
            ..Settings::default()
        }
    })
}

/// The output beyond zero flow that no input can make the controller exceed.
fn reach(settings: &Settings) -> f32 {
    let zero_flow = settings.ranges.displacement;
    settings.valve.command_limit + zero_flow
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn every_output_is_finite_and_within_reach(
        settings in any_settings(),
        samples in proptest::collection::vec(any_sample(), 1..200),
        start in 0..50_usize,
    ) {
        let mut controller = Controller::new(&settings).unwrap();
        let mut last = controller.step(&Sample::default());
        for (k, sample) in samples.iter().enumerate() {
            if k == start {
                let _ = controller.request(OperatorRequest::Arm);
                let _ = controller.request(OperatorRequest::Start);
            }
            let command = controller.step(sample);
            prop_assert!(command.valve.is_finite() && command.reference.is_finite());
            prop_assert!(command.valve.abs() <= reach(&settings) * 1.000_001, "{command:?}");
            prop_assert!(command.status.velocity_limit > 0.0);
            prop_assert!(command.status.velocity_limit <= settings.velocity_limit);
            prop_assert_eq!(command.status.held, !command.status.missing.is_empty());
            if command.status.held && settings.guard.is_none() {
                prop_assert_eq!(command.valve, last.valve);
                prop_assert_eq!(command.reference, last.reference);
            }
            last = command;
        }
        // The state is as finite as the output: a quiet table is answered with numbers again.
        for _ in 0..50 {
            let command = controller.step(&Sample::default());
            prop_assert!(command.valve.is_finite() && !command.status.held);
        }
    }

    #[test]
    fn the_modified_reference_never_moves_faster_than_the_limit(
        modification in prop_oneof![
            Just(Modification::Clip), Just(Modification::Causal), Just(Modification::Preview { seconds: 0.05 })
        ],
        limit in 0.01..2.0f32,
        samples in proptest::collection::vec(any_sample(), 2..300),
    ) {
        let settings = Settings { modification, velocity_limit: limit, ..Settings::default() };
        prop_assert_eq!(fastest(&settings, &samples) <= 1.0, true);
    }
}

/// The modified reference's fastest step, as a share of what the limit and one rounding allow.
fn fastest(settings: &Settings, samples: &[Sample]) -> f64 {
    let mut controller = Controller::new(settings).unwrap();
    let mut before = None;
    let mut fastest = 0.0_f64;
    for sample in samples {
        let command = controller.step(sample);
        if before.is_none() && command.status.held {
            continue;
        }
        let now = command.reference;
        if let Some(before) = before {
            let ulp = f64::from(f32::EPSILON) * f64::from(now).abs().max(f64::from(before)).max(1e-6);
            let allowed = f64::from(settings.velocity_limit) / f64::from(settings.rate) * (1.0 + 1e-6) + ulp;
            fastest = fastest.max((f64::from(now) - f64::from(before)).abs() / allowed);
        }
        before = Some(now);
    }
    fastest
}

/// Where the table is slower one way, as the tracking law is told, a modified reference keeps to what it does both ways.
#[test]
fn a_modified_reference_keeps_to_the_slower_direction() {
    // 0.31 m/s at its fastest.
    let sine: Vec<Sample> =
        (0..4000).map(|k| Sample::new((0.05 * (f64::from(k) * 0.00625).sin()) as f32, 0.0, 0.0)).collect();
    for (asymmetry, slower) in [(0.6, 0.12_f32), (1.5, 0.2), (1.0, 0.2)] {
        let flow = FlowSettings { asymmetry, ..FlowSettings::default() };
        let tracking = Some(TrackingSettings { flow, ..TrackingSettings::default() });
        let settings =
            Settings { modification: Modification::Clip, velocity_limit: 0.2, tracking, ..Settings::default() };
        // As a share of what the slower direction allows.
        let share = fastest(&settings, &sine) * f64::from(0.2 / slower);
        assert!(share > 0.99 && share < 1.001, "{asymmetry}: {share}");
    }
}

#[test]
fn an_unmodified_reference_would_be_seen_to_be_too_fast() {
    let samples = [Sample::new(0.0, 0.0, 0.0), Sample::new(0.1, 0.0, 0.0)];
    let clip = Settings { modification: Modification::Clip, ..Settings::default() };
    assert!(fastest(&clip, &samples) <= 1.0);
    assert!(fastest(&Settings::default(), &samples) > 1.0);
}

#[test]
fn a_lost_reading_holds_the_output_and_names_the_channel() {
    use shakedown_core::Channels;
    let mut controller = Controller::new(&Settings::default()).unwrap();
    let good = controller.step(&Sample::new(0.01, 0.0, 0.0));
    let held = controller.step(&Sample::new(f32::NAN, 0.0, 0.0));
    assert_eq!((held.valve, held.status.missing), (good.valve, Channels::REFERENCE));
    let held = controller.step(&Sample::new(0.02, 11.0, 0.0));
    assert_eq!((held.valve, held.status.missing), (good.valve, Channels::DISPLACEMENT));
    let held = controller.step(&Sample::new(0.02, f32::NEG_INFINITY, f32::NAN));
    assert_eq!(held.status.missing, Channels::DISPLACEMENT.union(Channels::ACCELERATION));
    // Channels that the settings do not use may hold anything.
    let odd = Sample { external: f32::NAN, pressure_difference: f32::INFINITY, ..Sample::new(0.01, 0.0, 0.0) };
    assert!(!controller.step(&odd).status.held);
}

#[test]
fn nothing_of_a_lost_tick_enters_the_integral() {
    let settings = Settings { displacement: Gains::new(0.0, 1.0), ..Settings::default() };
    let mut controller = Controller::new(&settings).unwrap();
    let mut once = Controller::new(&settings).unwrap();
    controller.step(&Sample::new(0.01, 0.0, 0.0));
    for _ in 0..1000 {
        controller.step(&Sample::new(0.05, f32::NAN, 0.0));
    }
    once.step(&Sample::new(0.01, 0.0, 0.0));
    let sample = Sample::new(0.02, 0.0, 0.0);
    assert_eq!(controller.step(&sample).valve, once.step(&sample).valve);
}

#[test]
fn forces_are_read_only_where_they_are_limited() {
    use shakedown_core::settings::ForceSettings;
    let force = Some(ForceSettings { limit: 280e3, piston_area: 0.024 });
    let envelope = EnvelopeSettings { force, ..EnvelopeSettings::default() };
    let guard = Some(GuardSettings { envelope, ..GuardSettings::default() });
    let mut controller = Controller::new(&Settings { guard, ..Settings::default() }).unwrap();
    let lost = Sample { pressure_difference: f32::NAN, ..Sample::default() };
    assert!(controller.step(&lost).status.held);
}
