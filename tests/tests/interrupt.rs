//! An interrupt in the middle of a write leaves the old file or the new one, and nothing beside it.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Names the folder in which this binary, run again, writes until it is interrupted.
const FOLDER: &str = "SHAKEDOWN_TEST_WRITES_TO";
/// Whether it cleans up.
const CLEANS: &str = "SHAKEDOWN_TEST_CLEANS_UP";
const SIZE: usize = 8 << 20;

/// No test by itself: what the tests below run and interrupt.
#[test]
fn writer() {
    let Some(folder) = std::env::var_os(FOLDER).map(PathBuf::from) else { return };
    if std::env::var_os(CLEANS).is_some() {
        shakedown::blocks::files::clean_up_when_interrupted();
    }
    let contents = [vec![b'a'; SIZE], vec![b'b'; SIZE]];
    loop {
        for content in &contents {
            shakedown::blocks::files::write_whole(&folder.join("file"), content).unwrap();
        }
    }
}

fn begin(folder: &Path, cleans: bool) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["writer", "--exact"]).env(FOLDER, folder).stdout(Stdio::null()).stderr(Stdio::null());
    if cleans {
        command.env(CLEANS, "1");
    }
    command.spawn().unwrap()
}

fn parts(folder: &Path) -> usize {
    let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
    names.filter(|name| name.to_string_lossy().contains(".tmp")).count()
}

/// Interrupts a writer while a part of a file is there; how many parts stay.
fn interrupted(cleans: bool) -> usize {
    let folder = tempfile::tempdir().unwrap();
    let mut child = begin(folder.path(), cleans);
    while !folder.path().join("file").exists() || parts(folder.path()) == 0 {
        assert!(child.try_wait().unwrap().is_none(), "the writer ended by itself");
    }
    // Where the tests themselves run in the background an interrupt is ignored by all that does not ask for it.
    let signal = if cleans { "-INT" } else { "-KILL" };
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    assert!(!child.wait().unwrap().success());
    let written = std::fs::read(folder.path().join("file")).unwrap();
    let first = written.first().copied().unwrap();
    assert!(written.len() == SIZE && written.iter().all(|&byte| byte == first), "half a file");
    parts(folder.path())
}

#[test]
fn an_interrupt_in_mid_write_leaves_no_part() {
    for _ in 0..10 {
        assert_eq!(interrupted(true), 0);
    }
}

#[test]
fn without_cleaning_up_a_part_would_stay() {
    assert!((0..10).any(|_| interrupted(false) > 0));
}
