//! What every filter and law promises: its equation, and what it does with what is not a number.

use proptest::prelude::*;
use shakedown_core::blocks::control::{
    AccelerationLoop, AccelerationState, Blocked, DisplacementLoop, DisplacementState, LoopGains, VelocityLoop,
    VelocityState,
};
use shakedown_core::blocks::filter::{
    Differentiator, DifferentiatorState, Lag, LagState, MotionObserver, MotionState, SecondOrder, SecondOrderState,
    Washout, WashoutState,
};
use shakedown_core::blocks::{Block, Held, RANGE, within_range};
use shakedown_core::settings::InnerLoop;
use std::f64::consts::{PI, TAU};

use crate::table::any_bits;

const DT: f32 = 1e-3;

/// Steps a block through any bits: its output stays finite, and what is no number changes nothing and says so.
fn survives<B: Block>(block: &B, inputs: &[f32]) -> Result<(), TestCaseError>
where
    B::State: PartialEq + std::fmt::Debug,
{
    let mut state = B::State::default();
    for &input in inputs {
        let before = state;
        let output = block.step(&mut state, input);
        prop_assert!(output.value().is_finite(), "{output:?} from {input}");
        prop_assert_eq!(output.is_held(), input.is_nan() || input.abs() > RANGE);
        if output.is_held() {
            prop_assert_eq!(state, before);
            prop_assert_eq!(output, Held::Last(block.last(&before)));
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn filters_survive_any_bits(
        inputs in proptest::collection::vec(any_bits(), 1..200),
        frequency in 0.01..100.0f32,
        damping in 0.005..10.0f32,
        time in 0.0..100.0f32,
    ) {
        survives(&Lag::<f32>::new(time, DT).unwrap(), &inputs)?;
        survives(&Washout::<f32>::new(frequency, DT).unwrap(), &inputs)?;
        survives(&Differentiator::<f32>::new(frequency.max(0.1), DT).unwrap(), &inputs)?;
        survives(&SecondOrder::<f32>::low_pass(frequency, damping, DT).unwrap(), &inputs)?;
        survives(&SecondOrder::<f32>::high_pass(frequency, damping, DT).unwrap(), &inputs)?;
        survives(&SecondOrder::<f32>::notch(frequency, damping, DT).unwrap(), &inputs)?;
    }

    #[test]
    fn lag_is_the_exponential(time in 0.002..50.0f64, ticks in 1..5000_i32) {
        let lag = Lag::<f32>::new(time as f32, DT).unwrap();
        let mut state = LagState::default();
        let output = (0..ticks).map(|_| lag.advance(&mut state, 1.0)).last().unwrap();
        let exact = 1.0 - (-f64::from(ticks) * 1e-3 / time).exp();
        prop_assert!((f64::from(output) - exact).abs() < 1e-4, "{output} against {exact}");
    }

    #[test]
    fn washout_forgets_and_starts_at_zero(frequency in 0.05..20.0f64, level in -100.0..100.0f32, change in -1.0..1.0f32) {
        let washout = Washout::<f32>::new(frequency as f32, DT).unwrap();
        let mut state = WashoutState::at(level);
        prop_assert_eq!(washout.advance(&mut state, level), 0.0);
        let ticks = 200;
        for _ in 0..=ticks {
            washout.advance(&mut state, level + change);
        }
        let exact = f64::from(level + change - level) * (1.0 + (-TAU * frequency * 1e-3).exp()) / 2.0
            * (-TAU * frequency * 1e-3 * f64::from(ticks)).exp();
        prop_assert!((f64::from(washout.last(&state)) - exact).abs() < 2e-5);
    }

    #[test]
    fn differentiator_integrates_back(frequency in 1.0..400.0f32, inputs in proptest::collection::vec(-0.1..0.1f32, 2..300)) {
        // The sum of the derivative, plus what the lag still holds, is the change of the input.
        let block = Differentiator::<f32>::new(frequency, DT).unwrap();
        let mut state = DifferentiatorState::at(inputs[0]);
        let sum: f64 = inputs.iter().map(|&x| f64::from(block.advance(&mut state, x)) * 1e-3).sum();
        let h = (PI * f64::from(frequency) * 1e-3).min(1.0);
        let held = f64::from(block.last(&state)) * (1.0 - h) / (2.0 * h) * 1e-3;
        let change = f64::from(inputs[inputs.len() - 1]) - f64::from(inputs[0]);
        prop_assert!((sum + held - change).abs() < 1e-5, "{} against {change}", sum + held);
    }

    #[test]
    fn widest_differentiator_is_the_backward_difference(a in -1.0..1.0f32, b in -1.0..1.0f32) {
        let block = Differentiator::<f32>::new(1000.0, DT).unwrap();
        let mut state = DifferentiatorState::default();
        block.advance(&mut state, a);
        prop_assert_eq!(block.advance(&mut state, b), (b - a) * (1.0 / DT));
    }

    #[test]
    fn sections_have_the_bilinear_response(corner in 0.5..200.0f64, damping in 0.05..2.0f64, at in 0.05..2.0f64) {
        let probe = (corner * at).min(300.0);
        for (kind, block) in sections(corner, damping).into_iter().enumerate() {
            let measured = gain(&block, probe, corner);
            let exact = bilinear(kind, corner, damping, probe);
            prop_assert!((measured - exact).abs() < 3e-3 * (1.0 + exact), "{kind}: {measured} against {exact}");
        }
    }
}

fn sections(corner: f64, damping: f64) -> [SecondOrder<f32>; 3] {
    let (f, z) = (corner as f32, damping as f32);
    [
        SecondOrder::low_pass(f, z, DT).unwrap(),
        SecondOrder::high_pass(f, z, DT).unwrap(),
        SecondOrder::notch(f, z, DT).unwrap(),
    ]
}

/// Amplitude of the answer to a unit sine at `probe` Hz, by least squares over whole periods once the start has died.
fn gain(block: &SecondOrder<f32>, probe: f64, corner: f64) -> f64 {
    let mut state = SecondOrderState::default();
    let settle = (20.0 / corner * 1000.0) as usize;
    let periods = (probe * 0.5).ceil().max(2.0);
    let count = (periods / probe * 1000.0).round() as usize;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for k in 0..settle + count {
        let phase = TAU * probe * k as f64 * 1e-3;
        let y = f64::from(block.advance(&mut state, phase.sin() as f32));
        if k >= settle {
            sine += y * phase.sin();
            cosine += y * phase.cos();
        }
    }
    2.0 * sine.hypot(cosine) / count as f64
}

/// Magnitude of the prewarped bilinear transform of an analog section.
fn bilinear(kind: usize, corner: f64, damping: f64, probe: f64) -> f64 {
    let w = (PI * probe * 1e-3).tan() / (PI * corner * 1e-3).tan();
    let denominator = (1.0 - w * w).hypot(2.0 * damping * w);
    [1.0, w * w, (1.0 - w * w).abs()][kind] / denominator
}

#[test]
fn a_section_with_another_damping_would_be_seen() {
    let [low, ..] = sections(5.0, 0.5);
    assert!((gain(&low, 5.0, 5.0) - bilinear(0, 5.0, 0.55, 5.0)).abs() > 1e-2);
}

#[test]
fn a_corner_of_ten_millihertz_keeps_its_digits() {
    // A direct-form biquad in f32 keeps 1 - 2 cos(w) + 1 = 4e-9 of a coefficient near 2: nothing.
    let block = SecondOrder::<f32>::low_pass(0.01, 0.7, DT).unwrap();
    let mut state = SecondOrderState::default();
    let ticks = 20_000;
    let output = (0..ticks).map(|_| block.advance(&mut state, 1.0)).last().unwrap();
    let (w, z, t) = (TAU * 0.01, 0.7_f64, f64::from(ticks) * 1e-3);
    let wd = w * (1.0 - z * z).sqrt();
    let exact = 1.0 - (-z * w * t).exp() * ((wd * t).cos() + z * w / wd * (wd * t).sin());
    assert!((f64::from(output) - exact).abs() < 1e-3, "{output} against {exact}");
}

proptest! {
    #[test]
    fn fusion_follows_any_steady_acceleration_and_learns_the_offset(
        start in -0.1..0.1f32, speed in -0.2..0.2f32, offset in -1.0..1.0f32, accelerate in -0.2..0.2f32,
    ) {
        let fusion = MotionObserver::crossover(2.0, DT).unwrap();
        let mut state = MotionState::default();
        let mut t = 0.0;
        for k in 0..3000 {
            t = f64::from(k) * 1e-3;
            let x = f64::from(start) + f64::from(speed) * t + 0.5 * f64::from(accelerate) * t * t;
            fusion.advance(&mut state, x as f32, accelerate - offset);
        }
        let velocity = f64::from(speed) + f64::from(accelerate) * t;
        prop_assert!((f64::from(state.velocity) - velocity).abs() < 1e-3, "{} against {velocity}", state.velocity);
        prop_assert!((state.offset - offset).abs() < 2e-2);
        prop_assert!(state.innovation.abs() < 1e-5);
    }

    #[test]
    fn loops_stay_within_their_limit_for_any_input(
        errors in proptest::collection::vec(any_bits(), 1..300),
        kp in -100.0..100.0f32, ki in -100.0..100.0f32, limit in 0.01..10.0f32,
    ) {
        let gains = LoopGains { proportional: kp, integral: ki };
        let mut d = DisplacementState::default();
        let (mut v, mut a) = (VelocityState::default(), AccelerationState::default());
        let displacement = DisplacementLoop::new(gains, DT, limit);
        let velocity = VelocityLoop::new(gains, DT, limit);
        let acceleration = AccelerationLoop::new(gains, DT, 0.05, limit).unwrap();
        for error in errors.into_iter().filter(|&e| within_range(e)) {
            displacement.advance(&mut d, error, Blocked::Neither);
            prop_assert!(d.integral.abs() <= limit);
            prop_assert!(velocity.advance(&mut v, error, Blocked::Neither).abs() <= limit);
            prop_assert!(acceleration.advance(&mut a, error, Blocked::Neither).abs() <= limit);
        }
    }

    #[test]
    fn velocity_loop_is_its_gain_times_the_displacement_error(kp in 0.1..20.0f32, path in proptest::collection::vec(-1e-3..1e-3f32, 1..400)) {
        let law = VelocityLoop::new(LoopGains { proportional: kp, integral: 0.0 }, DT, 100.0);
        let mut state = VelocityState::default();
        let (mut x, mut u) = (0.0_f64, 0.0);
        for step in path {
            x += f64::from(step);
            u = law.advance(&mut state, step / DT, Blocked::Neither);
        }
        prop_assert!((f64::from(u) - f64::from(kp) * x).abs() < 1e-5);
    }

    #[test]
    fn a_constant_acceleration_error_ends_in_no_command(kp in 0.1..10.0f32, ki in 0.0..5.0f32, error in -2.0..2.0f32) {
        let law = AccelerationLoop::new(LoopGains { proportional: kp, integral: ki }, DT, 0.2, 1e4).unwrap();
        let mut state = AccelerationState::default();
        law.advance(&mut state, 0.0, Blocked::Neither);
        let w = TAU * 0.2;
        let bound = (f64::from(kp) + f64::from(ki) / w) * f64::from(error.abs()) / (w * w);
        let mut u = 0.0;
        for _ in 0..30_000 {
            u = law.advance(&mut state, error, Blocked::Neither);
            prop_assert!(f64::from(u.abs()) <= 1.01 * bound + 1e-6);
        }
        prop_assert!(f64::from(u.abs()) < 1e-3 * bound + 1e-6, "{u} of {bound}");
    }

    #[test]
    fn a_blocked_integrator_only_goes_back(error in -1.0..1.0f32, before in -0.5..0.5f32) {
        let law = DisplacementLoop::new(LoopGains { proportional: 1.0, integral: 10.0 }, DT, 1.0);
        for blocked in [Blocked::Positive, Blocked::Negative] {
            let mut state = DisplacementState { integral: before };
            law.advance(&mut state, error, blocked);
            let outward = if blocked == Blocked::Positive { state.integral - before } else { before - state.integral };
            prop_assert!(outward <= 0.0);
        }
    }

    #[test]
    fn cancellation_leaves_the_law_alone_at_the_valve(u in -1.0..1.0f32, x in -0.12..0.12f32) {
        let valve = (u + InnerLoop::Hardwired.cancellation(x)) - x;
        prop_assert!((valve - u).abs() < 1e-6);
        prop_assert_eq!(InnerLoop::Absent.cancellation(x), 0.0);
    }
}

#[test]
fn a_double_integration_without_washout_would_be_seen() {
    // The same test on the law of Fig. 12 as drawn, kp / s^2: the command runs away.
    let (mut rate, mut command) = (0.0_f64, 0.0);
    for _ in 0..30_000 {
        rate += 1e-3 * 0.1;
        command += 1e-3 * rate;
    }
    let w = TAU * 0.2;
    assert!(command > 1.01 * 0.1 / (w * w));
}

#[test]
fn configurations_that_make_no_sense_are_refused() {
    for bad in [f32::NAN, f32::INFINITY, -1.0, 1e30] {
        assert!(Lag::<f32>::new(bad, DT).is_err());
        assert!(Lag::<f32>::new(1.0, bad).is_err());
        assert!(Washout::<f32>::new(bad, DT).is_err());
        assert!(Differentiator::<f32>::new(bad, DT).is_err());
        assert!(SecondOrder::<f32>::notch(bad, 0.1, DT).is_err());
        assert!(SecondOrder::<f32>::notch(10.0, bad, DT).is_err());
        assert!(MotionObserver::crossover(bad, DT).is_err());
    }
    let error = Washout::<f32>::new(200.0, DT).unwrap_err();
    assert_eq!((error.field, error.value, error.high), ("frequency", 200.0, 100.0));
}
