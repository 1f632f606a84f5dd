//! A recording that reaches the disk while it comes in: its place is known to be good before a table moves, a test of a day
//! takes no more memory than one of a second, and what a host had heard when it died is still there.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use shakedown_core::State;
use shakedown_core::link::Setup;

use super::recording::{Sheet, experiment};
use super::{Row, telemetry};
use crate::files::write_whole;

/// The recording, whole.
const WHOLE: &str = "recording.csv";
/// The recording while it comes in.
const PART: &str = "recording.part.csv";
/// Most rows at rest that noise is stated from.
const RESTING: usize = 100_000;

/// Why a recording cannot be kept.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// What a run that was cut off had recorded is still there.
    #[error("{}: was left by a run that was cut off; keep it under another name, or remove it", .0.display())]
    Left(PathBuf),
    /// The file system refused.
    #[error("{}: cannot write: {cause}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        cause: io::Error,
    },
}

/// Which rows are a recording's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kept {
    /// Those of the test while it runs.
    Run,
    /// All.
    All,
}

/// A recording under way.
#[derive(Debug)]
pub struct Recorder {
    folder: PathBuf,
    setup: Setup,
    kept: Kept,
    sheet: Sheet<BufWriter<File>>,
    /// What came before the test ran.
    resting: Vec<Row>,
    ran: bool,
}

impl Recorder {
    /// Begins a recording in `folder`, which is made where it is missing.
    pub fn begin(folder: &Path, setup: &Setup, kept: Kept) -> Result<Self, RecorderError> {
        let refuse = |path: &Path, cause| RecorderError::File { path: path.to_path_buf(), cause };
        std::fs::create_dir_all(folder).map_err(|e| refuse(folder, e))?;
        let part = folder.join(PART);
        let file = File::create_new(&part).map_err(|e| match e.kind() {
            io::ErrorKind::AlreadyExists => RecorderError::Left(part.clone()),
            _ => refuse(&part, e),
        })?;
        let sheet = Sheet::begin(BufWriter::new(file), setup).map_err(|e| refuse(&part, e))?;
        Ok(Self { folder: folder.to_path_buf(), setup: *setup, kept, sheet, resting: Vec::new(), ran: false })
    }

    /// Takes what came since the last time, to the disk.
    pub fn take(&mut self, rows: &[Row]) -> Result<(), RecorderError> {
        let kept = self.kept;
        let of_the_run = |row: &&Row| kept == Kept::All || telemetry::of_the_run(row);
        let written = rows.iter().filter(of_the_run).try_for_each(|row| self.sheet.write(row));
        let written = written.and_then(|()| if rows.is_empty() { Ok(()) } else { self.sheet.flush() });
        for row in rows {
            self.ran |= row.state == State::Running;
            if !self.ran && self.resting.len() < RESTING {
                self.resting.push(*row);
            }
        }
        written.map_err(|cause| RecorderError::File { path: self.folder.join(PART), cause })
    }

    /// Rows written so far.
    pub const fn rows(&self) -> u64 {
        self.sheet.rows()
    }

    /// Puts `recording.csv` and `experiment.toml` in their places and gives the latter's; none where nothing came, and what stood
    /// there stays.
    pub fn end(self) -> Result<Option<PathBuf>, RecorderError> {
        let refuse = |path: &Path, cause| RecorderError::File { path: path.to_path_buf(), cause };
        let (part, whole) = (self.folder.join(PART), self.folder.join(WHOLE));
        let rows = self.sheet.rows();
        let file = self.sheet.end().and_then(|out| out.into_inner().map_err(io::IntoInnerError::into_error));
        file.and_then(|file| file.sync_all()).map_err(|e| refuse(&part, e))?;
        if rows == 0 {
            std::fs::remove_file(&part).map_err(|e| refuse(&part, e))?;
            return Ok(None);
        }
        std::fs::rename(&part, &whole).map_err(|e| refuse(&whole, e))?;
        let name = self.folder.file_name().map_or_else(|| "device".into(), |name| name.to_string_lossy().into_owned());
        let path = self.folder.join("experiment.toml");
        write_whole(&path, experiment(&name, WHOLE, &self.setup, &self.resting).as_bytes())
            .map_err(|e| refuse(&path, e))?;
        Ok(Some(path))
    }
}

#[cfg(test)]
mod tests {
    use super::super::recording::tests::{row, setup};
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_run_is_on_the_disk_before_it_ends_and_whole_when_it_has() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("run");
        let mut recorder = Recorder::begin(&out, &setup(), Kept::Run).unwrap();
        let states = [State::Off, State::Ready, State::Running, State::Running, State::RampDown];
        for (tick, state) in (0..).zip(states) {
            recorder.take(&[row(tick, state, 2048)]).unwrap();
        }
        assert_eq!(names(&out), [PART]);
        assert_eq!(std::fs::read_to_string(out.join(PART)).unwrap().lines().count(), 3);
        assert_eq!(recorder.rows(), 2);
        assert_eq!(recorder.end().unwrap(), Some(out.join("experiment.toml")));
        assert_eq!(names(&out), ["experiment.toml", WHOLE]);
        let mut all = Recorder::begin(&out, &setup(), Kept::All).unwrap();
        all.take(&[row(0, State::Off, 2048), row(1, State::Ready, 2048)]).unwrap();
        assert_eq!(all.rows(), 2);
    }

    #[test]
    fn a_run_without_telemetry_leaves_an_earlier_one_alone() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(WHOLE), "earlier").unwrap();
        let recorder = Recorder::begin(folder.path(), &setup(), Kept::Run).unwrap();
        assert_eq!(recorder.end().unwrap(), None);
        assert_eq!(names(folder.path()), [WHOLE]);
    }

    #[test]
    fn what_a_run_that_was_cut_off_left_is_not_written_over() {
        let folder = tempfile::tempdir().unwrap();
        let mut cut_off = Recorder::begin(folder.path(), &setup(), Kept::All).unwrap();
        cut_off.take(&[row(0, State::Running, 2048)]).unwrap();
        drop(cut_off);
        let refused = Recorder::begin(folder.path(), &setup(), Kept::All).unwrap_err();
        assert!(matches!(&refused, RecorderError::Left(part) if part.ends_with(PART)), "{refused}");
        assert_eq!(std::fs::read_to_string(folder.path().join(PART)).unwrap().lines().count(), 2);
    }

    #[test]
    fn a_place_that_is_none_is_refused_before_anything_runs() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        std::fs::write(&taken, "").unwrap();
        let refused = Recorder::begin(&taken.join("run"), &setup(), Kept::Run).unwrap_err();
        assert!(refused.to_string().contains("taken/run: cannot write"), "{refused}");
    }
}
