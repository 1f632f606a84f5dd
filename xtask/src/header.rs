//! The C header: written by cbindgen from `bindings/c`, committed, and compared.

use crate::output::say;
use crate::shell::{Problem, command, metadata, read, run as execute, top, works};
use std::path::PathBuf;

/// The version whose output is committed.
const CBINDGEN: &str = "0.29.4";
const HEADER: &str = "include/shakedown.h";

/// The chore: writes the header, or with `check` says whether it is what would be written.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    match words {
        [] => {
            let text = written()?;
            let path = top().join("bindings/c").join(HEADER);
            std::fs::write(&path, text).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))
        }
        [word] if word == "check" => check(),
        [word, ..] => Err(Problem::Usage(format!("header takes `check` or nothing, not `{word}`"))),
    }
}

/// Whether the committed header is what cbindgen writes.
pub(crate) fn check() -> Result<(), Problem> {
    let path = top().join("bindings/c").join(HEADER);
    let committed = std::fs::read_to_string(&path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))?;
    if committed != written()? {
        return Err(Problem::Failed("the C header is not what its source says: run `cargo xtask header`".into()));
    }
    say("the C header is what its source says");
    Ok(())
}

fn written() -> Result<String, Problem> {
    let program = cbindgen()?.display().to_string();
    let mut cbindgen = command(&[&program, "--quiet", "--config", "cbindgen.toml", "--crate", "shakedown-c"]);
    read(cbindgen.current_dir(top().join("bindings/c")))
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
