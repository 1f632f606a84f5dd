//! What takes longer than the tests may, or needs more tools than they: each chore runs, whatever became of the one before.

use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute};
use crate::{book, front_end, header, hil, hosts, packages, setup};

type Chore = (&'static str, fn() -> Result<(), Problem>);

const CHORES: &[Chore] = &[
    ("front end", || front_end::run(&[])),
    ("board", || hil::run(&[])),
    ("hosts", || hosts::run(&[])),
    ("header", header::check),
    ("examples", hosts::examples),
    ("notebooks", hosts::notebooks),
    ("packages", || packages::run(&[]).and_then(|()| packages::run(&["semver".into()]))),
    ("book", || book::run(&[])),
    ("page", || hosts::page::run(&[]).and_then(|()| shown("web"))),
    ("pages", || shown("pages")),
    ("results", || shown("json_schema")),
    ("commands", || shown("commands")),
    ("live", live),
    ("readers", readers),
];

/// The chore: all of them.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let missing = setup::install();
    let mut failed = Vec::new();
    for (name, run) in CHORES {
        say(&format!("\n== {name}"));
        if let Err(Problem::Usage(why) | Problem::Failed(why)) = run() {
            failed.push(format!("{name}: {why}"));
        }
    }
    setup::report(&missing);
    if failed.is_empty() { Ok(()) } else { Err(Problem::Failed(failed.join("\n"))) }
}

/// Tests that take minutes: of what the tool does in a page, the pages of every command as pictures, the results of all commands,
/// diagnoses of set-ups that are stated wrong.
fn shown(test: &str) -> Result<(), Problem> {
    let line = format!("cargo test --locked --release --package shakedown-tests --test {test} -- --include-ignored");
    execute(&mut command(&line.split(' ').collect::<Vec<_>>()))
}

/// Ten minutes of a bench watched live.
fn live() -> Result<(), Problem> {
    let line =
        "cargo test --locked --release --package shakedown-tests --test live -- --include-ignored --test-threads 1";
    execute(&mut command(&line.split(' ').collect::<Vec<_>>()))
}

/// The readers of recordings against those of others, value by value; what is not installed is said and left out.
fn readers() -> Result<(), Problem> {
    execute(&mut command(&["python3", "tests/readers/check.py"]))
}
