//! What parts of the guard say exactly at a limit, to the last bit.

use shakedown_core::blocks::Block;
use shakedown_core::blocks::filter::{Lag, LagState, MotionState};
use shakedown_core::blocks::guard::{Plausibility, PlausibilityState, Ramps, Supervisor};
use shakedown_core::settings::{PlausibilitySettings, RampSettings};
use shakedown_core::{OperatorRequest, Trip};

/// A fade-in whose time ends in the middle of a tick ends at that tick's beginning: the lengths are those at which rounding leaves it
/// in the middle to the last bit.
#[test]
fn a_fade_of_half_a_tick_more_takes_no_tick_more() {
    for ticks in [2_u8, 4, 6, 7, 8, 10, 16, 17] {
        let ramps = Ramps::new(&RampSettings { test: f32::from(ticks) + 0.5, safe: 1.0 }, 1.0).unwrap();
        let mut supervisor = Supervisor::off();
        supervisor.request(OperatorRequest::Arm).unwrap();
        supervisor.request(OperatorRequest::Start).unwrap();
        let whole = (1..100).find(|_| {
            supervisor.advance(ramps);
            supervisor.whole()
        });
        assert_eq!(whole, Some(ticks));
    }
}

/// An innovation of which exactly half is one-sided is that of a noisy LVDT; of which a little more is, of sensors that disagree.
#[test]
fn an_innovation_that_is_half_one_sided_is_noise() {
    let settings = PlausibilitySettings { disagreement: 1e-6, ..PlausibilitySettings::default() };
    let (dt, first) = (0.003, -1.0_f32);
    let monitor = Plausibility::new(&settings, dt).unwrap();
    let lag = Lag::<f32>::new(0.05, dt).unwrap();
    // Of the mean and of the mean magnitude after `first` and `second`: how much more than half of the one the other is.
    let beyond_half = |second: f32| {
        let (mut sided, mut size) = (LagState::default(), LagState::default());
        for e in [first, second] {
            lag.advance(&mut sided, e);
            lag.advance(&mut size, e.abs());
        }
        sided.output().abs() - 0.5 * size.output()
    };
    let said = |second: f32| {
        let mut state = PlausibilityState::default();
        let turn = |(k, innovation): (usize, f32)| {
            let (x, a) = (1e-3 * (k + 1) as f32, 0.1 * (k + 1) as f32);
            monitor.advance(&mut state, x, a, &MotionState { innovation, ..MotionState::default() })
        };
        [first, second].into_iter().enumerate().map(turn).last().unwrap()
    };
    // Three times what is left of the first, the other way: half of the sum is left one-sided.
    let mut second = 2.5_f32;
    while beyond_half(second) < 0.0 {
        second = second.next_up();
    }
    assert_eq!(beyond_half(second), 0.0, "no innovation meets the half to the last bit");
    assert_eq!(said(second), Some(Trip::DisplacementNoisy));
    assert_eq!(said(1.001 * second), Some(Trip::SensorsDisagree));
    assert_eq!(said(0.999 * second), Some(Trip::DisplacementNoisy));
}

/// Two fades make the weight: one rises by the tick from the start on, the other falls by the tick from the stop on, and neither waits for
/// the other.
#[test]
fn fades_rise_and_fall_by_the_tick() {
    let ramps = Ramps::new(&RampSettings { test: 8.0, safe: 1.0 }, 1.0).unwrap();
    let mut supervisor = Supervisor::off();
    assert_eq!(supervisor.fades(), (0.0, 1.0));
    supervisor.request(OperatorRequest::Arm).unwrap();
    supervisor.request(OperatorRequest::Start).unwrap();
    for tick in 1..=6_u8 {
        supervisor.advance(ramps);
        assert_eq!(supervisor.fades(), (f32::from(tick) / 8.0, 1.0));
    }
    supervisor.request(OperatorRequest::Stop).unwrap();
    for tick in 1..=7_u8 {
        supervisor.advance(ramps);
        assert_eq!(supervisor.fades(), (f32::from(6 + tick).min(8.0) / 8.0, 1.0 - f32::from(tick) / 8.0));
    }
    supervisor.advance(ramps);
    assert_eq!(supervisor.fades(), (0.0, 1.0));
}
