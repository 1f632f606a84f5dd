//! Wrong input, a line a case over all commands: exit status 2, one short message that names the option or the file, the place
//! and the remedy, in plain words; nothing printed as a result and nothing left behind.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

mod cases;
mod files;
mod odd;

use cases::{EXPERIMENTS, LIVE, MODELS, OPTIONS, OTHERS, RECORDS, TABLES, UNFIT};
use files::folder;
use shakedown_tests::binary::shakedown;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// The longest message that is read by anybody, bytes.
const LONGEST: usize = 2500;

/// Words of the parser and of the solver, which tell a person nothing.
const JARGON: [&str; 13] = [
    "invalid float literal",
    "invalid digit found",
    "target type",
    "18446744073709551615.",
    "InsufficientProgress",
    "os error",
    "panicked",
    "to pass '-",
    "unknown field",
    "invalid type",
    "Is a directory",
    "ioctl",
    "error: Talks",
];

fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// What is wrong with how a command line was refused.
fn faults(folder: &Path, line: &str, parts: &[&str], before: &[String]) -> Vec<String> {
    let mut arguments: Vec<&str> = line.split(' ').collect();
    if !matches!(arguments[0], "prove") && !line.starts_with("init") {
        arguments.extend(["--json", "out.json", "--report", "out.html"]);
    }
    let output = shakedown().current_dir(folder).args(arguments).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    let mut wrong = Vec::new();
    if output.status.code() != Some(2) {
        wrong.push(format!("status {:?}", output.status.code()));
    }
    if !output.stdout.is_empty() {
        wrong.push("printed a result".to_owned());
    }
    if message.matches("error: ").count() != 1 {
        wrong.push("not one message".to_owned());
    }
    if message.len() > LONGEST {
        wrong.push(format!("a message of {} bytes", message.len()));
    }
    wrong.extend(JARGON.iter().filter(|word| message.contains(*word)).map(|word| format!("says `{word}`")));
    wrong.extend(parts.iter().filter(|part| !message.contains(*part)).map(|part| format!("does not say `{part}`")));
    if listing(folder) != before {
        wrong.push("left something behind".to_owned());
    }
    let short: String = message.chars().take(400).collect();
    if wrong.is_empty() { wrong } else { vec![format!("{line}: {}\n    {short}", wrong.join(", "))] }
}

#[test]
fn every_wrong_input_is_refused_with_file_place_and_remedy() {
    let folder = folder();
    let before = listing(folder.path());
    let plain = [&OPTIONS[..], &TABLES, &OTHERS, &LIVE, &RECORDS, &MODELS, &odd::COMMANDS].concat();
    let read = ["identify", "diagnose"].into_iter().flat_map(|command| {
        EXPERIMENTS.iter().chain(&odd::EXPERIMENTS).map(move |(file, parts)| (format!("{command} {file}"), *parts))
    });
    let cases: Vec<(String, &[&str])> =
        plain.iter().map(|(line, parts)| ((*line).to_owned(), *parts)).chain(read).collect();
    assert!(cases.len() >= 300, "{} cases", cases.len());
    let wrong: Vec<String> =
        cases.iter().flat_map(|(line, parts)| faults(folder.path(), line, parts, &before)).collect();
    assert!(wrong.is_empty(), "{} of {} cases:\n{}", wrong.len(), cases.len(), wrong.join("\n"));
}

/// What can be read but not believed is a verdict and no error; a short gap is bridged.
#[test]
fn recordings_that_cannot_be_believed_are_a_verdict() {
    let folder = folder();
    let diagnosed = |file: &str| {
        let output = shakedown().current_dir(folder.path()).args(["diagnose", file, "--json", "-"]).output().unwrap();
        assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).unwrap()
    };
    for (file, said, unsaid) in UNFIT {
        let found = diagnosed(file);
        let findings = found["findings"].to_string();
        assert_eq!(found["verdict"], "bad-data", "{file}: {findings}");
        assert!(said.iter().all(|part| findings.contains(part)), "{file}: {findings}");
        assert!(!unsaid.iter().any(|part| findings.contains(part)), "{file}: {findings}");
        // No figure of a fit to them is given either.
        let output = shakedown().current_dir(folder.path()).args(["identify", file]).output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{file}: {message}");
        assert!(said.iter().all(|part| message.contains(part)), "{file}: {message}");
    }
    assert_ne!(diagnosed("x-gap19.csv.toml")["verdict"], "bad-data");
}

/// A folder that is made is said to be.
#[test]
fn a_folder_that_a_result_makes_is_said() {
    let folder = TempDir::new().unwrap();
    let line = ["effects", "leakage", "--json", "new/deep/x.json"];
    let output = shakedown().current_dir(folder.path()).args(line).output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && message.contains("new/deep: there is no such folder; it is made"), "{message}");
    assert!(folder.path().join("new/deep/x.json").exists());
    let again = shakedown().current_dir(folder.path()).args(line).output().unwrap();
    assert!(again.stderr.is_empty(), "{}", String::from_utf8_lossy(&again.stderr));
}
