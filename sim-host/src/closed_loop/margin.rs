//! Stability margins of a loop as it runs: the very law and the very plant, nothing linearised by hand.
//!
//! With the reference at rest, the command gets one nudge of one tick. What the command then does is the impulse response
//! of the loop's sensitivity at the plant's input, `S = 1 / (1 + L)`; its transform gives `L = 1/S - 1` at any frequency,
//! and with it the margins. The law must be linear near rest and the plant must not meet its limits; the response must die
//! out, which is itself the proof that this loop is stable.

use super::{Actuation, Clock, ControlLaw, Measured, run};
use crate::plant::Plant;
use crate::plant::sensors::{SensorModel, Sensors};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// What a loop has to spare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Smallest factor, up or down, on the loop's gain that would make it oscillate, dB.
    pub gain_db: f64,
    /// Smallest phase that would, degrees.
    pub phase_degrees: f64,
    /// Highest frequency at which the loop's gain is 1, Hz.
    pub crossover_hz: f64,
    /// Largest sensitivity, 1.
    pub peak_sensitivity: f64,
    /// Root mean square of the sensitivity over [`BAND`], 1: what is left there of what acts on the plant's input.
    pub left: f64,
}

/// Where ground motions have their acceleration, Hz.
pub(crate) const BAND: (f64, f64) = (0.5, 10.0);

impl Margins {
    /// Whether both are at least these, dB and degrees.
    pub fn reach(&self, (gain_db, phase_degrees): (f64, f64)) -> bool {
        self.gain_db >= gain_db && self.phase_degrees >= phase_degrees
    }

    /// The smaller of two in every respect.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        Self {
            gain_db: self.gain_db.min(other.gain_db),
            phase_degrees: self.phase_degrees.min(other.phase_degrees),
            crossover_hz: self.crossover_hz.max(other.crossover_hz),
            peak_sensitivity: self.peak_sensitivity.max(other.peak_sensitivity),
            left: self.left.max(other.left),
        }
    }
}

/// The nudge, m: far above rounding, far below any limit.
const NUDGE: f64 = 0.01;
/// When it comes, ticks.
const AT: usize = 10;
/// How long its answer is watched, s.
const WATCHED: f64 = 3.0;
/// Share of the answer's peak that must not be left at the end.
const SETTLED: f64 = 1e-4;

/// A law whose command is nudged once.
struct Nudged<'a, L> {
    law: &'a mut L,
    tick: usize,
}

impl<L: ControlLaw> ControlLaw for Nudged<'_, L> {
    fn step(&mut self, measured: &Measured) -> Actuation {
        let out = self.law.step(measured);
        self.tick += 1;
        let nudge = if self.tick == AT + 1 { NUDGE } else { 0.0 };
        Actuation { valve: out.valve + nudge, ..out }
    }
}

/// The margins of `law` on `plant`, both at rest at centre; `None` where the loop is not stable. A law that reads no pressure.
pub(crate) fn margins<P: Plant, L: ControlLaw>(plant: &mut P, law: &mut L, clock: Clock) -> Option<Margins> {
    margins_with(plant, law, SensorModel::default(), clock)
}

/// The same with sensors of which at most a pressure's size is stated: their noise would hide the answer.
pub(crate) fn margins_with<P: Plant, L: ControlLaw>(
    plant: &mut P,
    law: &mut L,
    sensors: SensorModel,
    clock: Clock,
) -> Option<Margins> {
    open_loop_with(plant, law, sensors, clock).map(|points| read_off(&points))
}

/// The open loop at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Hz.
    pub frequency: f64,
    /// `L`, from the valve's command around to it, 1; an oscillation has -1.
    pub open: Complex<f64>,
}

impl Point {
    /// `S = 1 / (1 + L)`.
    fn sensitivity(&self) -> Complex<f64> {
        (self.open + 1.0).inv()
    }
}

/// The open loop from 0.2 Hz to half the rate, every frequency 1.5 % above the one before; none where the loop is not stable.
pub(crate) fn open_loop_with<P: Plant, L: ControlLaw>(
    plant: &mut P,
    law: &mut L,
    sensors: SensorModel,
    clock: Clock,
) -> Option<Vec<Point>> {
    let n = (WATCHED * clock.rate()) as usize;
    let mut sensors = Sensors::new(sensors);
    let trace = run(plant, &mut Nudged { law, tick: 0 }, &mut sensors, &vec![0.0; n], clock);
    let answer: Vec<f64> = trace.command[AT..].iter().map(|u| u / NUDGE).collect();
    let peak = answer.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    let end = answer[answer.len() * 9 / 10..].iter().fold(0.0_f64, |m, u| m.max(u.abs()));
    if !peak.is_finite() || end > SETTLED * peak {
        return None;
    }
    let rate = clock.rate();
    let grid = std::iter::successors(Some(0.2), |f| Some(f * 1.015)).take_while(|f| *f < 0.499 * rate);
    Some(grid.map(|frequency| Point { frequency, open: transform(&answer, rate, frequency).inv() - 1.0 }).collect())
}

/// `S` at a frequency (Hz) from its impulse response.
fn transform(answer: &[f64], rate: f64, frequency: f64) -> Complex<f64> {
    let turn = Complex::from_polar(1.0, -TAU * frequency / rate);
    // Horner's rule from the end.
    answer.iter().rev().fold(Complex::new(0.0, 0.0), |sum, &s| sum * turn + s)
}

fn read_off(points: &[Point]) -> Margins {
    let mut found =
        Margins { gain_db: 60.0, phase_degrees: 180.0, crossover_hz: 0.0, peak_sensitivity: 0.0, left: 0.0 };
    let (mut before, mut inside) = (None::<Complex<f64>>, 0.0);
    for point in points {
        let s = point.sensitivity();
        found.peak_sensitivity = found.peak_sensitivity.max(s.norm());
        if (BAND.0..=BAND.1).contains(&point.frequency) {
            found.left += s.norm_sqr();
            inside += 1.0;
        }
        if let Some(last) = before {
            cross(&mut found, last, point.open, point.frequency);
        }
        before = Some(point.open);
    }
    found.left = (found.left / inside).sqrt();
    found
}

/// Looks for crossings of the unit circle and of the negative real axis between two points of `L`.
fn cross(found: &mut Margins, last: Complex<f64>, here: Complex<f64>, frequency: f64) {
    if last.im * here.im < 0.0 {
        let at = last.re + last.im / (last.im - here.im) * (here.re - last.re);
        if at < 0.0 {
            found.gain_db = found.gain_db.min((20.0 * (-at).log10()).abs());
        }
    }
    let (a, b) = (last.norm() - 1.0, here.norm() - 1.0);
    if a * b < 0.0 {
        let at = last + (here - last) * (a / (a - b));
        found.phase_degrees = found.phase_degrees.min(180.0 - at.arg().to_degrees().abs());
        found.crossover_hz = frequency;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::PlainPi;
    use crate::plant::paper::{FixedStep, Paper};

    fn of(gain: f64) -> Option<Margins> {
        let clock = Clock::new(1000.0, 2).unwrap();
        let paper = Paper { velocity_limit: f64::INFINITY, ..Paper::default() };
        let mut plant = FixedStep::new(paper, clock.plant_step(), 0.0).unwrap();
        margins(&mut plant, &mut PlainPi::new(gain, 0.0, 1000.0), clock)
    }

    /// The sampled loop of Eq. 7 in closed form: its transfer function with a hold has two poles and is known exactly.
    #[test]
    fn a_proportional_loop_has_the_margins_of_its_closed_form() {
        let Paper { b1, b0, a1, .. } = Paper::default();
        let (dt, kept) = (1e-3, (-a1 * 1e-3_f64).exp());
        let lost = (1.0 - kept) / a1;
        let (direct, lag) = (b0 / a1 * dt, (b0 / a1 - b1) * lost);
        let open = |f: f64| {
            let z = Complex::from_polar(1.0, TAU * f * dt);
            // x[k+1] = x[k] + (direct - lag) u + lost l,  l[k+1] = kept l + (b0/a1 - b1)(1 - kept) u
            let l = (b0 / a1 - b1) * (1.0 - kept) / (z - kept);
            (l * lost + direct - lag) / (z - 1.0)
        };
        for gain in [10.0, 60.0] {
            let found = of(gain).unwrap();
            let f = found.crossover_hz;
            assert!((open(f / 1.0075).norm() * gain - 1.0).abs() < 0.02, "{found:?}");
            let phase = 180.0 + open(f / 1.0075).arg().to_degrees();
            assert!((found.phase_degrees - phase).abs() < 1.0, "{found:?} {phase}");
        }
    }

    #[test]
    fn a_loop_that_swings_has_none() {
        assert!(of(10.0).is_some());
        assert!(of(3000.0).is_none());
    }
}
