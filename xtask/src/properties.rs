//! The hunt: every property on cases that no run before has drawn. The tests themselves draw the same cases everywhere
//! ([`SEED`]), so that what passes here passes there, and a rare case is found by looking for it.

use crate::output::say;
use crate::shell::{Problem, command, top};
use std::fs::{read_dir, read_to_string};
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// The seed of the properties where [`crate::test`] runs them.
pub(crate) const SEED: &str = "1";
/// What proptest reads it from.
pub(crate) const VARIABLE: &str = "PROPTEST_RNG_SEED";
/// Rounds where nothing else is said.
const ROUNDS: u64 = 20;
/// Where properties are: folder and package.
const PACKAGES: &[(&str, &str)] =
    &[("core", "shakedown-core"), ("firmware", "shakedown-firmware"), ("sim-host", "shakedown")];

/// The chore: so many rounds, each with a seed of its own, until one fails.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    let number =
        |word: &String| word.parse::<u64>().map_err(|_| Problem::Usage(format!("`{word}` is no whole number")));
    let (rounds, first) = match words {
        [] => (ROUNDS, fresh()),
        [rounds] => (number(rounds)?, fresh()),
        [rounds, first] => (number(rounds)?, number(first)?),
        _ => return Err(Problem::Usage("properties takes a number of rounds and a first seed".into())),
    };
    let names = names()?;
    for (round, seed) in (1..=rounds).zip(first..) {
        say(&format!("\n== round {round} of {rounds}: {} properties with seed {seed}", names.len()));
        // The names of all properties on every round's line would bury what it found.
        let done = hunt(&names, seed).status().map_err(|e| Problem::Failed(format!("cargo did not start: {e}")))?;
        if !done.success() {
            let again = format!("`cargo xtask properties 1 {seed}` does it again");
            return Err(Problem::Failed(format!("round {round} failed, with what stands above; {again}")));
        }
    }
    say(&format!("\n{} properties held in {rounds} rounds, seeds {first} on", names.len()));
    Ok(())
}

/// A seed that no run before has had.
fn fresh() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// One round. All cases of a failing one are worth seeing, so that no property ends the others.
fn hunt(names: &[String], seed: u64) -> Command {
    let mut cargo = command(&["cargo", "test", "--quiet", "--locked", "--no-fail-fast", "--lib", "--tests"]);
    for (_, package) in PACKAGES {
        cargo.args(["--package", package]);
    }
    cargo.arg("--").args(names).env(VARIABLE, seed.to_string());
    cargo
}

/// The names of all properties.
fn names() -> Result<Vec<String>, Problem> {
    let mut names = vec![];
    for (folder, _) in PACKAGES {
        collect(&top().join(folder), &mut names).map_err(|e| Problem::Failed(format!("{folder}: {e}")))?;
    }
    names.sort_unstable();
    names.dedup();
    Ok(names)
}

fn collect(folder: &Path, names: &mut Vec<String>) -> std::io::Result<()> {
    for entry in read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, names)?;
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            names.extend(properties(&read_to_string(&path)?));
        }
    }
    Ok(())
}

/// The properties of a source file: tests that take something.
fn properties(source: &str) -> Vec<String> {
    let tests = source.split("#[test]").skip(1).filter_map(|after| after.split_once("fn ")?.1.split_once('('));
    tests.filter(|(_, rest)| !rest.starts_with(')')).map(|(name, _)| name.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_property_is_a_test_that_takes_something() {
        let source = "#[test]\nfn plain() {}\n#[test]\n#[ignore]\nfn one(x in 0..3) {}\nfn helper(x: u8) {}\n\
                      #[test]\nfn many(\n    x in 0..3,\n) {}\n";
        assert_eq!(properties(source), ["one", "many"]);
    }

    #[test]
    fn every_package_has_some() {
        for (folder, _) in PACKAGES {
            let mut names = vec![];
            collect(&top().join(folder), &mut names).unwrap();
            assert!(!names.is_empty(), "{folder}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        assert!(matches!(run(&["many".into()]), Err(Problem::Usage(_))));
    }
}
