//! The controllers that the tracking law is held against, each in the form in which it is usually described.
//!
//! All know the table's model; the first two read LVDT and accelerometer through the same observer, the third has one of its
//! own. Each is tuned as who sells it would: what the model gives is set by the model, the one number that is turned on site
//! is turned up until the margins or the noise forbid more ([`super::tune`]), and where there is a second one each of its usual
//! settings is tried at every bandwidth. They compute in `f64`, so that rounding is not held against them.

use super::super::design::Table;
use super::super::{Actuation, ControlLaw, Measured};
use nalgebra::{DMatrix, DVector};
use shakedown_core::blocks::filter::{MotionObserver, MotionState};
use std::f64::consts::TAU;

/// Noise that the observers are made for: the paper's laboratory, m and m/s2.
const NOISE: (f32, f32) = (1.15e-5, 0.196);

/// Displacement, velocity and acceleration of the table.
#[derive(Debug, Clone)]
struct Eyes {
    observer: Option<MotionObserver>,
    state: MotionState,
}

impl Eyes {
    fn new(rate: f64) -> Self {
        let observer = MotionObserver::kalman(NOISE.0, NOISE.1, (1.0 / rate) as f32).ok();
        Self { observer, state: MotionState::default() }
    }

    fn look(&mut self, measured: &Measured) -> [f64; 3] {
        if let Some(observer) = &self.observer {
            observer.advance(&mut self.state, measured.displacement as f32, measured.acceleration as f32);
        }
        [self.state.displacement, self.state.velocity, self.state.acceleration].map(f64::from)
    }
}

/// Largest command, as a multiple of the one whose flow is the velocity limit: the same for all.
const OVERDRIVE: f64 = 2.5;

fn most(table: &Table) -> f64 {
    OVERDRIVE * table.velocity_limit * table.a1 / table.b0
}

fn send(valve: f64, most: f64, measured: &Measured) -> Actuation {
    Actuation { valve: valve.clamp(-most, most), reference: measured.reference, saturated: false, held: false }
}

/// Three-variable control with feedforward, as sold today:
///
/// ```text
/// u = (a1/b0) (v_r + kfa a_r + kfj j_r + w (x_r - x) + kv (v_r - v) + ka (a_r - a))
/// kfa = 1/a1 - b1/b0 + 2 zeta/wh,   kfj = 1/wh^2 + (1/a1 - b1/b0) 2 zeta/wh,   ka = 2 (0.7 - zeta) / wh
/// ```
/// w the bandwidth, in rad/s, and kv the velocity gain, one of [`VELOCITY_GAINS`], are tuned on the table; `ka` damps the oil
/// column to 0.7, and is 0 where it is stiff.
#[derive(Debug, Clone)]
pub(crate) struct ThreeVariable {
    per_gain: f64,
    bandwidth: f64,
    velocity: f64,
    forward: [f64; 2],
    damping: f64,
    rate: f64,
    eyes: Eyes,
    before: f64,
    most: f64,
}

impl ThreeVariable {
    /// For `table` with a bandwidth of `hz` and a gain on the velocity error of `velocity` (1) at `rate` (Hz).
    pub(crate) fn new(table: &Table, (hz, velocity): (f64, f64), rate: f64) -> Self {
        let lead = 1.0 / table.a1 - table.b1 / table.b0;
        let (forward, damping) = match table.oil {
            None => ([lead, 0.0], 0.0),
            Some((frequency, damping)) => {
                let (w, c) = (TAU * frequency, 2.0 * damping / (TAU * frequency));
                ([lead + c, 1.0 / (w * w) + lead * c], 2.0 * (0.7 - damping).max(0.0) / w)
            }
        };
        let (per_gain, bandwidth, eyes) = (table.a1 / table.b0, TAU * hz, Eyes::new(rate));
        Self { per_gain, bandwidth, velocity, forward, damping, rate, eyes, before: 0.0, most: most(table) }
    }
}

impl ControlLaw for ThreeVariable {
    fn step(&mut self, m: &Measured) -> Actuation {
        let [x, v, a] = self.eyes.look(m);
        let jerk = (m.reference_acceleration - self.before) * self.rate;
        self.before = m.reference_acceleration;
        let forward = m.reference_velocity + self.forward[0] * m.reference_acceleration + self.forward[1] * jerk;
        let back = self.bandwidth * (m.reference - x)
            + self.velocity * (m.reference_velocity - v)
            + self.damping * (m.reference_acceleration - a);
        send(self.per_gain * (forward + back), self.most, m)
    }
}

/// Gains on the velocity error that are tried, 1.
pub(crate) const VELOCITY_GAINS: [f64; 5] = [0.0, 0.2, 0.5, 1.0, 2.0];

/// Linear-quadratic regulator with an integrator: the model's states held to the reference's, the integral of the
/// displacement error among them.
///
/// States `x, v` and, on an oil column, `a, q`; `v' = -a1 v + b0 u` or `q' = -a1 q + b0 u`. Weights: the square of the
/// displacement error, that of its integral times the square of a third of the bandwidth, and the square of
/// `a1 u / (b0 w)`.
#[derive(Debug, Clone)]
pub(crate) struct Lqi {
    gain: DVector<f64>,
    eyes: Eyes,
    /// Flow of the model, m/s, and its rate.
    flow: f64,
    valve: (f64, f64),
    sum: f64,
    dt: f64,
    oil: bool,
    most: f64,
}

impl Lqi {
    /// For `table` with a bandwidth of `hz` at `rate` (Hz).
    pub(crate) fn new(table: &Table, hz: f64, rate: f64) -> Self {
        let (dt, w) = (1.0 / rate, TAU * hz);
        let (a, b) = continuous(table);
        let n = a.nrows();
        // The integral of the error is the first state.
        let mut full = DMatrix::zeros(n + 2, n + 2);
        full.view_mut((1, 1), (n, n)).copy_from(&a);
        full[(0, 1)] = 1.0;
        full.view_mut((1, n + 1), (n, 1)).copy_from(&b);
        let step = exponential(&(full * dt));
        let (a, b) = (step.view((0, 0), (n + 1, n + 1)).into_owned(), step.view((0, n + 1), (n + 1, 1)).into_owned());
        let mut q = DMatrix::zeros(n + 1, n + 1);
        (q[(0, 0)], q[(1, 1)]) = ((w / 3.0).powi(2), 1.0);
        let r = (table.b0 / table.a1 / w).powi(2);
        let gain = regulator(&a, &b, &q, r);
        let valve = ((-table.a1 * dt).exp(), table.b0 / table.a1);
        Self {
            gain,
            eyes: Eyes::new(rate),
            flow: 0.0,
            valve,
            sum: 0.0,
            dt,
            oil: table.oil.is_some(),
            most: most(table),
        }
    }
}

/// The model's continuous states: x, v and, on an oil column, a, q.
fn continuous(table: &Table) -> (DMatrix<f64>, DVector<f64>) {
    match table.oil {
        None => (DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -table.a1]), DVector::from_row_slice(&[0.0, table.b0])),
        Some((frequency, damping)) => {
            let w = TAU * frequency;
            #[rustfmt::skip]
            let a = [
                0.0, 1.0, 0.0, 0.0,
                0.0, 0.0, 1.0, 0.0,
                0.0, -w * w, -2.0 * damping * w, w * w,
                0.0, 0.0, 0.0, -table.a1,
            ];
            (DMatrix::from_row_slice(4, 4, &a), DVector::from_row_slice(&[0.0, 0.0, 0.0, table.b0]))
        }
    }
}

/// The exponential of a small matrix, by its series after halving.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let scaled = matrix / 1024.0;
    let mut term = DMatrix::identity(matrix.nrows(), matrix.nrows());
    let mut sum = term.clone();
    for i in 1..12 {
        term = &term * &scaled / f64::from(i);
        sum += &term;
    }
    (0..10).fold(sum, |m, _| &m * &m)
}

/// The discrete regulator's gains, by iterating Riccati's equation to rest.
fn regulator(a: &DMatrix<f64>, b: &DMatrix<f64>, q: &DMatrix<f64>, r: f64) -> DVector<f64> {
    let mut p = q.clone();
    let mut gain = DMatrix::zeros(1, a.nrows());
    for _ in 0..20_000 {
        let scale = (b.transpose() * &p * b)[(0, 0)] + r;
        let next = b.transpose() * &p * a / scale;
        p = q + a.transpose() * &p * (a - b * &next);
        p = (&p + p.transpose()) * 0.5;
        let moved = (&next - &gain).norm();
        gain = next;
        if moved < 1e-12 * gain.norm() {
            break;
        }
    }
    gain.row(0).transpose()
}

impl ControlLaw for Lqi {
    fn step(&mut self, m: &Measured) -> Actuation {
        let [x, v, a] = self.eyes.look(m);
        let error = m.reference - x;
        self.sum += self.dt * error;
        let rates = [error, m.reference_velocity - v];
        let mut u = self.gain[0] * self.sum + self.gain[1] * rates[0] + self.gain[2] * rates[1];
        if self.oil {
            u += self.gain[3] * (m.reference_acceleration - a) + self.gain[4] * (m.reference_velocity - self.flow);
        }
        let out = send(u, self.most, m);
        if out.valve != u {
            // Nothing is summed up that cannot be asked for.
            self.sum -= self.dt * error;
        }
        let (kept, settled) = self.valve;
        self.flow = kept * self.flow + (1.0 - kept) * settled * out.valve;
        out
    }
}

/// Linear active disturbance rejection of second order (Gao 2003), its observer so many times as wide as its loop:
///
/// ```text
/// e = x - z1;  z1' = z2 + 3 wo e;  z2' = z3 + b0 u + 3 wo^2 e;  z3' = wo^3 e,   wo = ratio wc
/// u = (wc^2 (x_r - z1) + 2 wc (v_r - z2) + a_r - z3) / b0
/// ```
/// wc, in rad/s, and the ratio, one of [`OBSERVER_RATIOS`], are tuned on the table.
#[derive(Debug, Clone)]
pub(crate) struct Adrc {
    b0: f64,
    loop_: f64,
    observer: f64,
    dt: f64,
    state: [f64; 3],
    command: f64,
    most: f64,
}

/// Widths of the observer over that of the loop that are tried, 1.
pub(crate) const OBSERVER_RATIOS: [f64; 3] = [3.0, 6.0, 10.0];

impl Adrc {
    /// For `table` with a loop of `hz` and an observer `ratio` times as wide at `rate` (Hz).
    pub(crate) fn new(table: &Table, (hz, ratio): (f64, f64), rate: f64) -> Self {
        let wc = TAU * hz;
        // No faster than the sampled observer is stable.
        let observer = (ratio * wc).min(0.3 * rate);
        Self { b0: table.b0, loop_: wc, observer, dt: 1.0 / rate, state: [0.0; 3], command: 0.0, most: most(table) }
    }
}

impl ControlLaw for Adrc {
    fn step(&mut self, m: &Measured) -> Actuation {
        let ([z1, z2, z3], w, dt) = (self.state, self.observer, self.dt);
        let predicted = z1 + dt * z2;
        let e = m.displacement - predicted;
        self.state = [
            predicted + 3.0 * w * dt * e,
            z2 + dt * (z3 + self.b0 * self.command) + 3.0 * w * w * dt * e,
            z3 + w * w * w * dt * e,
        ];
        let [z1, z2, z3] = self.state;
        let wc = self.loop_;
        let wanted = wc * wc * (m.reference - z1) + 2.0 * wc * (m.reference_velocity - z2);
        let out = send((wanted + m.reference_acceleration - z3) / self.b0, self.most, m);
        self.command = out.valve;
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A double integrator with unit weights: the regulator's gains tend to 1 and the root of 3 as the tick shrinks.
    #[test]
    fn the_regulator_agrees_with_its_closed_form() {
        let dt = 1e-3;
        let a = DMatrix::from_row_slice(2, 2, &[1.0, dt, 0.0, 1.0]);
        let b = DMatrix::from_row_slice(2, 1, &[0.5 * dt * dt, dt]);
        let q = DMatrix::identity(2, 2) * dt;
        let gain = regulator(&a, &b, &q, dt);
        assert!((gain[0] - 1.0).abs() < 2e-3 && (gain[1] - 3f64.sqrt()).abs() < 2e-3, "{gain}");
    }

    /// A velocity error of 0.1 m/s alone: the command follows the equation at every gain that is tried.
    #[test]
    fn the_velocity_gain_is_the_one_that_is_documented() {
        let table = Table::default();
        let lags = Measured { reference_velocity: 0.1, ..Measured::default() };
        for gain in VELOCITY_GAINS {
            let sent = ThreeVariable::new(&table, (2.0, gain), 1000.0).step(&lags).valve;
            let wanted = table.a1 / table.b0 * (0.1 + gain * 0.1);
            assert!((sent / wanted - 1.0).abs() < 1e-9, "{gain}: {sent} for {wanted}");
        }
    }

    #[test]
    fn the_exponential_of_a_rotation_turns() {
        let turn = exponential(&DMatrix::from_row_slice(2, 2, &[0.0, -1.0, 1.0, 0.0]));
        assert!((turn[(0, 0)] - 1f64.cos()).abs() < 1e-12 && (turn[(1, 0)] - 1f64.sin()).abs() < 1e-12);
    }
}
