//! Tasks that others set, on their data and by their rules.

use crate::shell::{Problem, command, no_words};

/// The chore: prints what each task asks for.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    crate::shell::run(&mut command(&["cargo", "run", "--release", "-p", "shakedown", "--example", "benchmarks"]))
}
