//! The fit that keeps the response spectrum over a band of periods and lets the waveform go where it must.
//!
//! The response of an oscillator is linear in the motion, and its peak is what the spectrum shows. Asking that the
//! response stays below (1 + tolerance) `S_a` at every time, and reaches (1 - tolerance) `S_a` at the time and with the
//! sign of the reference's own peak, is convex: with that choice of peaks the smallest tolerance found is the smallest
//! there is. The constraints are too many to write down (every time of every period), so they are added where the last
//! motion broke them, until none is broken. Among motions that keep the spectrum the one with the nearest waveform wins.
//!
//! Whether one period can be met at all is a closed form, [`reachable`]: no motion within the velocity limit, of any
//! length, has a larger spectral ordinate there.

mod oscillator;

use super::convex::program::Program;
use super::convex::{self, Motion};
use super::{FitError, Fitted, Limits, Norm, Reference};
pub use oscillator::{Oscillator, Peak};

/// What of the spectrum has to be kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Shortest period, s.
    pub shortest: f64,
    /// Longest period, s.
    pub longest: f64,
    /// Damping ratio of the oscillators, 1.
    pub damping: f64,
    /// Largest relative deviation of `S_a`, 1.
    pub tolerance: f64,
}

impl Band {
    /// Periods from `shortest` to `longest`, neighbours at most a fifth of the oscillators' half-power bandwidth apart.
    pub fn periods(&self) -> Vec<f64> {
        let steps = ((self.longest / self.shortest).ln() / (0.4 * self.damping)).ceil().max(1.0);
        (0..=steps as usize).map(|k| self.shortest * (self.longest / self.shortest).powf(k as f64 / steps)).collect()
    }

    fn check(&self, dt: f64) -> Result<(), FitError> {
        let ordered = self.shortest >= 2.0 * dt && self.longest >= self.shortest && self.longest.is_finite();
        if !ordered {
            return Err(FitError::Band(format!(
                "periods from {} to {} s: they have to rise from at least {} s, two samples",
                self.shortest,
                self.longest,
                2.0 * dt
            )));
        }
        if !(0.001..=0.5).contains(&self.damping) || !(0.001..=0.5).contains(&self.tolerance) {
            return Err(FitError::Band(format!(
                "damping {} and tolerance {}: both have to lie between 0.001 and 0.5",
                self.damping, self.tolerance
            )));
        }
        Ok(())
    }
}

/// One period of the band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ordinate {
    /// Period, s.
    pub period: f64,
    /// `S_a` of the reference, m/s2.
    pub asked: f64,
    /// `S_a` of the fit, m/s2.
    pub got: f64,
    /// No motion within the velocity limit has a larger `S_a`, m/s2.
    pub reachable: f64,
}

impl Ordinate {
    /// Relative deviation of the fit.
    pub fn deviation(&self) -> f64 {
        if self.asked > 0.0 { self.got / self.asked - 1.0 } else { 0.0 }
    }

    /// The factor on the velocity limit without which no motion comes within `tolerance` here; 1 where one may.
    pub fn velocity_factor(&self, tolerance: f64) -> f64 {
        (self.asked * (1.0 - tolerance) / self.reachable).max(1.0)
    }
}

/// A fit that keeps the spectrum, and what it reached.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumFit {
    /// The motion.
    pub fitted: Fitted,
    /// The band, period by period.
    pub ordinates: Vec<Ordinate>,
    /// Largest relative deviation over the band.
    pub deviation: f64,
    /// With these peaks no motion has a smaller largest deviation than this; at most the tolerance asked for where the
    /// spectrum is kept.
    pub smallest_tolerance: f64,
    /// Programs solved.
    pub rounds: usize,
}

/// Programs solved at most.
const ROUNDS: usize = 25;
/// The share of the tolerance kept in hand: constraints broken by less need not be added, and what integration makes of
/// the samples written ([`super::method`]) stays inside it.
const SLACK: f64 = 0.08;
/// Weight of the tolerance exceeded against half of `E_a` squared: large enough that it is exceeded only where it must be.
const PENALTY: f64 = 100.0;
/// Relative accuracy asked of the solver.
const TOLERANCE: f64 = 1e-6;

/// The motion within `limits` that keeps `band` of the reference's spectrum, as near to its waveform as that leaves.
/// `progress` is told each round and the deviation it left.
pub fn fit(
    reference: &Reference,
    limits: &Limits,
    band: &Band,
    mut progress: impl FnMut(usize, f64),
) -> Result<SpectrumFit, FitError> {
    limits.check(reference)?;
    band.check(reference.dt)?;
    let targets = targets(reference, band);
    let mut cuts: Vec<Cut> = targets.iter().map(Cut::reach).collect();
    let mut best: Option<SpectrumFit> = None;
    for round in 1..=ROUNDS {
        let (fitted, excess) = solve(reference, limits, band, &targets, &cuts)?;
        let broken = broken(reference, band, &targets, &fitted.velocity, excess);
        let ordinates = ordinates(reference, limits, &targets, &fitted.velocity);
        let deviation = ordinates.iter().map(|o| o.deviation().abs()).fold(0.0, f64::max);
        progress(round, deviation);
        let found = SpectrumFit {
            fitted,
            ordinates,
            deviation,
            smallest_tolerance: if excess > 1e-4 { band.tolerance + excess } else { band.tolerance },
            rounds: round,
        };
        if broken.is_empty() {
            return Ok(found);
        }
        if best.as_ref().is_none_or(|b| found.deviation < b.deviation) {
            best = Some(found);
        }
        cuts.extend(broken);
    }
    best.ok_or_else(|| FitError::Solver("no round was solved".into()))
}

/// The largest `S_a`, m/s2, that any motion within a `velocity` limit, m/s, can have at a period, s: the resonance that a
/// velocity switching between its limits builds up, velocity times the integral of the magnitude of the impulse
/// response's derivative.
pub fn reachable(period: f64, damping: f64, velocity: f64) -> f64 {
    let oscillator = Oscillator::new(period, damping);
    velocity * oscillator.variation()
}

/// One period's target: the reference's peak.
struct Target {
    oscillator: Oscillator,
    peak: Peak,
}

fn targets(reference: &Reference, band: &Band) -> Vec<Target> {
    band.periods()
        .into_iter()
        .map(|period| {
            let oscillator = Oscillator::new(period, band.damping);
            Target { oscillator, peak: oscillator.peak(&reference.velocity, reference.dt) }
        })
        .filter(|target| target.peak.value.abs() > 0.0)
        .collect()
}

/// One linear constraint on the response of one oscillator at one time.
#[derive(Debug, Clone, Copy)]
struct Cut {
    target: Oscillator,
    asked: f64,
    time: f64,
    sign: f64,
    reach: bool,
}

impl Cut {
    /// The response has to come up to the peak asked for.
    fn reach(target: &Target) -> Self {
        let (asked, sign) = (target.peak.value.abs(), target.peak.value.signum());
        Self { target: target.oscillator, asked, time: target.peak.time, sign, reach: true }
    }

    /// The response must not pass it here.
    fn stay(target: &Target, peak: Peak) -> Self {
        let (asked, sign) = (target.peak.value.abs(), peak.value.signum());
        Self { target: target.oscillator, asked, time: peak.time, sign, reach: false }
    }

    /// Adds the row: sign S(t) / asked against 1 -+ tolerance, `excess` loosening it.
    fn row(&self, program: &mut Program, motion: &Motion, dt: f64, tolerance: f64, excess: usize) {
        let scale = self.sign * motion.unit / self.asked * if self.reach { -1.0 } else { 1.0 };
        let mut terms: Vec<(usize, f64)> =
            self.target.row(self.time, dt, motion.count).map(|(k, weight)| (motion.at(k), scale * weight)).collect();
        terms.push((excess, -1.0));
        let tolerance = tolerance * (1.0 - SLACK);
        program.at_most(&terms, if self.reach { tolerance - 1.0 } else { tolerance + 1.0 });
    }
}

/// The nearest waveform under the cuts, and by how much the tolerance had to be exceeded.
fn solve(
    reference: &Reference,
    limits: &Limits,
    band: &Band,
    targets: &[Target],
    cuts: &[Cut],
) -> Result<(Fitted, f64), FitError> {
    let mut program = Program::default();
    let motion = Motion::new(&mut program, reference, limits);
    convex::waveform(&mut program, &motion, reference, Norm::Two);
    let far = targets.iter().map(|t| t.reach(limits.velocity)).fold(1.0, f64::max);
    let excess = program.variables(1, far);
    program.at_most(&[(excess, -1.0)], 0.0);
    program.cost(excess, PENALTY);
    for cut in cuts {
        cut.row(&mut program, &motion, reference.dt, band.tolerance, excess);
    }
    let solution = program.solve(TOLERANCE)?;
    Ok((Fitted { velocity: motion.velocity(&solution.x), bound: None }, solution.x[excess].max(0.0)))
}

impl Target {
    /// The largest relative excess a motion within the velocity limit can have here.
    fn reach(&self, velocity: f64) -> f64 {
        1.0 + velocity * self.oscillator.variation() / self.peak.value.abs()
    }
}

/// Constraints that `velocity` breaks, the worst of each period and sign.
fn broken(reference: &Reference, band: &Band, targets: &[Target], velocity: &[f64], excess: f64) -> Vec<Cut> {
    let most = 1.0 + band.tolerance + excess;
    targets
        .iter()
        .flat_map(|target| {
            let asked = target.peak.value.abs();
            let peaks = target.oscillator.peaks(velocity, reference.dt, asked * most);
            peaks.into_iter().map(|peak| Cut::stay(target, peak)).collect::<Vec<_>>()
        })
        .collect()
}

fn ordinates(reference: &Reference, limits: &Limits, targets: &[Target], velocity: &[f64]) -> Vec<Ordinate> {
    targets
        .iter()
        .map(|target| Ordinate {
            period: target.oscillator.period(),
            asked: target.peak.value.abs(),
            got: target.oscillator.peak(velocity, reference.dt).value.abs(),
            reachable: limits.velocity * target.oscillator.variation(),
        })
        .collect()
}
