//! The sampled loop against its closed form in the z-domain, the control core against the same law in `f64`, and the
//! limiter's saw-tooth against its slope.
//!
//! Closed form. Eq. 7 behind a zero-order hold, with `delta = z - 1`, `E = exp(-a1 T)`, `A = b0 / a1` and
//! `C = (b0 - b1 a1) / a1^2`:
//! ```text
//! G = ((A T - C (1 - E)) delta + A T (1 - E)) / (delta (delta + 1 - E))      PI = ((kp + ki T) delta + ki T) / delta
//! ```
//! The closed loop H = N / Q has three poles p; a reference `q^k` gives `x_k = H(q) q^k + sum N(p) p^k / (Q'(p) (p - q))`:
//! q = 1 is the step, the imaginary part of `q = exp(i w T)` the sine. Nothing of it is shared with the simulation.

#![allow(
    clippy::unwrap_used,
    clippy::large_stack_arrays,
    clippy::useless_vec,
    reason = "the lint knows test functions, not helpers; signals stand where they are used"
)]

use nalgebra::Complex;
use shakedown::blocks::closed_loop::settings;
use shakedown::blocks::plant::paper::{FixedStep, Paper};
use shakedown::blocks::plant::sensors::{SensorModel, Sensors};
use shakedown::simulate::{Clock, ControlLaw, PlainPi, PublishedGains, Trace, run};
use shakedown_core::Controller;

type C = Complex<f64>;

const RATE: f64 = 1000.0;

/// The closed loop as two polynomials in delta, lowest power first, without common factors.
struct ClosedLoop {
    numerator: Vec<f64>,
    denominator: Vec<f64>,
}

impl ClosedLoop {
    fn new(plant: &Paper, kp: f64, ki: f64) -> Self {
        let t = 1.0 / RATE;
        let lost = -(-plant.a1 * t).exp_m1();
        let (a, c) = (plant.b0 / plant.a1, (plant.b0 - plant.b1 * plant.a1) / plant.a1.powi(2));
        let (g1, g0) = (a * t - c * lost, a * t * lost);
        let (c1, c0) = (kp + ki * t, ki * t);
        let numerator = vec![c0 * g0, c1 * g0 + c0 * g1, c1 * g1];
        // Q = delta^2 (delta + lost) + N.
        let denominator = vec![numerator[0], numerator[1], numerator[2] + lost, 1.0];
        // With no integral gain the controller's own pole cancels.
        let common = usize::from(ki == 0.0);
        Self { numerator: numerator[common..].to_vec(), denominator: denominator[common..].to_vec() }
    }

    /// The poles, by Durand and Kerner's iteration.
    fn poles(&self) -> Vec<C> {
        let starts = [C::new(-0.01, 0.01), C::new(-0.03, -0.02), C::new(-0.05, 0.003)];
        let mut roots = starts[..self.denominator.len() - 1].to_vec();
        for _ in 0..200 {
            for i in 0..roots.len() {
                let others = (0..roots.len()).filter(|&j| j != i).map(|j| roots[i] - roots[j]).product::<C>();
                let value = at(&self.denominator, roots[i]);
                roots[i] -= value / others;
            }
        }
        roots
    }

    /// The first `n` values of the response to `(1 + q)^k`.
    fn response(&self, q: C, n: usize) -> Vec<C> {
        let degree = self.denominator.len() - 1;
        let slope = |p: C| (1..=degree).map(|i| p.powu(i as u32 - 1) * (self.denominator[i] * i as f64)).sum::<C>();
        let steady = at(&self.numerator, q) / at(&self.denominator, q);
        let mode = |p: C| (p + 1.0, at(&self.numerator, p) / slope(p) / (p - q));
        let modes: Vec<(C, C)> = self.poles().into_iter().map(mode).collect();
        let value =
            |k: usize| (q + 1.0).powu(k as u32) * steady + modes.iter().map(|(z, r)| z.powu(k as u32) * r).sum::<C>();
        (0..n).map(value).collect()
    }
}

fn at(polynomial: &[f64], x: C) -> C {
    polynomial.iter().rev().fold(C::new(0.0, 0.0), |sum, c| sum * x + c)
}

/// The loop closed without noise around `law`.
fn simulate(plant: Paper, law: &mut impl ControlLaw, reference: &[f64]) -> Trace {
    let clock = Clock::new(RATE, 10).unwrap();
    let mut plant = FixedStep::new(plant, clock.plant_step(), 0.0).unwrap();
    run(&mut plant, law, &mut Sensors::new(SensorModel::default()), reference, clock)
}

fn linear() -> Paper {
    Paper { velocity_limit: f64::INFINITY, ..Paper::default() }
}

fn farthest(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    assert!(a.iter().chain(b).all(|x| x.is_finite()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Gains of the paper: unity, current, strong.
const GAINS: [(f64, f64); 3] = [(1.0, 0.0), (3.70205, 0.61701), (10.0, 1.0)];
const TICKS: usize = 20_000;

#[test]
fn step_response_is_its_closed_form() {
    for (kp, ki) in GAINS {
        let trace = simulate(linear(), &mut PlainPi::new(kp, ki, RATE), &[1.0; TICKS]);
        let closed = ClosedLoop::new(&linear(), kp, ki).response(C::new(0.0, 0.0), TICKS);
        let exact: Vec<f64> = closed.iter().map(|x| x.re).collect();
        let off = farthest(&trace.displacement, &exact);
        println!("step, kp {kp}: farthest from the closed form {off:.1e} of the amplitude");
        assert!(off < 1e-6);
    }
}

#[test]
fn sine_response_is_its_closed_form() {
    for (kp, ki) in GAINS {
        for hz in [0.1, 1.0, 6.0] {
            let w = std::f64::consts::TAU * hz / RATE;
            let reference: Vec<f64> = (0..TICKS).map(|k| (w * k as f64).sin()).collect();
            let trace = simulate(linear(), &mut PlainPi::new(kp, ki, RATE), &reference);
            let closed = ClosedLoop::new(&linear(), kp, ki).response(C::new(0.0, w).exp() - 1.0, TICKS);
            let exact: Vec<f64> = closed.iter().map(|x| x.im).collect();
            let off = farthest(&trace.displacement, &exact);
            println!("sine {hz} Hz, kp {kp}: farthest from the closed form {off:.1e} of the amplitude");
            assert!(off < 1e-6);
        }
    }
}

/// The check can fail: a tick of delay, or a gain off by a part in a thousand, is far outside it.
#[test]
fn closed_form_tells_a_delay_and_a_gain() {
    let exact: Vec<f64> =
        ClosedLoop::new(&linear(), 10.0, 1.0).response(C::new(0.0, 0.0), TICKS).iter().map(|x| x.re).collect();
    let mut late = simulate(linear(), &mut PlainPi::new(10.0, 1.0, RATE), &[1.0; TICKS]).displacement;
    late.rotate_right(1);
    late[0] = 0.0;
    assert!(farthest(&late, &exact) > 1e-3);
    let off = simulate(linear(), &mut PlainPi::new(10.01, 1.0, RATE), &[1.0; TICKS]);
    assert!(farthest(&off.displacement, &exact) > 1e-4);
}

/// While the limiter works, every tick moves the table by 0.242 m/s times its length, and by nothing else.
#[test]
fn saw_tooth_slope_is_the_limit() {
    let w = std::f64::consts::TAU * 2.0 / RATE;
    let reference: Vec<f64> = (0..5000).map(|k| 0.075 * (w * f64::from(k)).sin()).collect();
    let trace = simulate(Paper::default(), &mut PlainPi::new(3.70205, 0.61701, RATE), &reference);
    assert!(trace.velocity.iter().all(|v| v.abs() <= 0.242));
    // A tick that starts at the limit and is flagged half way lies in it whole unless it is the stretch's last.
    let inside = |k: usize| trace.velocity[k].abs() == 0.242 && trace.velocity[k + 1] == trace.velocity[k];
    let flat: Vec<usize> = (0..4998).filter(|&k| inside(k) && trace.flags[k].saturated).collect();
    assert!(flat.len() > 2000, "only {} ticks at the limit", flat.len());
    for &k in &flat {
        let slope = (trace.displacement[k + 1] - trace.displacement[k]) * RATE;
        assert!((slope - trace.velocity[k]).abs() < 1e-12, "tick {k}: {slope}");
    }
}

/// The control core, in `f32`, against the same law in `f64`.
#[test]
fn the_core_is_the_law() {
    for (kp, ki) in GAINS {
        let gains = PublishedGains { displacement: (kp, ki), acceleration: (0.0, 0.0), velocity: (0.0, 0.0) };
        // The core holds the gains as f32; the law it is held against has the same.
        let (kp, ki) = (f64::from(kp as f32), f64::from(ki as f32));
        for amplitude in [0.01, 0.1] {
            let w = std::f64::consts::TAU * 1.0 / RATE;
            let sine: Vec<f64> = (0..TICKS).map(|k| amplitude * (w * k as f64).sin()).collect();
            for (name, reference) in [("step", vec![amplitude; TICKS]), ("sine", sine)] {
                let mut core = Controller::new(&settings(gains, RATE)).unwrap();
                let core = simulate(linear(), &mut core, &reference);
                let law = simulate(linear(), &mut PlainPi::new(kp, ki, RATE), &reference);
                let off = farthest(&core.displacement, &law.displacement) / amplitude;
                println!("{name} of {amplitude} m, kp {kp}: core {off:.1e} of the amplitude from the f64 law");
                assert!(off < 1e-6);
            }
        }
    }
}
