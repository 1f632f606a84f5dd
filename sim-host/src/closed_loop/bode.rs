//! Bode diagrams of the closed loop at several amplitudes: Figs. 4, 5 and 10.

use super::frequency::{Dwell, Point, measure};
use super::published::PublishedGains;
use super::{Clock, ClosedLoopError, ControlLaw, named};
use crate::plant::Plant;
use crate::plant::paper::{FixedStep, Paper};
use rayon::prelude::*;
use shakedown_core::Controller;

/// What a diagram covers.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Amplitudes of the reference, m.
    pub amplitudes: Vec<f64>,
    /// Frequencies, Hz, ascending.
    pub frequencies: Vec<f64>,
}

impl Grid {
    /// The paper's: 1 to 120 mm, 0.1 to 6 Hz in steps of 0.1.
    pub fn paper() -> Self {
        Self {
            amplitudes: [1.0, 5.0, 10.0, 20.0, 50.0, 75.0, 100.0, 120.0].map(|mm| mm * 1e-3).to_vec(),
            frequencies: (1..=60).map(|i| f64::from(i) * 0.1).collect(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.amplitudes.len() * self.frequencies.len()
    }

    /// True where there is no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The response at one amplitude over all frequencies.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Amplitude of the reference, m.
    pub amplitude: f64,
    /// One point a frequency.
    pub points: Vec<Point>,
}

impl Curve {
    /// The lowest frequency (Hz) at which the gain has fallen by 3 dB, by interpolation; `None` where it stays above.
    pub fn bandwidth(&self) -> Option<f64> {
        let below = |p: &Point| p.decibels() <= -3.0;
        let i = self.points.iter().position(below)?;
        let Some(before) = i.checked_sub(1).map(|j| &self.points[j]) else { return Some(self.points[i].frequency) };
        let share = (before.decibels() + 3.0) / (before.decibels() - self.points[i].decibels());
        Some(before.frequency + share * (self.points[i].frequency - before.frequency))
    }

    /// The lowest frequency (Hz) at which the velocity limit is met.
    pub fn saturates_from(&self) -> Option<f64> {
        self.points.iter().find(|p| p.saturated > 0.0).map(|p| p.frequency)
    }

    /// Phase over frequency in degrees, without jumps of a turn.
    pub fn unwrapped_degrees(&self) -> Vec<f64> {
        let mut last = 0.0;
        let unwrap = |p: &Point| {
            last += (p.degrees() - last + 180.0).rem_euclid(360.0) - 180.0;
            last
        };
        self.points.iter().map(unwrap).collect()
    }

    /// The curve in the units of its keys, as `shakedown sweep bode` writes it.
    pub fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "amplitude_m": self.amplitude,
            "bandwidth_hz": self.bandwidth(),
            "saturates_from_hz": self.saturates_from(),
            "points": self.points.iter().map(|p| serde_json::json!({
                "frequency_hz": p.frequency, "gain_db": p.decibels(), "phase_deg": p.degrees(), "saturated": p.saturated,
            })).collect::<Vec<_>>(),
        })
    }
}

/// Whether the displacement loop with gains Kp (1) and Ki (1/s) settles around the paper's plant without its limit, by Routh's
/// criterion on (b1 s + b0)(Kp s + Ki) + s^2 (s + a1): the response of a loop that does not is a number without meaning.
pub fn settles((kp, ki): (f64, f64)) -> bool {
    let Paper { b1, b0, a1, .. } = Paper::default();
    let [c2, c1, c0] = [a1 + b1 * kp, b0 * kp + b1 * ki, b0 * ki];
    c2 > 0.0 && c1 > 0.0 && c0 >= 0.0 && c2 * c1 > c0 && kp <= 1e4
}

/// Measures the core's displacement loop with gains Kp (1) and Ki (1/s) at `rate` (Hz) around the paper's plant.
pub fn displacement_loop(
    gains: (f64, f64),
    rate: f64,
    grid: &Grid,
    done: impl Fn() + Sync,
) -> Result<Vec<Curve>, ClosedLoopError> {
    let clock = Clock::new(rate, 2)?;
    let settings =
        named::settings(PublishedGains { displacement: gains, acceleration: (0.0, 0.0), velocity: (0.0, 0.0) }, rate);
    let make = || Ok((FixedStep::new(Paper::default(), clock.plant_step(), 0.0)?, Controller::new(&settings)?));
    survey(grid, clock, make, done)
}

/// Measures every point of `grid`, each from rest on a loop that `make` sets up, over all cores; `done` is called after
/// each point.
pub fn survey<P: Plant, L: ControlLaw>(
    grid: &Grid,
    clock: Clock,
    make: impl Fn() -> Result<(P, L), ClosedLoopError> + Sync,
    done: impl Fn() + Sync,
) -> Result<Vec<Curve>, ClosedLoopError> {
    let point = |amplitude: f64, frequency: f64| {
        let (mut plant, mut law) = make()?;
        let point = measure(&mut plant, &mut law, clock, (amplitude, frequency), Dwell::default());
        done();
        Ok::<_, ClosedLoopError>(point)
    };
    let curve = |&amplitude: &f64| {
        let points = grid.frequencies.par_iter().map(|&frequency| point(amplitude, frequency));
        Ok(Curve { amplitude, points: points.collect::<Result<_, ClosedLoopError>>()? })
    };
    grid.amplitudes.par_iter().map(curve).collect()
}

/// The farthest two curves over the same frequencies lie apart: decibels and degrees.
pub fn farthest_apart(a: &Curve, b: &Curve) -> (f64, f64) {
    let pairs = || a.points.iter().zip(&b.points);
    let gain = pairs().map(|(a, b)| (a.decibels() - b.decibels()).abs()).fold(0.0, f64::max);
    let turn = |a: &Point, b: &Point| ((a.degrees() - b.degrees() + 180.0).rem_euclid(360.0) - 180.0).abs();
    (gain, pairs().map(|(a, b)| turn(a, b)).fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::PlainPi;
    use crate::plant::oil_column::{Column, Loaded};
    use crate::plant::paper::{FixedStep, Paper};

    fn clock() -> Clock {
        Clock::new(1000.0, 2).unwrap()
    }

    fn unloaded(gains: (f64, f64), grid: &Grid) -> Vec<Curve> {
        let make = || {
            let plant = FixedStep::new(Paper::default(), clock().plant_step(), 0.0)?;
            Ok((plant, PlainPi::new(gains.0, gains.1, 1000.0)))
        };
        survey(grid, clock(), make, || ()).unwrap()
    }

    /// Fig. 4: at unity gain the table's diagram is one of a first-order lag at 2.4 rad/s, whatever the amplitude; Fig. 5:
    /// at the gains in use it rolls off earlier the larger the motion.
    #[test]
    fn amplitude_matters_at_the_gains_in_use_only() {
        let grid = Grid { amplitudes: vec![0.001, 0.01, 0.1], frequencies: vec![0.2, 0.4, 0.8, 1.6, 3.2] };
        let unity = unloaded((1.0, 0.0), &grid);
        let (gain, phase) = farthest_apart(&unity[0], &unity[2]);
        assert!(gain < 0.05 && phase < 0.5, "{gain} dB, {phase} degrees");
        let bandwidth = unity[0].bandwidth().unwrap();
        assert!((bandwidth - 138.0 / 57.65 / std::f64::consts::TAU).abs() < 0.03, "{bandwidth} Hz");
        let current = unloaded((3.7, 0.6), &grid);
        let bandwidths: Vec<f64> = current.iter().map(|c| c.bandwidth().unwrap()).collect();
        assert!(bandwidths[0] > 1.4 && bandwidths[2] < 0.75 * bandwidths[0], "{bandwidths:?}");
        assert!(current[0].saturates_from().is_none() && current[2].saturates_from().is_some());
    }

    /// The paper bolts 5 t to the table and sees no change at 50 mm. The tolerance is what Fig. 4 could show.
    #[test]
    fn five_tonnes_leave_the_diagram_unchanged() {
        let grid = Grid { amplitudes: vec![0.05], frequencies: vec![0.5, 1.0, 3.0, 6.0] };
        let apart = |stiffness: f64| {
            let curve = |mass: f64| {
                let fine = Clock::new(1000.0, 10).unwrap();
                let column = Column { stiffness: stiffness * Column::usual(mass).stiffness, ..Column::usual(mass) };
                let make = || {
                    let plant = Loaded::new(Paper::default(), column, fine.plant_step())?;
                    Ok((plant, PlainPi::new(1.0, 0.0, 1000.0)))
                };
                survey(&grid, fine, make, || ()).unwrap().remove(0)
            };
            farthest_apart(&curve(5_000.0), &curve(10_000.0))
        };
        let (gain, phase) = apart(1.0);
        assert!(gain < 0.5 && phase < 3.0, "{gain} dB, {phase} degrees");
        // The check can fail: a column thirty times softer shows the mass.
        let (gain, phase) = apart(1.0 / 30.0);
        assert!(gain > 1.0 && phase > 10.0, "{gain} dB, {phase} degrees");
    }
}
