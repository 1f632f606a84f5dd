//! The convex fit: velocity, displacement, acceleration, jerk and the force-dependent flow limit at once.
//!
//! Unknown are the velocity at every sample and the displacement at some, tied by the trapezoidal rule. With n = v/V,
//! x = X s and D the forward difference, least squares minimises |V D n - D r|^2 / (2 |D r|^2), half the square of `E_a`;
//! the other norms are linear programs. Interior point (Clarabel), then weak duality evaluated here, so that the bound
//! returned holds whether or not the solver converged. Only limits that may bind are written down.

pub(crate) mod program;
mod watch;

use super::{FitError, Fitted, Limits, Reference};
use program::{Program, Solution};
use watch::Watch;

/// What is made small: the acceleration error in one of three norms, relative to the reference's acceleration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Norm {
    /// Root of summed squares: `E_a`.
    #[default]
    Two,
    /// Sum of magnitudes.
    One,
    /// Largest magnitude.
    Peak,
}

impl Norm {
    /// The relative acceleration error of `velocity`, m/s, against the reference.
    pub fn error(self, reference: &Reference, velocity: &[f64]) -> f64 {
        let whole = self.of(reference.velocity.windows(2).map(|w| w[1] - w[0]));
        let pairs = reference.velocity.windows(2).zip(velocity.windows(2));
        let error = self.of(pairs.map(|(r, v)| (r[1] - r[0]) - (v[1] - v[0])));
        if whole > 0.0 { error / whole } else { 0.0 }
    }

    fn of(self, signal: impl Iterator<Item = f64>) -> f64 {
        match self {
            Self::Two => signal.map(|x| x * x).sum::<f64>().sqrt(),
            Self::One => signal.map(f64::abs).sum(),
            Self::Peak => signal.map(f64::abs).fold(0.0, f64::max),
        }
    }
}

/// Relative accuracy asked of the solver.
const TOLERANCE: f64 = 1e-7;

/// The motion nearest to the reference in `norm` within all of `limits`, at rest at both ends.
pub fn fit(reference: &Reference, limits: &Limits, norm: Norm) -> Result<Fitted, FitError> {
    limits.check(reference)?;
    let whole = norm.of(reference.velocity.windows(2).map(|w| w[1] - w[0]));
    if whole == 0.0 && reference.velocity[0] == 0.0 {
        return Ok(Fitted { velocity: vec![0.0; reference.len()], bound: Some(0.0) });
    }
    let mut watch = Watch::first(reference, limits);
    let mut round = 1;
    loop {
        let (velocity, bound) = solve(reference, limits, norm, &watch)?;
        // With every sample watched there is nothing to add.
        if !watch.add(reference, limits, &velocity) {
            let limit = limits.velocity;
            let velocity = velocity.iter().map(|v| v.clamp(-limit, limit)).collect();
            return Ok(Fitted { velocity, bound: Some(bound) });
        }
        if round == watch::ROUNDS {
            watch = Watch::all(reference);
        }
        round += 1;
    }
}

/// The velocity, m/s, that is nearest within what is watched, and the bound proven.
fn solve(reference: &Reference, limits: &Limits, norm: Norm, watch: &Watch) -> Result<(Vec<f64>, f64), FitError> {
    let mut program = Program::default();
    let motion = MotionVariables::new(&mut program, reference, limits, watch);
    waveform(&mut program, &motion, reference, norm);
    let Solution { x, bound } = program.solve(TOLERANCE)?;
    let bound = match norm {
        // The program leaves out the constant, half of the relative reference squared.
        Norm::Two => (2.0 * (bound + 0.5)).max(0.0).sqrt(),
        Norm::One | Norm::Peak => bound.max(0.0),
    };
    Ok((motion.velocity(&x), bound))
}

/// The variables of a motion inside a program, and the rows of its limits.
struct MotionVariables {
    /// First of the velocities, in units of the limit.
    first: usize,
    /// How many.
    count: usize,
    /// The velocity limit, m/s.
    unit: f64,
}

impl MotionVariables {
    /// Adds a motion that keeps `limits` and rests at both ends.
    fn new(program: &mut Program, reference: &Reference, limits: &Limits, watch: &Watch) -> Self {
        let count = reference.len();
        let motion = Self { first: program.variables(count, 1.0), count, unit: limits.velocity };
        program.equal(&[(motion.at(0), 1.0)], 0.0);
        program.equal(&[(motion.at(count - 1), 1.0)], 0.0);
        for k in (1..count - 1).filter(|&k| watch.speed[k]) {
            program.within(&[(motion.at(k), 1.0)], 1.0);
        }
        motion.displacement(program, reference, limits, watch);
        motion.differences(program, reference.dt, limits);
        if let Some(stall) = limits.stall {
            motion.flow(program, reference.dt, stall);
        }
        motion
    }

    /// The variable of the velocity at sample `k`.
    fn at(&self, k: usize) -> usize {
        self.first + k
    }

    /// Velocities, m/s, of a solution.
    fn velocity(&self, x: &[f64]) -> Vec<f64> {
        x[self.first..self.first + self.count].iter().map(|n| self.unit * n).collect()
    }

    /// Displacement at the knots watched: from one to the next it moves by the velocity's integral.
    fn displacement(&self, program: &mut Program, reference: &Reference, limits: &Limits, watch: &Watch) {
        if limits.stroke.is_none() && limits.end.is_none() {
            return;
        }
        let farthest = reference.start.abs() + limits.velocity * reference.dt * self.count as f64;
        let unit = limits.stroke.unwrap_or(farthest);
        let knots: Vec<usize> = (0..self.count).filter(|&k| watch.knot[k]).collect();
        let first = program.variables(knots.len(), 1.0);
        let half = 0.5 * reference.dt * self.unit / unit;
        program.equal(&[(first, 1.0)], reference.start / unit);
        let mut terms = Vec::new();
        for (x, knot) in (first + 1..).zip(knots.windows(2)) {
            let (from, to) = (knot[0], knot[1]);
            terms.clear();
            terms.extend([(x, 1.0), (x - 1, -1.0), (self.at(from), -half), (self.at(to), -half)]);
            terms.extend((from + 1..to).map(|k| (self.at(k), -2.0 * half)));
            program.equal(&terms, 0.0);
            if limits.stroke.is_some() {
                program.within(&[(x, 1.0)], 1.0);
            }
        }
        if let Some(end) = limits.end {
            program.equal(&[(first + knots.len() - 1, 1.0)], end / unit);
        }
    }

    fn differences(&self, program: &mut Program, dt: f64, limits: &Limits) {
        if let Some(most) = limits.acceleration {
            let scale = self.unit / (dt * most);
            for k in 1..self.count {
                program.within(&[(self.at(k), scale), (self.at(k - 1), -scale)], 1.0);
            }
        }
        if let Some(most) = limits.jerk {
            let scale = self.unit / (dt * dt * most);
            for k in 2..self.count {
                let terms = [(self.at(k), scale), (self.at(k - 1), -2.0 * scale), (self.at(k - 2), scale)];
                program.within(&terms, 1.0);
            }
        }
    }

    /// v^2 <= V^2 (1 - |a| / stall) at both ends of every interval: n^2 <= w, w <= 1 -+ a / stall on either side.
    fn flow(&self, program: &mut Program, dt: f64, stall: f64) {
        let scale = self.unit / (dt * stall);
        let left = program.variables(self.count, 1.0);
        for k in 0..self.count {
            program.square_at_most(self.at(k), left + k);
            for (late, early) in [(k, k.wrapping_sub(1)), (k + 1, k)] {
                if early < self.count && late < self.count {
                    for side in [scale, -scale] {
                        program.at_most(&[(left + k, 1.0), (self.at(late), side), (self.at(early), -side)], 1.0);
                    }
                }
            }
        }
    }
}

/// The acceleration error in `norm`, relative to the reference's, becomes the objective.
fn waveform(program: &mut Program, motion: &MotionVariables, reference: &Reference, norm: Norm) {
    let whole = norm.of(reference.velocity.windows(2).map(|w| w[1] - w[0])).max(f64::MIN_POSITIVE);
    let scale = motion.unit / whole;
    let steps = reference.velocity.windows(2).map(|w| (w[1] - w[0]) / whole);
    // Beyond this no error of a motion within the limit can reach.
    let reach = 2.0 * scale + steps.clone().map(f64::abs).fold(0.0, f64::max);
    let peak = if norm == Norm::Peak { Some(program.variables(1, reach)) } else { None };
    for (k, step) in steps.enumerate() {
        let (early, late) = (motion.at(k), motion.at(k + 1));
        let error = match (norm, peak) {
            (Norm::Two, _) => {
                program.least_squares(&[(late, scale), (early, -scale)], step);
                continue;
            }
            (_, Some(peak)) => peak,
            (_, None) => program.variables(1, reach),
        };
        program.at_most(&[(late, scale), (early, -scale), (error, -1.0)], step);
        program.at_most(&[(late, -scale), (early, scale), (error, -1.0)], -step);
        if norm == Norm::One {
            program.cost(error, 1.0);
        }
    }
    if let Some(peak) = peak {
        program.cost(peak, 1.0);
    }
}
