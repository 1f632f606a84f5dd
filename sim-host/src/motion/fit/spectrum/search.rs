//! The constraints on the spectrum, gathered as motions break them.

use super::super::super::Motion;
use super::super::convex::program::{Program, Solution};
use super::super::{FitError, Limits};
use super::drive::DriveVariables;
use super::{Band, Ordinate, Oscillator, Peak, SpectrumFit};

/// The share of the tolerance kept in hand: half of it for constraints broken by so little that they need not be added,
/// half for what lies between the periods and the points looked at.
const SLACK: f64 = 0.08;
/// Weight of the tolerance exceeded against half of `E_a` squared: large enough that it is exceeded only where it must be.
const PENALTY: f64 = 100.0;
/// Relative accuracy asked of the solver.
const TOLERANCE: f64 = 1e-6;
/// Peaks of one period that are held down in one round at most.
const HELD: usize = 4;
/// Periods to either side among which only the worst is held, or one aimed at, in one round: what it takes to mend one
/// mends its neighbours.
const NEIGHBOURS: usize = 3;

/// One period's target.
#[derive(Debug, Clone, Copy)]
struct Target {
    oscillator: Oscillator,
    /// The reference's `S_a`, m/s2.
    asked: f64,
    /// Where the fit has to come up to it: the reference's own peak, until another is chosen.
    aim: Peak,
    /// It has fallen short once, and is held to its aim since.
    aimed: bool,
}

/// The constraints so far.
pub(super) struct Search<'a> {
    reference: &'a Motion,
    limits: &'a Limits,
    band: &'a Band,
    targets: Vec<Target>,
    /// Peaks that must not be passed, by target.
    held: Vec<(usize, Peak)>,
}

impl<'a> Search<'a> {
    /// No constraint yet; the reference has to move.
    pub(super) fn new(reference: &'a Motion, limits: &'a Limits, band: &'a Band) -> Result<Self, FitError> {
        let target = |period| {
            let oscillator = Oscillator::new(period, band.damping);
            let aim = oscillator.peak(&reference.acceleration, reference.dt);
            Target { oscillator, asked: aim.value.abs(), aim, aimed: false }
        };
        let targets: Vec<Target> = band.periods().into_iter().map(target).filter(|t| t.asked > 0.0).collect();
        if targets.is_empty() {
            return Err(FitError::Reference("it does not move and has no spectrum to keep".into()));
        }
        Ok(Self { reference, limits, band, targets, held: Vec::new() })
    }

    /// The tolerance that the constraints ask for.
    fn tolerance(&self) -> f64 {
        self.band.tolerance * (1.0 - SLACK)
    }

    /// The nearest waveform under the constraints, and by how much their tolerance had to be exceeded.
    pub(super) fn solve(&self) -> Result<(Motion, f64), FitError> {
        let mut program = Program::default();
        let drive = DriveVariables::new(&mut program, self.reference, self.limits);
        drive.waveform(&mut program, self.reference);
        let (solution, excess) = self.constrained(program, &drive, PENALTY)?;
        Ok((drive.motion(self.reference, &solution.x), solution.x[excess].max(0.0)))
    }

    /// Below this deviation no motion within the limits comes that peaks where the constraints ask.
    pub(super) fn least_deviation(&self) -> Result<f64, FitError> {
        let mut program = Program::default();
        let drive = DriveVariables::new(&mut program, self.reference, self.limits);
        let (solution, _) = self.constrained(program, &drive, 1.0)?;
        Ok(self.tolerance() + solution.bound.max(0.0))
    }

    /// Solves under the constraints, each of them loosened by one variable that costs `weight`; gives its index too.
    fn constrained(
        &self,
        mut program: Program,
        drive: &DriveVariables,
        weight: f64,
    ) -> Result<(Solution, usize), FitError> {
        let far = self.targets.iter().map(|t| self.farthest(t)).fold(1.0, f64::max);
        let excess = program.variables(1, far);
        program.at_most(&[(excess, -1.0)], 0.0);
        program.cost(excess, weight);
        for target in self.targets.iter().filter(|target| target.aimed) {
            let terms = self.terms(drive, target, target.aim, -1.0, excess);
            program.at_most(&terms, self.tolerance() - 1.0);
        }
        for &(target, peak) in &self.held {
            let terms = self.terms(drive, &self.targets[target], peak, 1.0, excess);
            program.at_most(&terms, self.tolerance() + 1.0);
        }
        Ok((program.solve(TOLERANCE)?, excess))
    }

    /// The largest relative excess that a motion within the velocity limit can have.
    fn farthest(&self, target: &Target) -> f64 {
        1.0 + self.limits.velocity * target.oscillator.variation() / target.asked
    }

    /// The response at a peak's time, in units of the ordinate asked for and with the peak's sign times `side`, less the
    /// excess.
    fn terms(
        &self,
        drive: &DriveVariables,
        target: &Target,
        peak: Peak,
        side: f64,
        excess: usize,
    ) -> Vec<(usize, f64)> {
        let scale = side * peak.value.signum() * drive.unit / target.asked;
        let row = target.oscillator.row(peak.time, self.reference.dt, drive.count);
        row.map(|(k, weight)| (drive.at(k), scale * weight)).chain([(excess, -1.0)]).collect()
    }

    /// Adds the constraints that `motion` breaks; false where it breaks none.
    pub(super) fn hold_to(&mut self, motion: &Motion, excess: f64) -> bool {
        let most = self.tolerance() + excess + 0.5 * SLACK * self.band.tolerance;
        let peaks: Vec<Vec<Peak>> = self
            .targets
            .iter()
            .map(|t| t.oscillator.peaks(&motion.acceleration, motion.dt, t.asked * (1.0 - most)))
            .collect();
        let aimed = self.aim(&peaks);
        self.hold(&peaks, 1.0 + most) || aimed
    }

    /// Of periods whose peak passes `most` ordinates, holds down those that are the worst of their neighbours.
    fn hold(&mut self, peaks: &[Vec<Peak>], most: f64) -> bool {
        let relative = |k: usize, peak: &Peak| peak.value.abs() / self.targets[k].asked;
        let highest: Vec<f64> =
            peaks.iter().enumerate().map(|(k, p)| p.first().map_or(0.0, |peak| relative(k, peak))).collect();
        let worst = |k: usize| {
            let around = &highest[k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(highest.len())];
            highest[k] > most && around.iter().all(|x| *x <= highest[k])
        };
        let mut added = Vec::new();
        for (k, peaks) in peaks.iter().enumerate().filter(|(k, _)| worst(*k)) {
            added.extend(peaks.iter().filter(|peak| relative(k, peak) > most).take(HELD).map(|peak| (k, *peak)));
        }
        self.held.extend_from_slice(&added);
        !added.is_empty()
    }

    /// Of periods that no peak comes up to, aims at those whose shorter neighbours were not aimed at for the same reason.
    fn aim(&mut self, peaks: &[Vec<Peak>]) -> bool {
        let mut added = false;
        for k in (0..peaks.len()).filter(|&k| peaks[k].is_empty()) {
            let near = k.saturating_sub(NEIGHBOURS)..k;
            let lone = near.into_iter().all(|j| !(peaks[j].is_empty() && self.targets[j].aimed));
            if lone && !self.targets[k].aimed {
                self.targets[k].aimed = true;
                added = true;
            }
        }
        added
    }

    /// Aims at the peaks of a motion.
    pub(super) fn aim_at(&mut self, motion: &Motion) {
        for target in &mut self.targets {
            target.aim = target.oscillator.peak(&motion.acceleration, motion.dt);
        }
    }

    /// What `motion` comes to, after so many rounds.
    pub(super) fn judged(&self, motion: Motion, rounds: usize) -> SpectrumFit {
        let ordinate = |target: &Target| Ordinate {
            period: target.oscillator.period(),
            asked: target.asked,
            got: target.oscillator.peak(&motion.acceleration, motion.dt).value.abs(),
            reachable: self.limits.velocity * target.oscillator.variation(),
        };
        let ordinates: Vec<Ordinate> = self.targets.iter().map(ordinate).collect();
        let deviation = ordinates.iter().map(|o| o.deviation().abs()).fold(0.0, f64::max);
        SpectrumFit { motion, ordinates, deviation, bound: None, rounds }
    }
}
