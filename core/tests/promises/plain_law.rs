//! The bare controller is the plain law of the file formats, `u[k] = kp e[k] + ki dt (e[0] + ... + e[k])`, and the same
//! lines of code run in `f64` and on numbers that carry derivatives.

use core::cmp::Ordering;
use core::ops::{Add, Mul, Neg, Sub};

use proptest::prelude::*;
use shakedown_core::blocks::Scalar;
use shakedown_core::blocks::control::{Blocked, DisplacementLoop, DisplacementState, LoopGains};
use shakedown_core::settings::Gains;
use shakedown_core::{Controller, Sample, Settings};

/// The farthest that the bare controller is from the plain law with gains `kp` and `ki`, as a share of what the rounding
/// of `f32` allows.
fn misfit(settings: &Settings, kp: f32, ki: f32, signal: &[(f32, f32)]) -> f64 {
    let mut controller = Controller::new(settings).unwrap();
    let (mut sum, mut size, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
    for &(reference, displacement) in signal {
        let error = f64::from(reference) - f64::from(displacement);
        sum += error;
        size += error.abs();
        let expected = f64::from(kp) * error + f64::from(ki) / f64::from(settings.rate) * sum;
        let command = controller.step(&Sample::new(reference, displacement, 0.0));
        let allowed = 1e-6 * (f64::from(kp.abs()) * 0.24 + f64::from(ki.abs()) * 1e-3 * size) + 1e-12;
        worst = worst.max((f64::from(command.valve) - expected).abs() / allowed);
    }
    worst
}

fn signals() -> impl Strategy<Value = Vec<(f32, f32)>> {
    proptest::collection::vec((-0.12..0.12f32, -0.12..0.12f32), 1..400)
}

proptest! {
    #[test]
    fn bare_controller_is_the_plain_law(kp in -30.0..30.0f32, ki in -20.0..20.0f32, signal in signals()) {
        let settings = Settings { displacement: Gains::new(kp, ki), ..Settings::default() };
        prop_assert!(misfit(&settings, kp, ki, &signal) <= 1.0);
    }

    #[test]
    fn the_law_in_f64_is_the_closed_sum(kp in -30.0..30.0f64, ki in -20.0..20.0f64, signal in signals()) {
        let gains = LoopGains { proportional: kp, integral: ki };
        let law = DisplacementLoop::new(gains, 1e-3, 1e6);
        let (mut state, mut sum) = (DisplacementState::default(), 0.0);
        for (reference, displacement) in signal {
            let error = f64::from(reference) - f64::from(displacement);
            sum += error;
            let u = law.advance(&mut state, error, Blocked::Neither);
            prop_assert!((u - (kp * error + ki * 1e-3 * sum)).abs() < 1e-12);
        }
    }

    #[test]
    fn derivatives_pass_through_the_same_law(kp in -30.0..30.0f64, ki in -20.0..20.0f64, signal in signals()) {
        let gains = LoopGains { proportional: Dual(kp, [1.0, 0.0]), integral: Dual(ki, [0.0, 1.0]) };
        let law = DisplacementLoop::new(gains, Dual(1e-3, [0.0; 2]), Dual(1e6, [0.0; 2]));
        let (mut state, mut sum) = (DisplacementState::default(), 0.0);
        for (reference, displacement) in signal {
            let error = f64::from(reference) - f64::from(displacement);
            sum += error;
            let Dual(_, [by_kp, by_ki]) = law.advance(&mut state, Dual(error, [0.0; 2]), Blocked::Neither);
            prop_assert_eq!(by_kp, error);
            prop_assert!((by_ki - 1e-3 * sum).abs() < 1e-12);
        }
    }
}

#[test]
fn a_law_that_is_not_the_plain_one_would_be_seen() {
    let gains = Gains::new(3.7, 0.6);
    let signal: Vec<_> = (0..400).map(|k| (0.1 * libm::sinf(k as f32 * 0.05), 0.0)).collect();
    let plain = Settings { displacement: gains, ..Settings::default() };
    assert!(misfit(&plain, 3.7, 0.6, &signal) <= 1.0);
    // One part in ten thousand of a gain, and an integral that misses its last term.
    assert!(misfit(&plain, 3.7004, 0.6, &signal) > 1.0);
    let late: Vec<_> = signal.iter().map(|&(r, _)| (r, 0.6e-3 / 3.7 * r)).collect();
    assert!(misfit(&plain, 3.7, 0.6, &late) <= 1.0);
    let stops = shakedown_core::settings::ValveSettings { command_limit: 0.2, ..Default::default() };
    assert!(misfit(&Settings { valve: stops, ..plain }, 3.7, 0.6, &signal) > 1.0);
}

/// A number with its derivatives with respect to two parameters, as a host would have it.
#[derive(Debug, Clone, Copy)]
struct Dual(f64, [f64; 2]);

impl PartialEq for Dual {
    fn eq(&self, other: &Self) -> bool {
        self.0 == other.0
    }
}

impl PartialOrd for Dual {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.0.partial_cmp(&other.0)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0, [self.1[0] + o.1[0], self.1[1] + o.1[1]])
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self(self.0 * o.0, [self.1[0] * o.0 + self.0 * o.1[0], self.1[1] * o.0 + self.0 * o.1[1]])
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, [-self.1[0], -self.1[1]])
    }
}

impl Scalar for Dual {
    const ZERO: Self = Self(0.0, [0.0; 2]);
    fn from_f32(value: f32) -> Self {
        Self(f64::from(value), [0.0; 2])
    }
}
