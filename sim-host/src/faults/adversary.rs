//! Looks for the worst case of a class, by cross-entropy (Rubinstein 1999): deals many cases, keeps the worst tenth, and deals the
//! next from what those have in common.
//!
//! A case is what the dice make of a row of numbers in [0, 1): the first `NUMBERS` of them are the search's, the rest the run's
//! own. Every number has a mean and a standard deviation, moved after each generation towards those of the worst tenth. What makes
//! a case bad is how much of its promise it uses up, 1 being all of it: the way to the end of the stroke less the margin, the time
//! to the report, the way that the table may stray, how hard the specimen may be shaken.

use super::case::{Beside, Case};
use super::class::{Class, Promise};
use super::dice::FaultRng;
use super::motions::Motions;
use super::rig::RigError;
use super::watcher::{MARGIN, Outcome, ROUGH, STROKE, Violation, judge, softened};
use crate::files::json::{self, JsonError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Numbers of a case that the search chooses: more than any class deals.
const NUMBERS: usize = 36;
/// Cases of a generation, and how many of them the next is dealt from.
pub const GENERATION: u64 = 200;
const WORST: usize = 20;
/// How far a mean and a deviation move in a generation, and the least deviation that stays.
const STEP: f64 = 0.7;
const LEAST: f64 = 0.02;
/// Cases that broke a promise that are kept, and what they used of it at least.
const KEPT: usize = 8;
const BEYOND: f64 = 1.01;

/// A search, as far as it has come.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Search {
    /// The class.
    pub class: String,
    /// Seed.
    pub seed: u64,
    /// The aid beside the guard.
    pub beside: Beside,
    /// Runs so far.
    pub runs: u64,
    /// Of those, runs that broke a promise.
    pub broken: u64,
    /// Mean and standard deviation of each number.
    spread: Vec<(f64, f64)>,
    /// The worst case so far.
    pub worst: Option<Found>,
    /// The first of those that broke a promise.
    pub breaks: Vec<Found>,
}

/// A case that was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// How much of its promise it used up, 1.
    pub used: f64,
    /// The numbers that it is dealt from.
    pub numbers: Vec<f64>,
    /// What became of it.
    pub outcome: Outcome,
}

/// Why a search stopped.
#[derive(Debug, thiserror::Error)]
pub enum AdversaryError {
    /// A run could not begin.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// Its file could not be read or written.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// The file holds another search.
    #[error("{0}: another search was begun there; give another --out")]
    Other(std::path::PathBuf),
}

/// How much of what its `class` promises an outcome used up, 1; the specimen counts where it is `soft`, promised no more than the
/// envelope.
pub fn used(class: &Class, outcome: &Outcome, soft: bool) -> f64 {
    if !outcome.broken.is_empty() {
        return promised(class, outcome).max(BEYOND);
    }
    if outcome.ended {
        return 0.0;
    }
    promised(class, outcome).max(if soft { outcome.acceleration_m_s2 / ROUGH } else { 0.0 })
}

/// The same of what the class promises by itself.
fn promised(class: &Class, outcome: &Outcome) -> f64 {
    let way = outcome.farthest_m / (STROKE - MARGIN);
    match class.promise {
        Promise::Reported(_, within) => match outcome.latency_s {
            Some(latency) if outcome.visible => way.max(latency / within),
            _ if outcome.broken.contains(&Violation::Unreported) => way.max(2.0),
            _ => way,
        },
        Promise::Relay(_, within) => match outcome.latency_s {
            Some(latency) if outcome.visible => latency / within,
            _ if outcome.broken.contains(&Violation::Unreported) => 2.0,
            _ => 0.0,
        },
        Promise::Harmless(most) => way.max(outcome.beyond_null_m / most.max(1e-6)),
        Promise::Inside | Promise::Roomy { .. } | Promise::Aided | Promise::Measured => way,
    }
}

impl Search {
    /// A search that knows nothing yet.
    pub fn new(class: &Class, seed: u64, beside: Beside) -> Self {
        // A uniform number has mean 1/2 and this deviation.
        let spread = vec![(0.5, 0.289); NUMBERS];
        Self { class: class.id.into(), seed, beside, runs: 0, broken: 0, spread, worst: None, breaks: Vec::new() }
    }

    /// Deals the case that `numbers` are.
    pub fn deal(&self, class: &'static Class, numbers: &[f64], run: u64, motions: &Motions) -> Case {
        let dice = FaultRng::scripted(self.seed, run, numbers.to_vec());
        Case::deal_with(dice, run, Some(class), motions).beside(self.beside)
    }

    /// Deals it and judges it.
    fn judge(&self, class: &'static Class, numbers: &[f64], run: u64, motions: &Motions) -> Result<Found, RigError> {
        let case = self.deal(class, numbers, run, motions);
        let outcome = judge(&case)?;
        Ok(Found { used: used(class, &outcome, softened(&case)), numbers: numbers.to_vec(), outcome })
    }

    /// A case that it kept: the one of this number, or the worst.
    pub fn kept(&self, run: Option<u64>) -> Option<&Found> {
        let mut all = self.worst.iter().chain(&self.breaks);
        all.find(|found| run.is_none_or(|run| found.outcome.run == run))
    }

    /// One generation.
    fn advance(&mut self, class: &'static Class, motions: &Motions) -> Result<(), RigError> {
        let runs: Vec<u64> = (self.runs..self.runs + GENERATION).collect();
        let found: Result<Vec<Found>, RigError> =
            runs.par_iter().map(|&run| self.judge(class, &self.numbers(run), run, motions)).collect();
        let mut found = found?;
        found.sort_by(|a, b| b.used.total_cmp(&a.used).then(a.outcome.run.cmp(&b.outcome.run)));
        self.runs += GENERATION;
        let broken = || found.iter().filter(|one| !one.outcome.broken.is_empty());
        self.broken += broken().count() as u64;
        self.breaks.extend(broken().take(KEPT.saturating_sub(self.breaks.len())).cloned());
        let worst = found.get(..WORST).unwrap_or(&found);
        for (k, (mean, deviation)) in self.spread.iter_mut().enumerate() {
            let of = |f: &Found| f.numbers.get(k).copied().unwrap_or(0.5);
            let count = worst.len().max(1) as f64;
            let middle = worst.iter().map(of).sum::<f64>() / count;
            let spread = (worst.iter().map(|f| (of(f) - middle).powi(2)).sum::<f64>() / count).sqrt();
            *mean += STEP * (middle - *mean);
            *deviation += STEP * (spread.max(LEAST) - *deviation);
        }
        let best = found.into_iter().next();
        if best.as_ref().is_some_and(|b| self.worst.as_ref().is_none_or(|w| b.used > w.used)) {
            self.worst = best;
        }
        Ok(())
    }

    /// The numbers of a run: a tenth of all runs are dealt as the campaign deals, so that the search does not lock itself in.
    fn numbers(&self, run: u64) -> Vec<f64> {
        let mut dice = FaultRng::new(self.seed ^ 0xAD5A, run);
        let free = dice.chance(0.1);
        let number = |(mean, deviation): &(f64, f64)| {
            let drawn = if free { dice.unit() } else { mean + deviation * dice.normal() };
            // Reflected at the ends, so that none of them gathers what lies beyond.
            let folded = drawn.rem_euclid(2.0);
            (if folded < 1.0 { folded } else { 2.0 - folded }).min(1.0 - 1e-12)
        };
        self.spread.iter().map(number).collect()
    }
}

/// Goes on with the search for the worst case of `class` in `folder`, or begins it, up to so many runs.
pub fn search(
    begin: Search,
    class: &'static Class,
    runs: u64,
    folder: Option<&Path>,
    motions: &Motions,
    done: &(impl Fn(u64) + Sync),
) -> Result<Search, AdversaryError> {
    let path = folder.map(|folder| folder.join(format!("adversary-{}.json", class.id)));
    let mut search = match &path {
        Some(path) if path.exists() => {
            let found: Search = json::read(path)?;
            if (found.seed, found.beside) != (begin.seed, begin.beside) {
                return Err(AdversaryError::Other(path.clone()));
            }
            done(found.runs.min(runs));
            found
        }
        _ => begin,
    };
    while search.runs < runs {
        search.advance(class, motions)?;
        done(GENERATION);
        if let Some(path) = &path {
            json::write(path, serde_json::to_string(&search))?;
        }
    }
    Ok(search)
}
