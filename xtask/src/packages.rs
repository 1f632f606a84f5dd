//! Packages as they would be published, and whether their interface still keeps what the last version promised.

use crate::output::say;
use crate::shell::{Problem, command, metadata, read, run as execute, works};
use std::path::PathBuf;

/// What goes to the registry, in the order in which one needs another.
const PUBLISHED: [&str; 5] =
    ["shakedown-core", "shakedown-rehearsal", "shakedown-firmware", "shakedown-truth", "shakedown"];
/// The version that judges interfaces.
const SEMVER_CHECKS: &str = "0.51.0";

/// The chore: packages everything as `cargo publish` would and builds what came out, or with `semver` compares interfaces.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    match words {
        [] => packaged(),
        [word] if word == "semver" => compared(),
        [word, ..] => Err(Problem::Usage(format!("packages takes `semver` or nothing, not `{word}`"))),
    }
}

fn packaged() -> Result<(), Problem> {
    let mut cargo = command(&["cargo", "publish", "--dry-run", "--locked"]);
    execute(cargo.args(PUBLISHED.iter().flat_map(|name| ["--package", name])))
}

/// The interface of every published library against the newest tag's.
fn compared() -> Result<(), Problem> {
    let tags = read(&mut command(&["git", "tag", "--list", "v*", "--sort", "-version:refname"]))?;
    let Some(tag) = tags.lines().next() else {
        say("no version is tagged yet: there is nothing to keep");
        return Ok(());
    };
    let program = semver_checks()?.display().to_string();
    PUBLISHED.iter().try_for_each(|name| {
        execute(&mut command(&[&program, "semver-checks", "--package", name, "--baseline-rev", tag]))
    })
}

/// The program, installed below the target folder.
fn semver_checks() -> Result<PathBuf, Problem> {
    let metadata = metadata(false)?;
    let root = PathBuf::from(metadata["target_directory"].as_str().unwrap_or("target")).join("tools");
    let program = root.join("bin/cargo-semver-checks");
    if !works(&[&program.display().to_string(), "semver-checks", "--version"]) {
        let words = ["cargo", "install", "cargo-semver-checks", "--locked", "--version", SEMVER_CHECKS, "--root"];
        execute(command(&words).arg(&root))?;
    }
    Ok(program)
}
