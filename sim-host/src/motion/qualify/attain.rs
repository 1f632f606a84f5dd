//! A motion that satisfies a standard within a table's limits, or the proof that none exists.
//!
//! Three ways are tried, the most like an earthquake first: random motion as [`super::synthesise()`] begins with; the same with its velocity
//! clipped and its spectrum corrected, again and again; and a sweep, whose amplitude at each frequency is what the limits leave and
//! the required spectrum needs. A sweep asks of the table least for what it gives, for it shakes one oscillator at a time; where a standard
//! asks for steadiness, it is made several times. What such a motion lacks of the zero-period acceleration a burst above the band adds.
//!
//! Where all fail, [`bound`] says of each frequency what no motion within the limits can pass, of any length; one frequency at which
//! that is less than what is required proves that none exists. Between the two a case is open, and called so.

pub mod bound;
mod proof;
mod random;
mod sweep;

use super::super::Motion;
use super::super::fit::Limits;
use super::{Ordinate, QualifyError, Requirement, ScoredModel, judge, rigid};
use proof::unreachable;

pub use proof::Unreachable;

/// How a motion was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// A record's, its velocity clipped and its spectrum corrected in rounds.
    Record,
    /// Sines of random phase under a trapezoid.
    Random,
    /// The same, its velocity clipped and its spectrum corrected in rounds.
    Clipped,
    /// A sweep from high frequencies to low ones.
    Sweep,
}

impl Way {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Record => "the record, its spectrum corrected",
            Self::Random => "random motion",
            Self::Clipped => "random motion, its velocity clipped",
            Self::Sweep => "sweep",
        }
    }
}

/// What came of it.
#[derive(Debug, Clone)]
pub enum Attained {
    /// A motion within the limits that satisfies the standard.
    Motion {
        /// The motion.
        motion: Motion,
        /// How it was made.
        way: Way,
        /// The standard's verdict.
        judged: ScoredModel,
        /// Why a record that it was to begin from is not in it: the rules that break with it; none where it is, or there was none.
        lost: Vec<&'static str>,
    },
    /// There is none.
    Impossible(Vec<Unreachable>),
    /// Neither was found; the best motion within the limits.
    Open {
        /// The motion; none where no way gave one within the limits.
        motion: Option<Motion>,
        /// Least of reached over required.
        margin: f64,
        /// The rules that it breaks.
        broken: Vec<&'static str>,
    },
}

/// Margin that motions are made with: what is between the points looked at, and rounding.
const MARGIN: f64 = 1.02;
/// Margin below which random motion is given up.
const NEAR: f64 = 0.85;
/// Seeds tried.
const SEEDS: u64 = 3;

/// A motion for a required spectrum within limits.
pub fn attain(asked: Requirement<'_>, limits: &Limits, seed: u64) -> Result<Attained, QualifyError> {
    attain_from(None, asked, limits, seed)
}

/// The same beginning with a record, which keeps its character where it can.
pub fn attain_from(
    record: Option<&Motion>,
    asked: Requirement<'_>,
    limits: &Limits,
    seed: u64,
) -> Result<Attained, QualifyError> {
    let proof = unreachable(asked, limits);
    if !proof.is_empty() {
        return Ok(Attained::Impossible(proof));
    }
    let mut best: Option<(Motion, ScoredModel)> = None;
    let mut without = Vec::new();
    if let Some(record) = record {
        let motion = random::corrected_from(record, asked, MARGIN, limits)?;
        if let Some(found) = accept(motion, Way::Record, asked, limits, &mut best)? {
            return Ok(found);
        }
        without = best.as_ref().map_or_else(|| vec!["the limits"], |(_, judged)| names(judged));
    }
    let found = made(asked, limits, seed, &mut best)?;
    Ok(match (found, best) {
        (Some(Attained::Motion { motion, way, judged, .. }), _) => {
            Attained::Motion { motion, way, judged, lost: without }
        }
        (Some(other), _) => other,
        (None, None) => Attained::Open { motion: None, margin: f64::NAN, broken: Vec::new() },
        (None, Some((motion, judged))) => {
            Attained::Open { margin: judged.margin, broken: names(&judged), motion: Some(motion) }
        }
    })
}

/// The rules that a motion breaks.
fn names(judged: &ScoredModel) -> Vec<&'static str> {
    judged.broken().map(|rule| rule.name).collect()
}

/// The ways that need no record, in turn.
fn made(
    asked: Requirement<'_>,
    limits: &Limits,
    seed: u64,
    best: &mut Option<(Motion, ScoredModel)>,
) -> Result<Option<Attained>, QualifyError> {
    for seed in seed..seed + SEEDS {
        let motion = random::plain(asked, MARGIN, seed)?;
        if let Some(found) = accept(motion, Way::Random, asked, limits, best)? {
            return Ok(Some(found));
        }
    }
    for seed in seed..seed + SEEDS {
        let motion = random::clipped(asked, MARGIN, limits, seed)?;
        if let Some(found) = accept(motion, Way::Clipped, asked, limits, best)? {
            return Ok(Some(found));
        }
        // What one seed misses by far no other reaches.
        if best.as_ref().is_none_or(|(_, judged)| judged.margin < NEAR) {
            break;
        }
    }
    for (k, cycles) in sweep::CYCLES.into_iter().enumerate() {
        if k > 0 && sweep::duration(asked.lowest, cycles) > sweep::LONGEST {
            continue;
        }
        let motion = sweep::sweep(asked, MARGIN, limits, cycles)?;
        let motion = if asked.standard.stationary.is_some() { sweep::repeated(&motion) } else { motion };
        if let Some(found) = accept(motion, Way::Sweep, asked, limits, best)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The motion where it keeps the limits and satisfies the standard; else it is kept where it is the best so far.
fn accept(
    motion: Motion,
    way: Way,
    asked: Requirement<'_>,
    limits: &Limits,
    best: &mut Option<(Motion, ScoredModel)>,
) -> Result<Option<Attained>, QualifyError> {
    let inside = |motion: &Motion| used(motion, limits) <= 1.0;
    if !inside(&motion) {
        return Ok(None);
    }
    let whole = rigid::raised(&motion, asked, inside).unwrap_or(motion);
    let judged = judge(&whole.acceleration, whole.dt, &[], asked)?;
    if judged.complies() {
        return Ok(Some(Attained::Motion { motion: whole, way, judged, lost: Vec::new() }));
    }
    if best.as_ref().is_none_or(|(_, b)| judged.margin > b.margin) {
        *best = Some((whole, judged));
    }
    Ok(None)
}

/// The largest share of a limit that a motion uses.
pub fn used(motion: &Motion, limits: &Limits) -> f64 {
    let (x, v) = motion.peaks_between();
    let (_, _, a) = motion.peaks();
    let over = |value: f64, limit: Option<f64>| limit.map_or(0.0, |limit| value / limit);
    let jerk = motion.acceleration.windows(2).map(|w| (w[1] - w[0]).abs() / motion.dt).fold(0.0, f64::max);
    let flow = limits.stall.map_or(0.0, |stall| {
        let of = |(v, a): (&f64, &f64)| (v / limits.velocity).powi(2) + a.abs() / stall;
        motion.velocity.iter().zip(&motion.acceleration).map(of).fold(0.0, f64::max)
    });
    [v / limits.velocity, over(x, limits.stroke), over(a, limits.acceleration), over(jerk, limits.jerk), flow]
        .into_iter()
        .fold(0.0, f64::max)
}

/// The spectrum that a motion reaches at frequencies (Hz), m/s2.
fn reached(acceleration: &[f64], dt: f64, damping: f64, frequencies: &[f64]) -> Result<Vec<f64>, QualifyError> {
    let periods: Vec<f64> = frequencies.iter().map(|f| 1.0 / f).collect();
    Ok(super::super::spectrum::response_spectrum(acceleration, dt, damping, &periods)?.s_a)
}

impl Attained {
    /// In a word.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Motion { .. } => "attained",
            Self::Impossible(_) => "impossible",
            Self::Open { .. } => "open",
        }
    }

    /// The spectra of a motion that was attained.
    pub fn ordinates(&self) -> &[Ordinate] {
        match self {
            Self::Motion { judged, .. } => &judged.ordinates,
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests;
