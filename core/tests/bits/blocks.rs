//! Filters, loops and the arithmetic below them.

use crate::tape::{Noise, Tape, hold, run, signal};
use shakedown_core::blocks::control::{
    AccelerationLoop, AccelerationState, Blocked, DisplacementLoop, DisplacementState, LoopGains, VelocityLoop,
    VelocityState,
};
use shakedown_core::blocks::filter::{
    Differentiator, DifferentiatorState, Lag, LagState, MotionObserver, MotionState, SecondOrder, SecondOrderState,
    Washout, WashoutState,
};
use shakedown_core::blocks::math::{self, Magnitude};
use shakedown_core::blocks::{Block, RANGE, Scalar, within_range};
use shakedown_core::settings::InnerLoop;

const DT: f32 = 1e-3;
/// The edges of what a block takes, and what lies beyond.
const EDGES: [f32; 9] = [RANGE, -RANGE, 1.0001e9, -1.0001e9, 0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];

/// A block over a signal, and behind its wall over the edges of its range.
fn filter<B: Block<f32>>(tape: &mut Tape, block: &B, mut state: B::State) {
    let mut edges = EDGES.into_iter();
    for (k, x) in signal(3, 0.7, 450).enumerate() {
        tape.note(block.advance(&mut state, x));
        tape.note(block.last(&state));
        if k % 50 == 49 {
            let held = block.step(&mut state, edges.next().unwrap_or(0.1));
            tape.note(held.value());
            tape.count(held.is_held());
        }
    }
}

#[test]
fn filters() {
    let section = |made: Result<SecondOrder, _>| {
        let made: SecondOrder = made.unwrap_or_else(|error: shakedown_core::blocks::BlockError| panic!("{error:?}"));
        move |tape: &mut Tape| filter(tape, &made, SecondOrderState::default())
    };
    hold(
        "filters",
        &[
            run("lag 20 ms", |tape| filter(tape, &Lag::new(0.02, DT).unwrap(), LagState::at(0.3))),
            run("lag 60 s", |tape| filter(tape, &Lag::new(60.0, 1e-4).unwrap(), LagState::default())),
            run("no lag", |tape| filter(tape, &Lag::new(0.0, DT).unwrap(), LagState::at(-0.3))),
            run("washout 2 Hz", |tape| filter(tape, &Washout::new(2.0, DT).unwrap(), WashoutState::at(0.3))),
            run("washout from rest", |tape| filter(tape, &Washout::new(0.05, DT).unwrap(), WashoutState::default())),
            run("differentiator 30 Hz", |tape| {
                filter(tape, &Differentiator::new(30.0, DT).unwrap(), DifferentiatorState::at(-0.2));
            }),
            run("backward difference", |tape| {
                filter(tape, &Differentiator::new(1000.0, DT).unwrap(), DifferentiatorState::default());
            }),
            run("low-pass", section(SecondOrder::low_pass(12.0, 0.7, DT))),
            run("high-pass", section(SecondOrder::high_pass(0.8, 0.3, DT))),
            run("notch", section(SecondOrder::notch(40.0, 0.1, DT))),
            run("fusion", |tape| {
                let fusion = MotionObserver::crossover(2.0, DT).unwrap();
                let mut state = MotionState::at(0.4);
                for (k, x) in signal(5, 0.1, 600).enumerate() {
                    if k % 100 < 3 {
                        fusion.coast(&mut state);
                    } else {
                        fusion.advance(&mut state, x, 9.0 * x + 0.2);
                    }
                    tape.note_all([state.displacement, state.velocity, state.offset, state.innovation]);
                }
            }),
        ],
    );
}

/// The three loops, blocked in turn, at gains that make every limit act.
#[test]
fn loops() {
    let blocked = [Blocked::Neither, Blocked::Positive, Blocked::Negative];
    let errors = |size| signal(7, size, 900).zip(blocked.into_iter().cycle());
    let gains = |proportional, integral| LoopGains { proportional, integral };
    let acceleration = |limit: f32, size: f32| {
        move |tape: &mut Tape| {
            let law = AccelerationLoop::new(gains(3.0, 11.0), DT, 0.4, limit).unwrap();
            let mut state = AccelerationState::default();
            for (error, blocked) in errors(size) {
                tape.note(law.advance(&mut state, error, blocked));
                tape.note_all([state.integral, state.rate]);
            }
        }
    };
    hold(
        "loops",
        &[
            run("displacement", |tape| {
                let law = DisplacementLoop::new(gains(3.7, 6.0), DT, 0.02);
                let mut state = DisplacementState::default();
                for (error, blocked) in errors(0.1) {
                    tape.note(law.advance(&mut state, error, blocked));
                    tape.note(state.integral);
                }
            }),
            run("velocity", |tape| {
                let law = VelocityLoop::new(gains(2.0, 40.0), DT, 0.015);
                let mut state = VelocityState::default();
                for (error, blocked) in errors(0.1) {
                    tape.note(law.advance(&mut state, error, blocked));
                    tape.note(state.integral);
                }
            }),
            run("acceleration", acceleration(10.0, 0.5)),
            run("acceleration at its limit", acceleration(2e-4, 0.5)),
            run("acceleration at every limit", acceleration(1e-5, 5.0)),
        ],
    );
}

/// At exactly nothing every integrator goes on: there is nothing to take in.
#[test]
fn a_blocked_direction_allows_nothing_and_the_way_back() {
    for (blocked, up, down) in
        [(Blocked::Neither, true, true), (Blocked::Positive, false, true), (Blocked::Negative, true, false)]
    {
        assert_eq!((blocked.allows(1e-30_f32), blocked.allows(-1e-30_f32)), (up, down));
        assert!(blocked.allows(0.0_f32) && blocked.allows(-0.0_f64));
    }
    assert_eq!([InnerLoop::Absent, InnerLoop::Hardwired].map(|inner| inner.cancellation(0.3)), [0.0, 0.3]);
}

/// Limits belong to what they limit; of a NaN nothing is within anything.
#[test]
fn ranges_include_their_ends() {
    let two = Magnitude::new(-2.0);
    for (value, inside) in [(2.0, true), (-2.0, true), (2.0_f32.next_up(), false), (0.0, true), (f32::NAN, false)] {
        assert_eq!((two.holds(value), Magnitude::new(2.0).holds(value)), (inside, inside), "{value}");
        // Held within, and told to be.
        assert_eq!(value.bounded(2.0).abs() <= 2.0, !value.is_nan());
    }
    assert!(Magnitude::ZERO.holds(-0.0) && !Magnitude::ZERO.holds(f32::from_bits(1)));
    assert!(Magnitude::new(f32::INFINITY).holds(f32::MIN) && !Magnitude::new(f32::INFINITY).holds(f32::NAN));
    assert!(within_range(RANGE) && within_range(-RANGE) && !within_range(RANGE.next_up()) && !within_range(f32::NAN));
    assert!(!within_range(-f64::from(RANGE) - 1.0) && within_range(f64::from(RANGE)));
    assert_eq!((3.0_f32.within(-1.0, 2.0), (-3.0_f32).within(-1.0, 2.0), 0.5_f32.within(-1.0, 2.0)), (2.0, -1.0, 0.5));
    // What lies at a limit is left as it is, the sign of a zero with it.
    assert_eq!((-0.0_f32).within(-1.0, 0.0).to_bits(), (-0.0_f32).to_bits());
    assert_eq!(0.0_f32.within(-0.0, 1.0).to_bits(), 0.0_f32.to_bits());
    assert_eq!((3.0_f64.bounded(2.0), (-3.0_f64).bounded(2.0), 1.5_f64.bounded(2.0)), (2.0, -2.0, 1.5));
    assert_eq!((3.0_f32.bounded(2.0), (-3.0_f32).bounded(2.0), 1.5_f32.bounded(2.0)), (2.0, -2.0, 1.5));
    assert!(f32::NAN.bounded(1.0).is_nan() && f64::from_f32(0.1) == f64::from(0.1_f32));
    // Where either is no number the second is given.
    assert_eq!((math::min(1.0, 2.0), math::min(2.0, 1.0), math::min(f32::NAN, 1.0)), (1.0, 1.0, 1.0));
    assert_eq!((math::max(1.0, 2.0), math::max(2.0, 1.0), math::max(f32::NAN, 1.0)), (2.0, 2.0, 1.0));
    assert!(math::min(1.0, f32::NAN).is_nan() && math::max(1.0, f32::NAN).is_nan());
    // Of two zeros too.
    assert_eq!(math::min(-0.0, 0.0).to_bits(), 0.0_f32.to_bits());
    assert_eq!(math::max(0.0, -0.0).to_bits(), (-0.0_f32).to_bits());
}

/// The only transcendental functions there are.
#[test]
fn mathematics() {
    let mut noise = Noise::new(9);
    hold(
        "mathematics",
        &[run("exp, exp_m1, tan, sqrt, floor, pow", |tape| {
            for _ in 0..200 {
                let x = noise.next();
                tape.note_all([math::exp(4.0 * x), math::exp_m1(0.01 * x), math::tan(1.5 * x), math::sqrt(x.abs())]);
                tape.note_all([math::floor(9.0 * x), math::pow(1.0 + x, 3.3 * x)]);
            }
        })],
    );
}
