//! A Python environment of our own below the target folder, with what the hosts need of it.

use super::{Work, bindings};
use crate::shell::{Problem, command, read, run as execute, works};
use std::path::PathBuf;

/// The environment's interpreter; the environment is made where there is none, or where what it needs has changed.
pub(super) fn python(work: &Work) -> Result<PathBuf, Problem> {
    let folder = work.target.join("tools/venv");
    let (python, stamp) = (folder.join("bin/python"), folder.join("requirements.txt"));
    let wanted = bindings().join("requirements.txt");
    let text = |path: &PathBuf| std::fs::read_to_string(path).unwrap_or_default();
    if text(&wanted) == text(&stamp) && works(&[&python.display().to_string(), "--version"]) {
        return Ok(python);
    }
    if !works(&["python3", "-c", "import venv, ensurepip"]) {
        return Err(Problem::Failed("no python3 with venv here: run `cargo xtask setup`".into()));
    }
    execute(command(&["python3", "-m", "venv"]).arg(&folder))?;
    let pip = [&python.display().to_string(), "-m", "pip", "install", "--quiet", "--requirement"];
    execute(command(&pip).arg(&wanted))?;
    std::fs::copy(&wanted, &stamp).map_err(|e| Problem::Failed(format!("{}: {e}", stamp.display())))?;
    Ok(python)
}

/// Runs a script of Python for what it prints.
pub(super) fn script(work: &Work, script: &str, words: &[&std::path::Path]) -> Result<String, Problem> {
    let python = python(work)?.display().to_string();
    read(command(&[&python]).arg(bindings().join(script)).args(words))
}
