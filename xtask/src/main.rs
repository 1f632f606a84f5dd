//! Every chore has one name: `cargo xtask help` lists them. One file a chore, one line in [`CHORES`].

mod benchmarks;
mod boards;
mod book;
mod deny;
mod figures;
mod firmware;
mod front_end;
mod fuzz;
mod header;
mod hil;
mod hosts;
mod house;
mod law_cost;
mod nightly;
mod output;
mod packages;
mod properties;
mod release;
mod reproduce;
mod sbom;
mod setup;
mod shell;
mod test;
mod toolchain;

use output::say;
use shell::Problem;
use std::process::ExitCode;

/// A chore: its name, what it does, and the function that does it with the words behind the name.
struct Chore {
    name: &'static str,
    does: &'static str,
    run: fn(&[String]) -> Result<(), Problem>,
}

const CHORES: &[Chore] = &[
    Chore {
        name: "test",
        does: "installs what the tests need, says what, and runs all of them [STEP...]",
        run: test::run,
    },
    Chore { name: "setup", does: "only installs what the tests need", run: setup::run },
    Chore { name: "firmware", does: "builds the firmware image", run: firmware::build },
    Chore { name: "flash", does: "builds it and writes it to the board (probe-rs)", run: firmware::flash },
    Chore {
        name: "replay",
        does: "builds it and runs it in the loop, on an emulated processor [TEST...]",
        run: firmware::replay,
    },
    Chore {
        name: "law-cost",
        does: "counts the instructions of tracking law and preview (QEMU)",
        run: law_cost::count,
    },
    Chore {
        name: "beside",
        does: "what the core's laws cost beside the same in C and beside idsp's, in instructions",
        run: firmware::beside,
    },
    Chore { name: "hil", does: "tests the board's own code, emulated and on a board with a probe", run: hil::run },
    Chore {
        name: "hosts",
        does: "plays one tape to the core in Rust, on the emulated target, in C, ...: the same bits [HOST...|cost|notebooks|examples]",
        run: hosts::run,
    },
    Chore { name: "page", does: "builds the page that does the host tool's work in a browser", run: hosts::page::run },
    Chore { name: "header", does: "writes the C header anew, or compares it [check]", run: header::run },
    Chore {
        name: "packages",
        does: "packages what is published, as `cargo publish` would, or compares interfaces with the last version's [semver]",
        run: packages::run,
    },
    Chore {
        name: "nightly",
        does: "runs what takes longer than tests may: front end, board, hosts, header, examples, pages",
        run: nightly::run,
    },
    Chore {
        name: "front-end",
        does: "checks the front end's sheets, drawings and list, and has ngspice try them [draw]",
        run: front_end::run,
    },
    Chore { name: "house", does: "checks file lengths, the direction of dependencies, stray paths", run: house::run },
    Chore {
        name: "figures",
        does: "lists every figure the project claims, with the command that prints it",
        run: figures::run,
    },
    Chore {
        name: "benchmarks",
        does: "prints how the tool stands on tasks that others set, on their data",
        run: benchmarks::run,
    },
    Chore { name: "fuzz", does: "feeds the parsers what nobody would write [TARGET [SECONDS]]", run: fuzz::run },
    Chore {
        name: "properties",
        does: "tests every property on cases drawn anew [ROUNDS [SEED]]",
        run: properties::run,
    },
    Chore { name: "book", does: "builds the tutorial as a book (mdBook)", run: book::run },
    Chore { name: "deny", does: "checks licences, sources and banned crates (cargo-deny)", run: deny::run },
    Chore { name: "sbom", does: "writes the list of all that is built in, as CycloneDX JSON [FILE]", run: sbom::run },
    Chore {
        name: "reproduce",
        does: "builds host tool and every board's image from two folders and compares the bytes [tool|firmware|BOARD]",
        run: reproduce::run,
    },
    Chore {
        name: "release",
        does: "builds, tries and sums the files that are handed to users, and names what cannot be built here [host|firmware]",
        run: release::run,
    },
    Chore { name: "help", does: "prints this", run: help },
];

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (name, rest) = words.split_first().map_or(("help", &[][..]), |(name, rest)| (name.as_str(), rest));
    let known = CHORES.iter().find(|chore| chore.name == name.trim_start_matches('-'));
    let outcome = match known {
        Some(chore) => (chore.run)(rest),
        None => Err(Problem::Usage(format!("there is no chore `{name}`; `cargo xtask help` lists them"))),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => problem.report(),
    }
}

fn help(words: &[String]) -> Result<(), Problem> {
    shell::no_words(words)?;
    say("cargo xtask CHORE\n");
    for chore in CHORES {
        say(&format!("  {:10} {}", chore.name, chore.does));
    }
    Ok(())
}
