//! The tutorial's commands, typed as they stand, chapter by chapter in one folder; what a block shows below a command stands in
//! what that command prints, and each picture is what a command drew.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/tutorial/src")
}

/// The chapters in the order of the summary.
fn chapters() -> Vec<String> {
    let summary = fs::read_to_string(source().join("SUMMARY.md")).unwrap();
    summary.lines().filter_map(|line| Some(line.split_once("](")?.1.strip_suffix(')')?.to_owned())).collect()
}

/// Commands of the `console` blocks, each with the lines shown below it.
fn commands(text: &str) -> Vec<(String, Vec<String>)> {
    let mut found: Vec<(String, Vec<String>)> = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        match line.strip_prefix("```") {
            Some(name) => inside = !inside && name == "console",
            None if !inside => {}
            None => match line.strip_prefix("$ ") {
                Some(command) => found.push((command.to_owned(), Vec::new())),
                None => found.last_mut().expect("a command first").1.push(line.trim().to_owned()),
            },
        }
    }
    found
}

/// The pictures of a chapter.
fn pictures(text: &str) -> impl Iterator<Item = String> {
    text.lines().filter_map(|line| Some(line.strip_prefix("![")?.split_once("](")?.1.strip_suffix(')')?.to_owned()))
}

/// Holds a picture of the tutorial against what the command drew; `UPDATE_GOLDEN=1` takes it over.
fn as_drawn(path: &str, folder: &Path) {
    let (kept, drawn) = (source().join(path), fs::read(folder.join(path)).unwrap());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        fs::create_dir_all(kept.parent().unwrap()).unwrap();
        fs::write(&kept, &drawn).unwrap();
    }
    assert!(fs::read(&kept).unwrap() == drawn, "{path} is not what the command draws: UPDATE_GOLDEN=1 takes it over");
}

#[test]
fn every_command_of_the_tutorial_does_what_it_shows() {
    let folder = TempDir::new().unwrap();
    let chapters = chapters();
    assert_eq!(chapters.len(), 4);
    let (mut typed, mut drawn) = (0, 0);
    for chapter in chapters {
        let text = fs::read_to_string(source().join(&chapter)).unwrap();
        for (command, shown) in commands(&text) {
            let words: Vec<&str> = command.split(' ').collect();
            assert_eq!(words[0], "shakedown", "{chapter}: {command}");
            let output = shakedown().current_dir(folder.path()).args(&words[1..]).output().unwrap();
            let said =
                [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
            assert!(output.status.success(), "{chapter}: {command}: {said}");
            for line in shown {
                assert!(said.contains(&line), "{chapter}: {command} does not print `{line}`:\n{said}");
            }
            typed += 1;
        }
        drawn += pictures(&text).map(|path| as_drawn(&path, folder.path())).count();
    }
    assert!(typed >= 10 && drawn >= 3, "{typed} commands, {drawn} pictures");
}
