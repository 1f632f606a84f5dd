//! Installs what the tests need and runs all of them; every step runs, whatever became of the one before.

use crate::output::say;
use crate::shell::{Problem, command, run as execute, top};
use crate::toolchain::{self, Toolchain};
use crate::{boards, firmware, house, properties, setup};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// One step: its name and what it does.
struct Step {
    name: &'static str,
    run: fn() -> Outcome,
}

/// What became of a step.
enum Outcome {
    Passed,
    /// Passed as far as it ran: what was left out, and why.
    Partly(Vec<String>),
    Failed(String),
}

impl From<Result<(), Problem>> for Outcome {
    fn from(result: Result<(), Problem>) -> Self {
        match result {
            Ok(()) => Self::Passed,
            Err(Problem::Usage(message) | Problem::Failed(message)) => Self::Failed(message),
        }
    }
}

const STEPS: &[Step] = &[
    Step { name: "format", run: format },
    Step { name: "lints", run: lints },
    Step { name: "fuzz targets", run: || crate::fuzz::lints().into() },
    Step { name: "house", run: || house::run(&[]).into() },
    Step { name: "docs", run: docs },
    Step { name: "core on the target", run: core_on_target },
    Step { name: "firmware", run: || on_target(|_| firmware::images()) },
    Step { name: "tests", run: tests },
];

/// The chore: all steps, or those named.
pub(crate) fn run(wanted: &[String]) -> Result<(), Problem> {
    if let Some(unknown) = wanted.iter().find(|name| !STEPS.iter().any(|step| step.name == *name)) {
        let names: Vec<&str> = STEPS.iter().map(|step| step.name).collect();
        return Err(Problem::Usage(format!("there is no step `{unknown}`; there are: {}", names.join(", "))));
    }
    let missing = setup::install();
    let chosen = STEPS.iter().filter(|step| wanted.is_empty() || wanted.iter().any(|name| name == step.name));
    let results: Vec<(&str, Outcome, u64)> = chosen.map(timed).collect();
    say("\nWhat ran:");
    for (name, outcome, seconds) in &results {
        let (word, why) = match outcome {
            Outcome::Passed => ("passed", String::new()),
            Outcome::Partly(left_out) => ("passed", format!(", {} skipped:", left_out.len())),
            Outcome::Failed(why) => ("FAILED", format!(": {why}")),
        };
        say(&format!("  {name:20} {word}, {seconds} s{why}"));
        if let Outcome::Partly(left_out) = outcome {
            for line in left_out {
                say(&format!("    skipped: {line}"));
            }
        }
    }
    setup::report(&missing);
    let failed = results.iter().filter(|(_, outcome, _)| matches!(outcome, Outcome::Failed(_))).count();
    if failed == 0 { Ok(()) } else { Err(Problem::Failed(format!("{failed} of {} steps failed", results.len()))) }
}

fn timed(step: &Step) -> (&'static str, Outcome, u64) {
    say(&format!("\n== {}", step.name));
    let start = Instant::now();
    (step.name, (step.run)(), start.elapsed().as_secs())
}

/// Both workspaces.
fn format() -> Outcome {
    let fuzz = ["cargo", "fmt", "--manifest-path", "fuzz/Cargo.toml", "--check"];
    let both = execute(&mut command(&["cargo", "fmt", "--all", "--check"])).and_then(|()| execute(&mut command(&fuzz)));
    both.into()
}

/// Everything on the host, then what the firmware compiles for its board alone, for which Debian's compiler has no clippy. The
/// emulator states a newer compiler than it needs.
fn lints() -> Outcome {
    let (words, deny) = (["clippy", "--locked"], ["--", "-D", "warnings"]);
    let host = ["--workspace", "--all-targets", "--ignore-rust-version"];
    let linted = execute(command(&["cargo"]).args(words).args(host).args(deny));
    let linted = linted.and_then(|()| match toolchain::find() {
        Some(found @ Toolchain::Rustup) => {
            let packages = boards::packages()?;
            let boards: Vec<&str> = packages.iter().flat_map(|name| ["--package", name]).collect();
            execute(found.cargo(&[&words[..], &boards].concat())?.args(deny))
        }
        _ => Ok(()),
    });
    linted.into()
}

fn docs() -> Outcome {
    let mut cargo = command(&["cargo", "doc", "--no-deps", "--document-private-items", "--locked"]);
    execute(cargo.env("RUSTDOCFLAGS", "-D warnings -A rustdoc::private_intra_doc_links")).into()
}

/// Runs `work` with the firmware's compiler; that it cannot be had is a failure.
fn on_target(work: impl Fn(Toolchain) -> Result<(), Problem>) -> Outcome {
    match toolchain::find() {
        Some(found) => work(found).into(),
        None => Outcome::Failed(format!("no compiler for {}, so nothing of it was tested", toolchain::TARGET)),
    }
}

/// All tests in one build, the firmware in the loop among them where its images can be had (the step before says loudly
/// where they cannot), then what the documentation shows. Examples are left to the lints, which compile them without a link.
/// Properties draw the same cases in every run: a rare one is for `cargo xtask properties` to find, not for whoever tests next.
fn tests() -> Outcome {
    let list = top().join("target/skipped.txt");
    let _ = std::fs::remove_file(&list);
    let failed: Vec<String> = ["--tests", "--doc"]
        .iter()
        .filter_map(|what| match execute(&mut tested(what, &list)) {
            Ok(()) => None,
            Err(Problem::Usage(why) | Problem::Failed(why)) => Some(why),
        })
        .collect();
    match (failed.is_empty(), std::fs::read_to_string(&list)) {
        (false, _) => Outcome::Failed(failed.join("; ")),
        (true, Ok(lines)) => Outcome::Partly(lines.lines().map(str::to_owned).collect()),
        (true, Err(_)) => Outcome::Passed,
    }
}

/// `cargo test` of `what` in all packages that can be had. The emulator states a newer compiler than it needs.
fn tested(what: &str, list: &Path) -> Command {
    let mut cargo = command(&["cargo", "test", what, "--locked", "--no-fail-fast"]);
    if toolchain::find().is_some() {
        cargo.args(["--workspace", "--ignore-rust-version"]);
    }
    cargo.env(properties::VARIABLE, properties::SEED).env(SKIPPED, list).env(BUILT, "1");
    cargo
}

/// Where a test that has nothing to test with says so (`sim-host/tests/support/skipped.rs`): what returns early is green.
const SKIPPED: &str = "SHAKEDOWN_SKIPPED";
/// What keeps the tests of the command line from a build of their own (`tests/src/binary.rs`): this one has the binary.
const BUILT: &str = "SHAKEDOWN_BUILT";

fn core_on_target() -> Outcome {
    on_target(|found| execute(&mut found.cargo(&["build", "--release", "--locked", "--package", "shakedown-core"])?))
}
