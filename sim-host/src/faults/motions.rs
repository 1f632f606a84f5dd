//! The records that faults happen in: generated ones, and real ones where a folder holds them.

use crate::motion::condition::{ConditionError, Recipe};
use crate::motion::generate::{self, GenerateError};
use crate::motion::read::{self, ReadError};
use crate::motion::resample::Interpolation;
use crate::motion::{Record, condition::Step};
use std::path::{Path, PathBuf};

/// Seeds of each generated kind.
const SEEDS: u64 = 12;
/// Control rate, Hz.
pub const RATE: f64 = 1000.0;

/// One record as displacement (m) at the control rate.
#[derive(Debug, Clone)]
pub struct Played {
    /// Its name.
    pub name: String,
    /// Displacement, m.
    pub displacement: Vec<f64>,
}

/// All of them.
#[derive(Debug, Clone)]
pub struct Motions {
    /// In their order, which numbers refer to.
    pub all: Vec<Played>,
    /// Files among them.
    pub files: Vec<PathBuf>,
}

/// Why there are none.
#[derive(Debug, thiserror::Error)]
pub enum MotionsError {
    /// One could not be generated.
    #[error("{0}")]
    Generate(#[from] GenerateError),
    /// A file could not be read.
    #[error("{0}")]
    Read(#[from] ReadError),
    /// A record could not be conditioned.
    #[error("{name}: {cause}")]
    Condition {
        /// The record.
        name: String,
        /// Why.
        cause: ConditionError,
    },
    /// The folder cannot be read.
    #[error("{folder}: {cause}: --records expects a folder of PEER records")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the file system said.
        cause: std::io::Error,
    },
    /// It holds none.
    #[error("{0}: no PEER record (.AT2) in it: --records expects a folder of them")]
    NoRecord(PathBuf),
}

impl Motions {
    /// The generated ones, and those of the PEER files in `folder`.
    pub fn new(folder: Option<&Path>) -> Result<Self, MotionsError> {
        let mut motions = Self { all: Vec::new(), files: Vec::new() };
        for recipe in generate::RECIPES {
            for seed in 1..=SEEDS {
                motions.add(&recipe.generate(seed)?)?;
            }
        }
        for file in folder.map(peer_files).transpose()?.unwrap_or_default() {
            motions.add(&read::record(&file, &read::Options::default())?)?;
            motions.files.push(file);
        }
        Ok(motions)
    }

    fn add(&mut self, record: &Record) -> Result<(), MotionsError> {
        let condition = |cause| MotionsError::Condition { name: record.name.clone(), cause };
        let motion = Recipe::fitting(None).apply(record).map_err(condition)?;
        let resample = Step::Resample { rate_hz: RATE, between: Interpolation::Linear };
        let motion = resample.apply(motion).map_err(condition)?;
        self.all.push(Played { name: record.name.clone(), displacement: motion.displacement });
        Ok(())
    }
}

fn peer_files(folder: &Path) -> Result<Vec<PathBuf>, MotionsError> {
    let entries =
        std::fs::read_dir(folder).map_err(|cause| MotionsError::Folder { folder: folder.to_path_buf(), cause })?;
    let peer = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("at2"));
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(peer).collect();
    files.sort();
    if files.is_empty() {
        return Err(MotionsError::NoRecord(folder.to_path_buf()));
    }
    Ok(files)
}
