//! The C headers: written by cbindgen from `bindings/c` and `bindings/twin`, committed, and compared.

use crate::output::say;
use crate::shell::{Problem, command, metadata, read, run as execute, top, works};
use std::path::PathBuf;

/// The version whose output is committed.
const CBINDGEN: &str = "0.29.4";

/// A header: its folder below `bindings`, the package it is written from, its file.
struct Header(&'static str, &'static str, &'static str);

const HEADERS: [Header; 2] =
    [Header("c", "shakedown-c", "shakedown.h"), Header("twin", "shakedown-twin", "shakedown_twin.h")];

impl Header {
    fn folder(&self) -> PathBuf {
        top().join("bindings").join(self.0)
    }

    fn path(&self) -> PathBuf {
        self.folder().join("include").join(self.2)
    }

    /// As cbindgen writes it.
    fn written(&self) -> Result<String, Problem> {
        let program = cbindgen()?.display().to_string();
        let mut cbindgen = command(&[&program, "--quiet", "--config", "cbindgen.toml", "--crate", self.1]);
        read(cbindgen.current_dir(self.folder()))
    }
}

/// The chore: writes the headers, or with `check` says whether they are what would be written.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    match words {
        [] => HEADERS.iter().try_for_each(|header| {
            let path = header.path();
            std::fs::write(&path, header.written()?).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))
        }),
        [word] if word == "check" => check(),
        [word, ..] => Err(Problem::Usage(format!("header takes `check` or nothing, not `{word}`"))),
    }
}

/// Whether the committed headers are what cbindgen writes.
pub(crate) fn check() -> Result<(), Problem> {
    for header in HEADERS {
        let path = header.path();
        let failed = |e| Problem::Failed(format!("{}: {e}", path.display()));
        if std::fs::read_to_string(&path).map_err(failed)? != header.written()? {
            let name = header.2;
            return Err(Problem::Failed(format!("{name} is not what its source says: run `cargo xtask header`")));
        }
    }
    say("the C headers are what their sources say");
    Ok(())
}

/// The program, installed below the target folder where this machine has none of the version.
fn cbindgen() -> Result<PathBuf, Problem> {
    let said = |program: &str| read(&mut command(&[program, "--version"])).unwrap_or_default();
    if said("cbindgen").trim().ends_with(CBINDGEN) {
        return Ok("cbindgen".into());
    }
    let metadata = metadata(false)?;
    let root = PathBuf::from(metadata["target_directory"].as_str().unwrap_or("target")).join("tools");
    let program = root.join("bin/cbindgen");
    if !works(&[&program.display().to_string(), "--version"]) {
        let words = ["cargo", "install", "cbindgen", "--locked", "--version", CBINDGEN, "--root"];
        execute(command(&words).arg(&root))?;
    }
    Ok(program)
}
