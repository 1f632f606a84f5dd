//! The fit that keeps the response spectrum over a band of periods and lets the waveform go where it must.
//!
//! The response of an oscillator is linear in the motion, and its peak is what the spectrum shows. Asking that the
//! response stays below (1 + tolerance) `S_a` at every time, and reaches (1 - tolerance) `S_a` at a chosen time and with a
//! chosen sign, is convex. The constraints are too many to write down (every time of every period), so they are added
//! where the last motion broke them, the worst among neighbouring periods, until none is broken. Where the tolerance
//! cannot be met with the peaks of the reference, each period is asked to peak where the last motion did, which can only
//! lower the deviation, until that gains nothing. Among motions that keep the spectrum the one with the nearest waveform
//! wins. What is fitted is the motion as it is written, acceleration linear between samples, and so is its spectrum.
//!
//! Whether one period can be met at all is a closed form, [`Ordinate::reachable`]: no motion within the velocity limit, of any
//! length, has a larger spectral ordinate there.

mod drive;
mod oscillator;
mod search;

use super::super::Motion;
use super::{FitError, Limits, Reference};
pub(crate) use oscillator::{Oscillator, Peak};
use search::Search;

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
    /// 0.05 to 0.5 s at 5 % damping, within 5 %.
    pub const USUAL: Self = Self { shortest: 0.05, longest: 0.5, damping: 0.05, tolerance: 0.05 };

    /// Periods from `shortest` to `longest`, neighbours at most a tenth of the oscillators' half-power bandwidth apart.
    pub fn periods(&self) -> Vec<f64> {
        let steps = ((self.longest / self.shortest).ln() / (0.2 * self.damping)).ceil().max(1.0);
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
    /// The motion, as it is written.
    pub motion: Motion,
    /// The band, period by period.
    pub ordinates: Vec<Ordinate>,
    /// Largest relative deviation over the band.
    pub deviation: f64,
    /// With the peaks chosen no motion within the limits has a smaller largest deviation, by weak duality; `None` where
    /// the spectrum is kept.
    pub bound: Option<f64>,
    /// Programs solved.
    pub rounds: usize,
}

/// Programs solved at most.
const ROUNDS: usize = 25;
/// Choosing other peaks has to lower the deviation by this share to be tried again.
const WORTH: f64 = 0.03;

/// The motion within `limits` that keeps `band` of the reference's spectrum, as near to its waveform as that leaves; where
/// none is found, the one with the smallest deviation that was. `progress` is told each round and its deviation.
pub(crate) fn fit(
    reference: &Motion,
    limits: &Limits,
    band: &Band,
    mut progress: impl FnMut(usize, f64),
) -> Result<SpectrumFit, FitError> {
    let start = reference.displacement.first().copied().unwrap_or(0.0);
    limits.check(&Reference::new(reference.dt, reference.velocity.clone(), start)?)?;
    band.check(reference.dt)?;
    let mut search = Search::new(reference, limits, band)?;
    let mut best: Option<SpectrumFit> = None;
    let mut before = f64::INFINITY;
    for round in 1..=ROUNDS {
        let (motion, excess) = search.solve()?;
        let broken = search.hold_to(&motion, excess);
        let found = search.judged(motion, round);
        progress(round, found.deviation);
        let (deviation, better) = (found.deviation, best.as_ref().is_none_or(|b| found.deviation < b.deviation));
        if better {
            best = Some(found);
        }
        if broken {
            continue;
        }
        if deviation <= band.tolerance || deviation > before * (1.0 - WORTH) {
            break;
        }
        before = deviation;
        if let Some(best) = &best {
            search.aim_at(&best.motion);
        }
    }
    let mut best = best.ok_or_else(|| FitError::Solver("no round was solved".into()))?;
    if best.deviation > band.tolerance {
        best.bound = Some(search.least_deviation()?);
    }
    Ok(best)
}
