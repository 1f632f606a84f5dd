//! A motion as it is written: unknown are the acceleration's samples, linear in between, and their exact integrals.
//!
//! With it the spectrum that is fitted is the spectrum of the file, and the limits hold for what a reader integrates.

use super::super::super::{Motion, peak};
use super::super::Limits;
use super::super::convex::program::Program;

/// The variables of a written motion inside a program, and the rows of its limits.
pub(super) struct DriveVariables {
    /// First of the accelerations, in units of the reference's peak.
    first: usize,
    /// How many.
    pub(super) count: usize,
    /// The reference's peak acceleration, m/s2.
    pub(super) unit: f64,
}

/// Accelerations beyond so many times the reference's peak are not looked for.
const REACH: f64 = 20.0;

impl DriveVariables {
    /// Adds a motion that keeps `limits`, starts at rest where `reference` starts, and ends at rest.
    pub(super) fn new(program: &mut Program, reference: &Motion, limits: &Limits) -> Self {
        let (count, dt) = (reference.len(), reference.dt);
        let drive = Self { first: program.variables(count, REACH), count, unit: peak(&reference.acceleration) };
        let velocity = program.variables(count, 1.0);
        let half = 0.5 * dt * drive.unit / limits.velocity;
        program.equal(&[(velocity, 1.0)], 0.0);
        program.equal(&[(velocity + count - 1, 1.0)], 0.0);
        for k in 1..count {
            let (now, before) = (velocity + k, velocity + k - 1);
            program.equal(&[(now, 1.0), (before, -1.0), (drive.at(k), -half), (drive.at(k - 1), -half)], 0.0);
            if k + 1 < count {
                program.within(&[(now, 1.0)], 1.0);
            }
        }
        drive.displacement(program, reference, limits, velocity);
        drive.forces(program, dt, limits);
        if let Some(stall) = limits.stall {
            let left = program.variables(count, 1.0);
            for k in 0..count {
                program.square_at_most(velocity + k, left + k);
                for side in [drive.unit / stall, -drive.unit / stall] {
                    program.at_most(&[(left + k, 1.0), (drive.at(k), side)], 1.0);
                }
            }
        }
        drive
    }

    /// The variable of the acceleration at sample `k`.
    pub(super) fn at(&self, k: usize) -> usize {
        self.first + k
    }

    /// Half the squared error of the samples, relative to the reference's: half of `E_a` squared.
    pub(super) fn waveform(&self, program: &mut Program, reference: &Motion) {
        let whole = reference.acceleration.iter().map(|a| a * a).sum::<f64>().sqrt();
        for (k, a) in reference.acceleration.iter().enumerate() {
            program.least_squares(&[(self.at(k), self.unit / whole)], a / whole);
        }
    }

    /// The motion of a solution.
    pub(super) fn motion(&self, reference: &Motion, x: &[f64]) -> Motion {
        let acceleration = x[self.first..self.first + self.count].iter().map(|a| a * self.unit).collect();
        Motion::from_state(reference.dt, acceleration, reference.displacement.first().copied().unwrap_or(0.0), 0.0)
    }

    fn displacement(&self, program: &mut Program, reference: &Motion, limits: &Limits, velocity: usize) {
        if limits.stroke.is_none() && limits.end.is_none() {
            return;
        }
        let (dt, start) = (reference.dt, reference.displacement.first().copied().unwrap_or(0.0));
        let unit = limits.stroke.unwrap_or(start.abs() + limits.velocity * dt * self.count as f64);
        let first = program.variables(self.count, 1.0);
        let (speed, sixth) = (dt * limits.velocity / unit, dt * dt * self.unit / (6.0 * unit));
        program.equal(&[(first, 1.0)], start / unit);
        for k in 1..self.count {
            let (now, before) = (first + k, first + k - 1);
            let terms = [
                (now, 1.0),
                (before, -1.0),
                (velocity + k - 1, -speed),
                (self.at(k - 1), -2.0 * sixth),
                (self.at(k), -sixth),
            ];
            program.equal(&terms, 0.0);
            if limits.stroke.is_some() {
                program.within(&[(now, 1.0)], 1.0);
            }
        }
        if let Some(end) = limits.end {
            program.equal(&[(first + self.count - 1, 1.0)], end / unit);
        }
    }

    fn forces(&self, program: &mut Program, dt: f64, limits: &Limits) {
        if let Some(most) = limits.acceleration {
            for k in 0..self.count {
                program.within(&[(self.at(k), self.unit / most)], 1.0);
            }
        }
        if let Some(most) = limits.jerk {
            let scale = self.unit / (dt * most);
            for k in 1..self.count {
                program.within(&[(self.at(k), scale), (self.at(k - 1), -scale)], 1.0);
            }
        }
    }
}
