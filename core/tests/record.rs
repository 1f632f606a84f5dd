//! What the online record modifiers promise, for any input.

use proptest::prelude::*;
use shakedown_core::SettingsError;
use shakedown_core::blocks::record::{DriftRecovery, ReferenceLimits, causal, clip, preview};

const RATE: f32 = 1000.0;
const LIMIT: f32 = 0.242;
const STROKE: f32 = 0.12;
const WINDOW: usize = 256;

fn limits() -> ReferenceLimits {
    ReferenceLimits::new(RATE, LIMIT, STROKE)
}

/// The three modifiers behind one face: reference, m, and limit, m/s, to modified reference, m.
struct Modifier {
    name: &'static str,
    step: Box<dyn FnMut(f32, f32) -> f32>,
    keeps_stroke: bool,
}

fn modifiers(limits: &ReferenceLimits) -> Result<Vec<Modifier>, SettingsError> {
    let clip_config = clip::Config::new(limits)?;
    let causal_config = causal::Config::new(limits, &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY)?;
    let preview_config = preview::Config::new::<WINDOW>(limits, &preview::Config::DRIFT_RECOVERY, 0.2)?;
    let (mut a, mut b, mut c) =
        (clip::State::at(0.0), causal::State::at(0.0), preview::State::<WINDOW, { preview::places(WINDOW) }>::at(0.0));
    Ok(vec![
        Modifier {
            name: "clip",
            step: Box::new(move |x, v| clip::step(&clip_config, &mut a, x, v)),
            keeps_stroke: false,
        },
        Modifier {
            name: "causal",
            step: Box::new(move |x, v| causal::step(&causal_config, &mut b, x, v)),
            keeps_stroke: true,
        },
        Modifier {
            name: "preview",
            step: Box::new(move |x, v| preview::step(&preview_config, &mut c, x, v)),
            keeps_stroke: true,
        },
    ])
}

/// One unit in the last place of `x`.
fn ulp(x: f32) -> f64 {
    let x = x.abs();
    f64::from(x.next_up()) - f64::from(x)
}

/// A reference built of runs: a slope (m/s), a jump (m) before it, a value that is no number now and then.
fn references() -> impl Strategy<Value = Vec<f32>> {
    let run = (-4.0..4.0f32, prop_oneof![9 => Just(0.0f32), 1 => -1.0..1.0f32], 1..150usize, 0..40u8);
    prop::collection::vec(run, 1..30).prop_map(|runs| {
        let mut x = 0.0;
        let mut out = Vec::new();
        for (slope, jump, length, odd) in runs {
            x += jump;
            for k in 0..length {
                x += slope / RATE;
                out.push(match (odd, k) {
                    (0, 3) | (3, 3..9) => f32::NAN,
                    (1, 3) => f32::INFINITY,
                    (2, 3) => f32::MIN,
                    _ => x,
                });
            }
        }
        out
    })
}

/// ReferenceLimits in force: stretches of what saturation detection may report, nonsense included.
fn limits_in_force() -> impl Strategy<Value = Vec<f32>> {
    let value = prop_oneof![
        4 => Just(LIMIT),
        4 => 0.0..LIMIT,
        1 => Just(f32::NAN),
        1 => Just(-1.0f32),
        1 => Just(f32::INFINITY),
    ];
    prop::collection::vec((value, 1..400usize), 1..12)
        .prop_map(|runs| runs.into_iter().flat_map(|(value, length)| std::iter::repeat_n(value, length)).collect())
}

/// What the limit in force means: never above the configured one, nothing when negative, configured when no number.
fn meaning(limit: f32) -> f64 {
    f64::from(if limit.is_nan() { LIMIT } else { limit.clamp(0.0, LIMIT) })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// No input moves the output faster than the limit in force, nor past the stroke, by more than one unit in the last
    /// place of the integrator.
    #[test]
    fn limits_hold_for_any_input(reference in references(), limit in limits_in_force()) {
        for mut modifier in modifiers(&limits()).unwrap() {
            let mut before = 0.0f32;
            for (x, v) in reference.iter().zip(limit.iter().cycle()) {
                let y = (modifier.step)(*x, *v);
                let moved = (f64::from(y) - f64::from(before)).abs();
                let slack = ulp(y.abs().max(before.abs()));
                prop_assert!(moved <= meaning(*v) / f64::from(RATE) * (1.0 + 2e-7) + slack, "{}: {moved}", modifier.name);
                if modifier.keeps_stroke {
                    prop_assert!(f64::from(y.abs()) <= f64::from(STROKE) + ulp(STROKE), "{}: {y}", modifier.name);
                }
                before = y;
            }
        }
    }

    /// From every state an input can bring about, braking at the configured deceleration ends inside the stroke.
    #[test]
    fn stops_inside_the_stroke_from_every_reachable_state(reference in references(), limit in limits_in_force()) {
        let brake = f64::from(limits().braking / (RATE * RATE));
        for mut modifier in modifiers(&limits()).unwrap().into_iter().filter(|m| m.keeps_stroke) {
            let mut before = 0.0f32;
            for (x, v) in reference.iter().zip(limit.iter().cycle()) {
                let y = (modifier.step)(*x, *v);
                let moved = f64::from(y) - f64::from(before);
                let ticks = (moved.abs() / brake).floor();
                let stopping = ticks * moved.abs() - brake * ticks * (ticks + 1.0) / 2.0;
                let farthest = f64::from(y) + stopping.copysign(moved);
                // The step is read back from a rounded displacement: one unit there, times the ticks it is carried for.
                let slack = ulp(STROKE) * (ticks + 2.0);
                prop_assert!(farthest.abs() <= f64::from(STROKE) + slack, "{}: {farthest}", modifier.name);
                before = y;
            }
        }
    }

    /// A reference inside the limits comes out as it went in, to the last place of its peak.
    #[test]
    fn leaves_a_record_inside_the_limits_alone(amplitude in 0.001..0.03f32, frequency in 0.2..1.0f32) {
        for mut modifier in modifiers(&limits()).unwrap() {
            let delay = if modifier.name == "preview" { 200 } else { 0 };
            let reference: Vec<f32> = (0..4000u16)
                .map(|k| {
                    let t = f64::from(k) / f64::from(RATE);
                    let onset = 0.5 - 0.5 * (std::f64::consts::PI * (t / 2.0).min(1.0)).cos();
                    (onset * f64::from(amplitude) * (std::f64::consts::TAU * f64::from(frequency) * t).sin()) as f32
                })
                .collect();
            let output: Vec<f32> = reference.iter().map(|x| (modifier.step)(*x, LIMIT)).collect();
            let apart = reference.iter().zip(&output[delay..]).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
            prop_assert!(f64::from(apart) <= ulp(amplitude), "{}: {apart} m", modifier.name);
        }
    }

    /// Whatever happened before, once the reference rests the output comes to it: no drift is left.
    #[test]
    fn leaves_no_drift(reference in references(), limit in limits_in_force(), rest in -0.05..0.05f32) {
        for mut modifier in modifiers(&limits()).unwrap().into_iter().filter(|m| m.keeps_stroke) {
            for (x, v) in reference.iter().zip(limit.iter().cycle()) {
                (modifier.step)(*x, *v);
            }
            let end = (0..30_000).map(|_| (modifier.step)(rest, LIMIT)).last().unwrap();
            prop_assert!((end - rest).abs() < 1e-6, "{}: {end} against {rest}", modifier.name);
        }
    }
}

/// Sinusoid of velocity amplitude 3 LIMIT at 1 Hz for 6 s: far beyond the limit.
fn strong_motion() -> Vec<f32> {
    let omega = std::f64::consts::TAU;
    let speed = 3.0 * f64::from(LIMIT);
    (0..6000u32).map(|k| (speed / omega * (1.0 - (omega * f64::from(k) / 1000.0).cos())) as f32).collect()
}

/// The root of the summed squares of the acceleration error, m/s2, `delay` ticks late.
fn acceleration_error(reference: &[f32], output: &[f32], delay: usize) -> f64 {
    let error: Vec<f64> = reference.iter().zip(&output[delay..]).map(|(x, y)| f64::from(*x) - f64::from(*y)).collect();
    error.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).sum::<f64>().sqrt() * f64::from(RATE * RATE)
}

#[test]
fn each_sees_further_than_the_last() {
    let mut reference = strong_motion();
    let strong = reference.len();
    reference.extend(std::iter::repeat_n(*reference.last().unwrap(), 200));
    let errors: Vec<f64> = modifiers(&limits())
        .unwrap()
        .into_iter()
        .zip([0, 0, 200])
        .map(|(mut modifier, delay)| {
            let output: Vec<f32> = reference.iter().map(|x| (modifier.step)(*x, LIMIT)).collect();
            acceleration_error(&reference[..strong], &output, delay)
        })
        .collect();
    assert!(errors[1] < 0.9 * errors[0] && errors[2] < 0.97 * errors[1], "{errors:?}");
}

#[test]
fn a_limit_lowered_mid_run_is_kept_from_that_tick_and_both_modifiers_bend_to_it() {
    let lowered = 0.6 * LIMIT;
    let run = |which: usize, delay: usize, set: f32, from: usize| {
        let mut modifier = modifiers(&ReferenceLimits::new(RATE, set, STROKE)).unwrap().swap_remove(which);
        let reference = strong_motion();
        let output: Vec<f32> = reference
            .iter()
            .enumerate()
            .map(|(k, x)| (modifier.step)(*x, if k < from { set } else { lowered }))
            .collect();
        let late = &output[from..];
        let fastest = late.windows(2).map(|w| (w[1] - w[0]).abs() * RATE).fold(0.0, f32::max);
        assert!(fastest <= lowered * 1.0001 + 1e-5, "{fastest}");
        acceleration_error(&reference[4000..5700], &output[4000..], delay)
    };
    for (which, delay) in [(1, 0), (2, 200)] {
        // Two seconds after the change the motion is the one of a modifier that was set to the lower limit from the start.
        let (from_the_start, mid_run) = (run(which, delay, lowered, 0), run(which, delay, LIMIT, 2000));
        assert!((mid_run / from_the_start - 1.0).abs() < 0.005, "{which}: {mid_run} against {from_the_start}");
    }
}

#[test]
fn a_sample_lost_costs_no_jerk() {
    let x = |k: u32| (0.02 * (1.0 - (f64::from(k) * 0.006).cos())) as f32;
    for mut modifier in modifiers(&limits()).unwrap() {
        let output: Vec<f32> =
            (0..3000).map(|k| (modifier.step)(if k == 1500 { f32::NAN } else { x(k) }, LIMIT)).collect();
        let hardest = output.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs() * RATE * RATE).fold(0.0f32, f32::max);
        assert!(hardest < 4.0, "{}: {hardest} m/s2", modifier.name);
    }
}

/// Little more than a third of a byte a sample beside the four that it takes itself.
#[test]
fn a_window_keeps_no_more_than_its_runs_need() {
    assert_eq!([8, 64, 512].map(preview::places), [2, 22, 176]);
}

#[test]
fn says_when_an_input_was_not_followed() {
    let config = causal::Config::new(&limits(), &causal::Config::DRIFT_RECOVERY, causal::Config::MEMORY).unwrap();
    let mut state = causal::State::at(0.01);
    causal::step(&config, &mut state, 0.01, LIMIT);
    assert!(!state.held() && !state.limited());
    causal::step(&config, &mut state, f32::NAN, LIMIT);
    assert!(state.held());
    causal::step(&config, &mut state, 0.5, LIMIT);
    assert!(state.held(), "a leap of half a metre is no motion");
    for k in 0..100u8 {
        causal::step(&config, &mut state, 0.5 + 0.001 * f32::from(k), LIMIT);
    }
    assert!(!state.held() && state.limited());
}

#[test]
fn refuses_what_makes_no_sense() {
    let refused = |edit: fn(&mut ReferenceLimits)| {
        let mut limits = limits();
        edit(&mut limits);
        matches!(clip::Config::new(&limits), Err(SettingsError::OutOfRange { .. }))
    };
    assert!(refused(|l| l.rate = 0.0));
    assert!(refused(|l| l.velocity = f32::NAN));
    assert!(refused(|l| l.stroke = -0.1));
    assert!(refused(|l| l.braking = f32::INFINITY));
    assert!(refused(|l| l.leap = 0.1));
    // A hundredth of the rate, itself included.
    let washes = |frequency| DriftRecovery { frequency, damping: 0.5 }.validate(RATE).is_ok();
    assert!(washes(1e-3) && washes(10.0) && !washes(9e-4) && !washes(10.01));
    let washout = DriftRecovery { frequency: 0.4, damping: 0.0 };
    assert!(causal::Config::new(&limits(), &washout, 4.0).is_err());
    assert!(causal::Config::new(&limits(), &causal::Config::DRIFT_RECOVERY, f32::NAN).is_err());
    assert!(preview::Config::new::<WINDOW>(&limits(), &preview::Config::DRIFT_RECOVERY, 0.256).is_err());
}
