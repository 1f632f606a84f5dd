//! A learnt drive before it is played: whether the table with its specimen still answers the check motion as it did.

use super::Failure;
use super::compare;
use super::output::tell;
use crate::closed_loop::learning::stale::Staleness;
use std::path::{Path, PathBuf};

/// Recordings of the check motion, as options.
#[derive(Debug, Clone, Default, clap::Args)]
#[group(skip)]
pub(crate) struct Checked {
    /// Recording of the check motion (`learn --check`) from when the drive was learnt.
    #[arg(long, value_name = "FILE", requires = "check_now")]
    check_then: Option<PathBuf>,
    /// Recording of the check motion from today: where the specimen has changed since, the drive is stale and refused.
    #[arg(long, value_name = "FILE", requires = "check_then")]
    check_now: Option<PathBuf>,
}

impl Checked {
    /// The recordings, where they are given.
    pub(crate) fn inputs(&self) -> impl Iterator<Item = PathBuf> {
        self.check_then.iter().chain(&self.check_now).cloned()
    }

    /// Holds the two recordings against each other; refuses the drive where the specimen has changed between them.
    pub(crate) fn fresh(&self, drive: Option<&Path>) -> Result<Option<Staleness>, Failure> {
        let (Some(then), Some(now)) = (&self.check_then, &self.check_now) else { return Ok(None) };
        let drive = drive.ok_or_else(|| {
            Failure::Input("--check-then: says whether a learnt drive is stale: name the drive".into())
        })?;
        let found = compare::answered(then, now)?;
        if found.stale {
            return Err(Failure::Input(format!(
                "{}: is stale: {} answers the check motion {:.1} % otherwise about {:.1} Hz than {}, which no gain and no delay \
                 explains: the specimen has changed; learn again without this drive",
                drive.display(),
                now.display(),
                100.0 * found.change,
                found.frequency,
                then.display()
            )));
        }
        tell(&format!(
            "note: {}: the table and its specimen answer the check motion as they did, but for {:+.2} % of gain: the drive holds",
            drive.display(),
            100.0 * found.gain
        ));
        Ok(Some(found))
    }
}
