//! Files that are whole or not there at all.

pub(crate) mod bounded;
pub(crate) mod json;
pub(crate) mod layout;
pub(crate) mod nearest;
pub(crate) mod wording;

use std::io::{ErrorKind, Result, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Temporary files that are being written. Whoever makes, renames or removes one holds this lock meanwhile.
static UNDER_WAY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn under_way() -> MutexGuard<'static, Vec<PathBuf>> {
    // A thread that panicked left a list that is still right: each entry is pushed and taken whole.
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether the next interrupt ends the process or only asks for it, and whether one has asked.
static WAITS: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Work that is brought to an end and not cut off, such as a test on a table: while this lives, the first interrupt only asks.
/// The second ends the process as ever.
#[derive(Debug)]
pub struct Unfinished(());

impl Unfinished {
    /// From here on. Of two at a time the later one hears of it.
    pub fn begin() -> Self {
        ASKED.store(false, Ordering::SeqCst);
        WAITS.store(true, Ordering::SeqCst);
        Self(())
    }

    /// Whether an interrupt has asked for the end.
    pub fn asked_to_end(&self) -> bool {
        ASKED.load(Ordering::SeqCst)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        WAITS.store(false, Ordering::SeqCst);
    }
}

/// From now on an interrupt (Ctrl-C), a hang-up or a request to end removes what is half written, and ends the process with
/// status 130, unless work is [`Unfinished`]. Without it the files written stay whole as well, but a part of one may stay beside its place.
pub fn clean_up_when_interrupted() {
    // Refused where another handler stands already, which then decides. A browser's page has no signals.
    #[cfg(all(feature = "cli", not(target_family = "wasm")))]
    let _ = ctrlc::set_handler(|| {
        if WAITS.swap(false, Ordering::SeqCst) {
            ASKED.store(true, Ordering::SeqCst);
            return;
        }
        let parts = under_way();
        for part in parts.iter() {
            let _ = std::fs::remove_file(part);
        }
        // With the lock still held: no other thread begins or ends a file any more.
        std::process::exit(130);
    });
}

/// The folder that a file is in.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether [`write_whole`] could write here: asked before long work, and not found out after it. Leaves nothing behind.
pub fn writable(path: &Path) -> Result<()> {
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(ErrorKind::IsADirectory.into()),
        Ok(there) if !there.is_file() => return Ok(()),
        _ => {}
    }
    let there = folder_of(path).ancestors().find(|folder| folder.exists());
    tempfile::tempfile_in(there.unwrap_or(Path::new("."))).map(drop)
}

/// Writes a file whole or not at all: beside its place first, then renamed over it. Its folder is made where it is missing.
///
/// A reader, a crash or Ctrl-C at any moment sees the old file or the new one. A link keeps pointing where it did. A device or
/// a pipe (`/dev/null`, `/dev/stdout`) is written to and never replaced.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    // Where it does not exist yet, it is made where it was asked for.
    let path = &path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir()) {
        return std::fs::OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let directory = folder_of(path);
    std::fs::create_dir_all(directory)?;
    let mut builder = tempfile::Builder::new();
    // A report is for others to read: the user's mask decides, not the privacy of temporary files.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.prefix(".shakedown-").suffix(".tmp");
    let mut file = {
        let mut parts = under_way();
        let file = builder.tempfile_in(directory)?;
        parts.push(file.path().to_path_buf());
        file
    };
    let written = file.write_all(bytes).and_then(|()| file.as_file().sync_all());
    let mut parts = under_way();
    parts.retain(|part| part != file.path());
    match written {
        Ok(()) => file.persist(path).map(drop).map_err(|e| e.error),
        // Before the lock is given back: an interrupt would no longer find it.
        Err(error) => file.close().and(Err(error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        write_whole(&path, b"first").unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_write_that_fails_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let taken = folder.path().join("taken");
        std::fs::create_dir(&taken).unwrap();
        std::fs::write(taken.join("inside"), b"old").unwrap();
        assert!(write_whole(&taken, b"new").is_err());
        assert_eq!(std::fs::read(taken.join("inside")).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    }

    #[test]
    fn a_place_is_judged_before_and_a_folder_made_when_it_is_needed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        writable(&at("new/deep/a.json")).unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0, "asking makes nothing");
        write_whole(&at("new/deep/a.json"), b"first").unwrap();
        writable(&at("new/deep/a.json")).unwrap();
        assert_eq!(std::fs::read(at("new/deep/a.json")).unwrap(), b"first");
        assert_eq!(writable(&at("new")).unwrap_err().kind(), ErrorKind::IsADirectory);
        assert_eq!(writable(&at("new/deep/a.json/b")).unwrap_err().kind(), ErrorKind::NotADirectory);
        #[cfg(unix)]
        writable(Path::new("/dev/null")).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        std::fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write_whole(&link, b"new").unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
    }

    /// A device that were renamed over would be a file from then on, for the whole machine where root asked for it.
    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_stays_a_pipe() {
        use std::os::unix::fs::FileTypeExt as _;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || std::fs::read(pipe).unwrap()
        });
        write_whole(&pipe, b"through").unwrap();
        // A pipe that were replaced has no writer: a reader would wait for ever.
        assert!(std::fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
        assert_eq!(reader.join().unwrap(), b"through");
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_what_the_mask_allows() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let [ours, plain] = ["ours", "plain"].map(|name| folder.path().join(name));
        write_whole(&ours, b"").unwrap();
        std::fs::write(&plain, b"").unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&ours), mode(&plain));
    }
}
