//! The two examiners behind one door: which case a number is, what its files are, and what its opened answer says.

use super::plan::Plan;
use serde_json::Value;
use shakedown_truth::answer::SealError;
use shakedown_truth::lab::plan::{Stratum, cycle, stratum};
use shakedown_truth::lab::{self, choose};
use shakedown_truth::sheet::Sheets;
use std::path::Path;

/// A case that was dealt and not opened.
pub(super) enum Dealt {
    /// Of examiner 1.
    First(Box<shakedown_truth::Case>),
    /// Of examiner 2.
    Second(Box<lab::Case>),
}

/// The experiment without noise.
pub(super) enum Clean {
    /// Of examiner 1.
    First(Sheets),
    /// Of examiner 2.
    Second(lab::sheet::Sheets),
}

/// An opened answer.
pub(super) struct Opened {
    /// The answer.
    pub answer: Value,
    /// The salt.
    pub salt: String,
    /// The experiment without noise, its model declaring the effects that are there.
    pub clean: Clean,
}

impl Dealt {
    /// Case `number` of a campaign.
    pub(super) fn deal(plan: &Plan, number: u64) -> Self {
        if plan.examiner == 1 {
            Self::First(Box::new(shakedown_truth::case(plan.seed, number)))
        } else {
            Self::Second(Box::new(lab::locked(plan.seed, number, plan.lock)))
        }
    }

    /// A name that tells nothing.
    pub(super) fn name(&self) -> &str {
        match self {
            Self::First(case) => &case.name,
            Self::Second(case) => &case.name,
        }
    }

    /// The salted hash of its answer.
    pub(super) fn seal(&self) -> &str {
        match self {
            Self::First(case) => &case.sealed.seal,
            Self::Second(case) => &case.sealed.seal,
        }
    }

    /// Writes the experiment.
    pub(super) fn write(&self, folder: &Path) -> std::io::Result<()> {
        match self {
            Self::First(case) => case.write(folder),
            Self::Second(case) => case.write(folder),
        }
    }

    /// The experiment that the rivals of examiner 1 can read.
    pub(super) fn first(&self) -> Option<&Sheets> {
        if let Self::First(case) = self { Some(&case.experiment) } else { None }
    }

    /// Opens the answer once the examinee's own lies at `stored`.
    pub(super) fn open_after(self, stored: &Path) -> Result<Opened, SealError> {
        Ok(match self {
            Self::First(case) => {
                let opened = case.sealed.open_after(stored)?;
                Opened { answer: opened.answer.to_json(), salt: opened.salt, clean: Clean::First(opened.clean) }
            }
            Self::Second(case) => {
                let opened = case.sealed.open_after(stored)?;
                Opened { answer: opened.answer.to_json(), salt: opened.salt, clean: Clean::Second(opened.clean) }
            }
        })
    }
}

impl Clean {
    /// Writes the experiment.
    pub(super) fn write(&self, folder: &Path) -> std::io::Result<()> {
        match self {
            Self::First(sheets) => sheets.write(folder),
            Self::Second(sheets) => sheets.write(folder),
        }
    }
}

/// Name and seal of a case.
pub fn seal(plan: &Plan, number: u64) -> (String, String) {
    let dealt = Dealt::deal(plan, number);
    (dealt.name().to_string(), dealt.seal().to_string())
}

/// Every name that a stratum of examiner 2 goes by: its own, and that with its strength.
pub fn strata() -> Vec<String> {
    let mut names: Vec<String> = (0..cycle()).flat_map(|number| called(stratum(0, number))).collect();
    names.sort();
    names.dedup();
    names
}

fn called(what: Stratum) -> Vec<String> {
    let name = what.name().to_string();
    match what {
        Stratum::Single(_, strength) => vec![format!("{name}, {}", strength.name()), name],
        Stratum::Null { perfect: true } => vec![format!("{name}, as stated"), name],
        Stratum::Null { perfect: false } => vec![format!("{name}, laboratory"), name],
        _ => vec![name],
    }
}

/// Whether a plan of examiner 2 asks for case `number`; kinds are known beforehand of all but pairs and triples.
pub(super) fn wanted(plan: &Plan, number: u64) -> bool {
    let called = || called(stratum(plan.seed, number));
    let stratum = plan.strata.is_empty() || called().iter().any(|name| plan.strata.contains(name));
    let kinds = || choose::kinds(plan.seed, number, plan.lock);
    stratum && (plan.kinds.is_empty() || kinds().iter().any(|kind| plan.kinds.contains(kind)))
}
