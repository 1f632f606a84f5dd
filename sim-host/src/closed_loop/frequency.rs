//! Stepped-sine frequency response of a closed loop, as the paper measured its table: one amplitude and one frequency
//! at a time, gain and phase of the response over the reference once the transient has died out.

use super::{Clock, ControlLaw, run};
use crate::plant::Plant;
use crate::plant::paper::Paper;
use crate::plant::sensors::{SensorModel, Sensors};
use nalgebra::{Complex, Matrix4, Vector4};
use std::f64::consts::TAU;

/// Response at one amplitude and frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Amplitude of the reference, m.
    pub amplitude: f64,
    /// Frequency, Hz.
    pub frequency: f64,
    /// Fundamental of the displacement over the reference, 1.
    pub gain: f64,
    /// Its phase, rad, negative where the table lags; within (-pi, pi].
    pub phase: f64,
    /// Share of the time spent at the velocity limit, 1.
    pub saturated: f64,
}

impl Point {
    /// Gain in decibels.
    pub fn decibels(&self) -> f64 {
        20.0 * self.gain.log10()
    }

    /// Phase in degrees.
    pub fn degrees(&self) -> f64 {
        self.phase.to_degrees()
    }
}

/// How long a point is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Dwell {
    /// Time for the transient, s; at least three cycles are given.
    pub settle: f64,
    /// Time measured over, s; at least two cycles are taken, and whole ones only.
    pub measure: f64,
}

impl Default for Dwell {
    /// 12 s and 5 s: the slowest mode of the paper's loops, Ki / Kp = 0.17 1/s, carries a few parts in a thousand.
    fn default() -> Self {
        Self { settle: 12.0, measure: 5.0 }
    }
}

/// Drives the loop with `amplitude` (m) at `frequency` (Hz) from rest, and fits the fundamental by least squares
/// beside an offset and a slope, which take what is left of the slow transient.
pub(crate) fn measure<P: Plant, L: ControlLaw>(
    plant: &mut P,
    law: &mut L,
    clock: Clock,
    (amplitude, frequency): (f64, f64),
    dwell: Dwell,
) -> Point {
    let whole = |seconds: f64, least: f64| (seconds * frequency).ceil().max(least) / frequency;
    let (settle, measured) = (whole(dwell.settle, 3.0), whole(dwell.measure, 2.0));
    let skip = (settle * clock.rate()).round() as usize;
    let n = skip + (measured * clock.rate()).round() as usize;
    let angle = |k: usize| TAU * frequency * k as f64 / clock.rate();
    let reference: Vec<f64> = (0..n).map(|k| amplitude * angle(k).sin()).collect();
    let trace = run(plant, law, &mut Sensors::new(SensorModel::default()), &reference, clock);
    let saturated = trace.flags[skip..].iter().filter(|f| f.saturated).count() as f64 / (n - skip) as f64;
    let fundamental = fundamental(&trace.displacement[skip..], |k| angle(k + skip));
    let response = fundamental / amplitude;
    Point { amplitude, frequency, gain: response.norm(), phase: response.arg(), saturated }
}

/// Complex amplitude of the sine in `values` whose angle at sample k is `angle(k)`; 1 is the sine itself.
fn fundamental(values: &[f64], angle: impl Fn(usize) -> f64) -> Complex<f64> {
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (k, &value) in values.iter().enumerate() {
        let (sine, cosine) = angle(k).sin_cos();
        let row = Vector4::new(sine, cosine, 1.0, k as f64 / values.len() as f64 - 0.5);
        normal += row * row.transpose();
        right += row * value;
    }
    normal.cholesky().map_or(Complex::new(f64::NAN, f64::NAN), |factor| {
        let fit = factor.solve(&right);
        Complex::new(fit[0], fit[1])
    })
}

/// The linear loop's response as the paper writes it, `H G / (1 + H G)` with `H = kp + ki / s`, in continuous time:
/// Eq. 6 where the gains are 3.7 and 0.6.
pub(crate) fn linear(paper: &Paper, (kp, ki): (f64, f64), frequency: f64) -> Complex<f64> {
    let s = Complex::new(0.0, TAU * frequency);
    let plant = (s * paper.b1 + paper.b0) / (s * s + s * paper.a1);
    let open = plant * (Complex::new(ki, 0.0) / s + kp);
    open / (open + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::PlainPi;
    use crate::plant::paper::FixedStep;

    fn point(limit: f64, gains: (f64, f64), amplitude: f64, frequency: f64) -> Point {
        let clock = Clock::new(1000.0, 2).unwrap();
        let paper = Paper { velocity_limit: limit, ..Paper::default() };
        let mut plant = FixedStep::new(paper, clock.plant_step(), 0.0).unwrap();
        let mut law = PlainPi::new(gains.0, gains.1, 1000.0);
        measure(&mut plant, &mut law, clock, (amplitude, frequency), Dwell::default())
    }

    #[test]
    fn unsaturated_points_lie_on_the_linear_curve() {
        for gains in [(1.0, 0.0), (3.7, 0.6), (10.0, 1.0)] {
            for frequency in [0.1, 0.7, 2.0, 6.0] {
                let point = point(f64::INFINITY, gains, 0.01, frequency);
                let exact = linear(&Paper::default(), gains, frequency);
                // What remains is the half tick of the zero-order hold, 180 degrees x 6 Hz x 1 ms at the most.
                assert!((point.decibels() - 20.0 * exact.norm().log10()).abs() < 0.1, "{gains:?} {frequency}");
                assert!((point.phase - exact.arg()).abs() < 0.02, "{gains:?} {frequency}");
            }
        }
    }

    #[test]
    fn the_linear_curve_is_the_papers_equation_6() {
        let s = Complex::new(0.0, TAU * 1.5);
        let eq6 = (s * s * 2.55 + s * 510.45 + 85.5) / (s * s * s + s * s * 60.23 + s * 510.35 + 85.0);
        let here = linear(&Paper::default(), (3.7, 0.6), 1.5);
        assert!((eq6 - here).norm() < 0.01);
    }

    #[test]
    fn large_amplitudes_roll_off_earlier() {
        let gains = (3.7, 0.6);
        let (small, large) = (point(0.242, gains, 0.001, 3.0), point(0.242, gains, 0.05, 3.0));
        assert_eq!(small.saturated, 0.0);
        assert!(large.saturated > 0.3 && large.decibels() < small.decibels() - 3.0);
        // A triangle of slope v_max has the peak v_max / (4 f), and a fundamental 8 / pi^2 of that.
        let triangle = 8.0 / std::f64::consts::PI.powi(2) * 0.242 / (4.0 * 3.0) / 0.05;
        assert!(large.gain < triangle * 1.01);
    }
}
