//! Plays one tape to the core on every host it can be called from, and holds their answers against each other.
//!
//! A host plays the file `tape` into the file `answers` (the format is that of `shakedown_core::host`), once as it is and once
//! with one bit flipped, which must change what it answers. No host is skipped: one that cannot be built or run fails.

mod c;
mod fmu;
pub(crate) mod page;
mod rust;
mod tape;
mod venv;
mod wasm;
mod wheel;

use crate::output::say;
use crate::shell::{Problem, command, metadata, read, top};
use std::path::{Path, PathBuf};
use tape::{Tape, difference, digest};

/// Most that Python's call may cost over C's, ns, and most that a run from Python may cost of one from Rust.
const DEARER: f64 = 1000.0;
const SLOWER: f64 = 1.1;
/// How often each host's cost is measured.
const ROUNDS: usize = 7;

/// A host of the core.
struct Host {
    name: &'static str,
    /// Builds what plays a tape.
    build: fn(&Work) -> Result<(), Problem>,
    /// Plays `tape` into `answers`, both in the folder.
    play: fn(&Work, &Path) -> Result<(), Problem>,
}

const HOSTS: &[Host] = &[
    Host { name: "rust", build: |_| Ok(()), play: rust::play },
    Host { name: "thumbv7em", build: rust::build_image, play: rust::play_image },
    Host { name: "c-gcc-O0", build: |work| c::build(work, "gcc", "-O0"), play: |_, at| c::play(at, "gcc", "-O0") },
    Host { name: "c-gcc-O3", build: |work| c::build(work, "gcc", "-O3"), play: |_, at| c::play(at, "gcc", "-O3") },
    Host {
        name: "c-clang-O0",
        build: |work| c::build(work, "clang", "-O0"),
        play: |_, at| c::play(at, "clang", "-O0"),
    },
    Host {
        name: "c-clang-O3",
        build: |work| c::build(work, "clang", "-O3"),
        play: |_, at| c::play(at, "clang", "-O3"),
    },
    Host { name: "python", build: wheel::build, play: wheel::play },
    Host { name: "wasm", build: wasm::build, play: wasm::play },
    Host { name: "fmu", build: fmu::build, play: fmu::play },
];

/// Where things are built and played.
struct Work {
    /// Cargo's folder of what it has built.
    target: PathBuf,
    /// A folder of our own.
    folder: PathBuf,
}

impl Work {
    fn new() -> Result<Self, Problem> {
        let metadata = metadata(false)?;
        let target = PathBuf::from(metadata["target_directory"].as_str().unwrap_or("target"));
        let folder = target.join("hosts");
        make(&folder)?;
        Ok(Self { target, folder })
    }

    /// What was built in release, by its file's name.
    fn release(&self, name: &str) -> PathBuf {
        self.target.join("release").join(name)
    }
}

fn make(folder: &Path) -> Result<(), Problem> {
    std::fs::create_dir_all(folder).map_err(|e| Problem::Failed(format!("{}: {e}", folder.display())))
}

/// What a host answered to the tape.
struct Played {
    name: &'static str,
    answers: Vec<u8>,
}

/// The chore: every host, or those named; or `cost`, `notebooks` or `examples`.
pub(crate) fn run(wanted: &[String]) -> Result<(), Problem> {
    match wanted {
        [word] if word == "cost" => return costs(),
        [word] if word == "notebooks" => return notebooks(),
        [word] if word == "examples" => return examples(),
        _ => {}
    }
    let names: Vec<&str> = HOSTS.iter().map(|host| host.name).collect();
    if let Some(unknown) = wanted.iter().find(|name| !names.contains(&name.as_str())) {
        return Err(Problem::Usage(format!("there is no host `{unknown}`; there are: {}", names.join(", "))));
    }
    let work = Work::new()?;
    rust::build()?;
    let whole = work.folder.join("tape");
    read(command(&[&work.release("shakedown-tape").display().to_string(), "write"]).arg(&whole))?;
    let tape = Tape::of(&whole)?;
    let chosen = HOSTS.iter().filter(|host| wanted.is_empty() || wanted.iter().any(|name| name == host.name));
    let played: Vec<(&str, Result<Played, Problem>)> =
        chosen.map(|host| (host.name, play(&work, &tape, host))).collect();
    compare(&tape, &played)
}

/// Both tapes on one host.
fn play(work: &Work, tape: &Tape, host: &Host) -> Result<Played, Problem> {
    (host.build)(work)?;
    let answers = |name: &str, bytes: &[u8]| {
        let folder = work.folder.join(host.name).join(name);
        make(&folder)?;
        let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", folder.display()));
        let _ = std::fs::remove_file(folder.join("answers"));
        std::fs::write(folder.join("tape"), bytes).map_err(failed)?;
        (host.play)(work, &folder)?;
        std::fs::read(folder.join("answers")).map_err(failed)
    };
    let (whole, flipped) = (answers("whole", &tape.bytes)?, answers("flipped", &tape.flipped())?);
    if digest(&whole) == digest(&flipped) {
        return Err(Problem::Failed("one flipped bit of the tape did not change its digest".into()));
    }
    if whole.len() != tape.records() * tape::ANSWER {
        return Err(Problem::Failed(format!("answered {} of {} records", whole.len() / tape::ANSWER, tape.records())));
    }
    Ok(Played { name: host.name, answers: whole })
}

/// Prints every digest and where a host first differs from the first that played.
fn compare(tape: &Tape, played: &[(&str, Result<Played, Problem>)]) -> Result<(), Problem> {
    let first = played.iter().find_map(|(_, played)| played.as_ref().ok());
    let mut failed = Vec::new();
    for (name, played) in played {
        match (played, first) {
            (Ok(played), Some(first)) => {
                say(&format!("HOST DIGEST {name} {:016x}", digest(&played.answers)));
                if let Some(record) = difference(&first.answers, &played.answers) {
                    let place = tape.place(record);
                    failed.push(format!("{name} differs from {} from {place} on", first.name));
                }
            }
            (Err(Problem::Usage(why) | Problem::Failed(why)), _) => failed.push(format!("{name}: {why}")),
            (Ok(_), None) => {}
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(Problem::Failed(failed.join("\n       "))) }
}

/// Builds and runs the examples of other hosts.
pub(crate) fn examples() -> Result<(), Problem> {
    let work = Work::new()?;
    c::example(&work)?;
    c::bare_example(&work)?;
    rust::examples(&work)
}

/// What a tick costs from Rust, from C and from Python, on the wheel that is installed. Of an idle processor: no test. The hosts take
/// turns, so that what else the processor does falls on all of them.
fn costs() -> Result<(), Problem> {
    let work = Work::new()?;
    rust::build()?;
    c::build_cost(&work)?;
    let rounds = (0..ROUNDS).map(|_| Ok((rust::cost(&work)?, c::cost(&work)?, wheel::cost(&work)?)));
    let rounds = rounds.collect::<Result<Vec<_>, Problem>>()?;
    let of = |figure: &dyn Fn(&(f64, f64, (f64, f64))) -> f64| median(rounds.iter().map(figure).collect());
    let (dearer, slower) = (of(&|(_, c, (step, _))| step - c), of(&|(rust, _, (_, steps))| steps / rust));
    say(&format!("Rust: {:.0} ns a sample of a run", of(&|round| round.0)));
    say(&format!("C: {:.0} ns a call of step", of(&|round| round.1)));
    say(&format!("Python: {:.0} ns a call of step, {dearer:.0} over C (at most {DEARER:.0})", of(&|round| round.2.0)));
    say(&format!("Python: {:.0} ns a sample of steps, {slower:.2} of Rust (at most {SLOWER})", of(&|round| round.2.1)));
    let kept = dearer <= DEARER && slower <= SLOWER;
    if kept { Ok(()) } else { Err(Problem::Failed("Python costs more than it may".into())) }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Runs the notebooks of the Python package, each to its end.
pub(crate) fn notebooks() -> Result<(), Problem> {
    wheel::notebooks(&Work::new()?)
}

/// The top of the bindings.
fn bindings() -> PathBuf {
    top().join("bindings")
}
