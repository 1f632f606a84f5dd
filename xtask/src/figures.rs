//! Every figure the project claims: its bound and the command that prints it, in one place.

use crate::output::say;
use crate::shell::{Problem, no_words};

/// A figure someone may ask for.
struct Figure {
    /// What is measured.
    name: &'static str,
    /// What it must be.
    bound: &'static str,
    /// The command that prints it, from the top of the workspace.
    command: &'static str,
}

const FIGURES: &[Figure] = &[
    Figure {
        name: "Table 1 beside the paper: Taft Current and Strong in E_d and peak",
        bound: "within 20 %",
        command: "cargo run --release -- table1 --records ../shared/data/records",
    },
    Figure {
        name: "closed-loop simulation, 60 s at 1 kHz, 10 plant steps a tick, one core",
        bound: "at least 5,000 times real time",
        command: "cargo bench -p shakedown --bench closed_loop",
    },
    Figure {
        name: "first build of the host tool on 2 cores",
        bound: "under 4 minutes",
        command: "CARGO_TARGET_DIR=$(mktemp -d) cargo build --release --timings",
    },
];

/// The chore: lists them.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    for figure in FIGURES {
        say(&format!("{}\n  bound    {}\n  command  {}\n", figure.name, figure.bound, figure.command));
    }
    Ok(())
}
