use super::super::Format;
use super::*;
use proptest::prelude::*;

fn record(acceleration: Vec<f64>, dt: f64) -> Record {
    Record { name: "test".into(), dt, acceleration, component: String::new(), format: Format::Generated, facts: vec![] }
}

fn wave(n: usize) -> Vec<f64> {
    (0..n)
        .map(|k| (0.21 * k as f64).sin() * (-((k as f64 - n as f64 / 2.0) / (n as f64 / 8.0)).powi(2)).exp())
        .collect()
}

/// What [`Motion`] promises.
fn assert_consistent(motion: &Motion) {
    let (x, v) = (motion.displacement[0], motion.velocity[0]);
    assert_eq!(*motion, Motion::from_state(motion.dt, motion.acceleration.clone(), x, v));
}

#[test]
fn peaks_are_read_with_their_units_and_refused_without() {
    assert!((peak_acceleration("0.74g").unwrap() - 7.256_921).abs() < 1e-9);
    assert!((peak_acceleration(" 350 gal").unwrap() - 3.5).abs() < 1e-12);
    assert!((peak_acceleration("7.2 m/s2").unwrap() - 7.2).abs() < 1e-12);
    assert_eq!(peak_acceleration("0.74"), Err(PeakError::NoUnit("0.74".into())));
    assert_eq!(peak_acceleration("-1g"), Err(PeakError::Number("-1g".into())));
    assert!(matches!(peak_acceleration("1 furlong"), Err(PeakError::Unit(_))));
    assert!(peak_acceleration("g").is_err() && peak_acceleration("").is_err());
}

#[test]
fn similitude_keeps_acceleration_and_shrinks_time_velocity_and_length() {
    let full = record(wave(400), 0.01).motion();
    let model = Step::Similitude { length_scale: 0.25 }.apply(full.clone()).unwrap();
    assert!((model.dt - 0.005).abs() < 1e-15);
    assert_eq!(model.acceleration, full.acceleration);
    for k in 0..full.len() {
        assert!((model.velocity[k] - 0.5 * full.velocity[k]).abs() < 1e-12);
        assert!((model.displacement[k] - 0.25 * full.displacement[k]).abs() < 1e-12);
    }
}

#[test]
fn a_baseline_is_taken_out_of_acceleration_and_of_velocity() {
    let dt = 0.01;
    let bent: Vec<f64> = wave(1000).iter().enumerate().map(|(k, a)| a + 0.3 - 0.0002 * k as f64).collect();
    let flat = Step::Baseline { degree: 1 }.apply(record(bent.clone(), dt).motion()).unwrap();
    let mean = flat.acceleration.iter().sum::<f64>() / 1000.0;
    let slope = flat.acceleration.iter().enumerate().map(|(k, a)| (k as f64 - 499.5) * a).sum::<f64>();
    assert!(mean.abs() < 1e-10 && slope.abs() < 1e-5, "{mean} {slope}");
    let still = Step::VelocityBaseline { degree: 2 }.apply(record(bent, dt).motion()).unwrap();
    let plain = record(wave(1000), dt).motion();
    assert!((still.velocity[999] - plain.velocity[999]).abs() < 0.02);
    assert!(still.displacement[999].abs() < 0.05, "{}", still.displacement[999]);
}

#[test]
fn steps_that_leave_nothing_or_too_much_are_refused() {
    let motion = || record(wave(100), 0.01).motion();
    let refused = [
        Step::Trim { from_s: 5.0, to_s: 6.0 },
        Step::Trim { from_s: f64::NAN, to_s: -1.0 },
        Step::Rest { before_s: -1.0, after_s: 0.0 },
        Step::Rest { before_s: 1e9, after_s: 0.0 },
        Step::Rest { before_s: f64::NAN, after_s: 0.0 },
        Step::Resample { rate_hz: 0.0, between: Interpolation::Linear },
        Step::Resample { rate_hz: 0.5, between: Interpolation::Linear },
        Step::Resample { rate_hz: 1e9, between: Interpolation::BandLimited },
        Step::Scale { factor: f64::NAN },
        Step::ScaleToPeak { peak: 0.0 },
        Step::FitStroke { stroke: -0.1 },
        Step::Similitude { length_scale: 0.0 },
        Step::Baseline { degree: 7 },
        Step::VelocityBaseline { degree: 0 },
        Step::HighPassMotion { corner_hz: 50.0, order: 2 },
    ];
    for step in refused {
        assert!(step.apply(motion()).is_err(), "{step:?}");
    }
    let zero = record(vec![0.0; 10], 0.01).motion();
    assert_eq!(Step::ScaleToPeak { peak: 1.0 }.apply(zero), Err(ConditionError::Zero));
}

#[test]
fn a_high_pass_on_both_leaves_the_velocity_that_was_asked_for() {
    let motion = record([vec![0.0; 600], wave(2000), vec![0.0; 1000]].concat(), 0.005).motion();
    let filter = Butterworth::high_pass(2, 0.1);
    let once = filter.apply(&motion.acceleration, 0.005, Pass::ZeroPhase).unwrap();
    let twice = filter.apply(&Motion::from_acceleration(0.005, once).velocity, 0.005, Pass::ZeroPhase).unwrap();
    let found = Step::HighPassMotion { corner_hz: 0.1, order: 2 }.apply(motion).unwrap();
    assert_consistent(&found);
    let worst = found.velocity.iter().zip(&twice).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-5 * peak(&twice), "{worst}");
}

#[test]
fn a_recipe_reads_from_text() {
    let text = r#"[{"do":"rest","before_s":3,"after_s":5},
                   {"do":"filter","filter":{"band":{"low-pass":4.7},"order":6},"pass":"causal"},
                   {"do":"resample","rate_hz":200,"between":"band-limited"}]"#;
    let recipe: Recipe = serde_json::from_str(text).unwrap();
    assert_eq!(recipe.steps.len(), 3);
    let written = serde_json::to_string(&Recipe::table1(1000.0)).unwrap();
    assert_eq!(serde_json::from_str::<Recipe>(&written).unwrap(), Recipe::table1(1000.0));
    assert!(serde_json::from_str::<Recipe>(r#"[{"do":"rest","before":3,"after_s":5}]"#).is_err());
}

#[test]
fn a_motion_beyond_what_the_core_holds_is_refused_at_its_step() {
    let motion = Motion::from_acceleration(0.01, vec![1.0; 100]);
    let steps = vec![Step::Scale { factor: 2.0 }, Step::ScaleToPeak { peak: 1e39 }];
    let refused = Recipe { steps }.apply_to(motion.clone()).unwrap_err();
    assert_eq!(refused, ConditionError::NotFinite { step: 2 });
    assert!(Recipe { steps: vec![Step::ScaleToPeak { peak: 1e38 }] }.apply_to(motion).is_ok());
}

/// A rate of less than a sample in the whole motion is refused before its sinc, which has no end, is summed.
#[test]
fn a_rate_that_leaves_one_sample_is_refused_at_once() {
    let motion = Motion::from_acceleration(0.01, vec![1.0; 101]);
    for between in [Interpolation::Linear, Interpolation::BandLimited] {
        let at = |rate_hz: f64| Step::Resample { rate_hz, between }.apply(motion.clone());
        for rate_hz in [1e-300, 1e-12, 0.9] {
            assert_eq!(at(rate_hz).unwrap_err(), ConditionError::TooShort { what: "resampling", samples: 1 });
        }
        assert_eq!(at(1.0).unwrap().len(), 2);
    }
}

fn any_step() -> impl Strategy<Value = Step> {
    prop_oneof![
        (0..=6usize).prop_map(|degree| Step::Baseline { degree }),
        (1..=6usize).prop_map(|degree| Step::VelocityBaseline { degree }),
        // Two samples at least, 10 ms each.
        (0.0..1.0f64, 1.03..2.0f64).prop_map(|(from_s, to_s)| Step::Trim { from_s, to_s }),
        (0.0..2.0f64, 0.0..2.0f64).prop_map(|(before_s, after_s)| Step::Rest { before_s, after_s }),
        (90.0..300.0f64, prop_oneof![Just(Interpolation::Linear), Just(Interpolation::BandLimited)])
            .prop_map(|(rate_hz, between)| Step::Resample { rate_hz, between }),
        (1..8usize, 0.5..30.0f64)
            .prop_map(|(o, f)| Step::Filter { filter: Butterworth::low_pass(o, f), pass: Pass::Causal }),
        (1..4usize, 0.05..1.0f64).prop_map(|(order, corner_hz)| Step::HighPassMotion { corner_hz, order }),
        (0.01..3.0f64).prop_map(|peak| Step::ScaleToPeak { peak }),
        (0.001..0.2f64).prop_map(|stroke| Step::FitStroke { stroke }),
        (0.001..0.2f64).prop_map(|limit| Step::FitVelocity { limit }),
        (0.1..1.0f64).prop_map(|length_scale| Step::Similitude { length_scale }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_step_leaves_a_motion_whose_parts_belong_together(step in any_step(), n in 300..500usize) {
        let motion = step.apply(record(wave(n), 0.01).motion()).unwrap();
        let again = Motion::from_state(
            motion.dt, motion.acceleration.clone(), motion.displacement[0], motion.velocity[0],
        );
        for k in 0..motion.len() {
            prop_assert!((motion.velocity[k] - again.velocity[k]).abs() < 1e-9);
            prop_assert!((motion.displacement[k] - again.displacement[k]).abs() < 1e-9);
            prop_assert!(motion.acceleration[k].is_finite());
        }
        match step {
            Step::ScaleToPeak { peak: wanted } => {
                prop_assert!((peak(&motion.acceleration) - wanted).abs() < 1e-12);
            }
            Step::FitStroke { stroke } => prop_assert!(peak(&motion.displacement) <= stroke * (1.0 + 1e-12)),
            Step::FitVelocity { limit } => prop_assert!(peak(&motion.velocity) <= limit * (1.0 + 1e-12)),
            _ => {}
        }
    }
}
