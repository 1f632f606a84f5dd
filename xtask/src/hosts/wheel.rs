//! The Python wheel: built by maturin, installed into the environment, played.

use super::venv::{python, script};
use super::{Work, bindings};
use crate::shell::{Problem, command, run as execute};
use std::path::{Path, PathBuf};

/// Largest wheel, byte.
const LARGEST: u64 = 15_000_000;

pub(super) fn build(work: &Work) -> Result<(), Problem> {
    let python = python(work)?.display().to_string();
    let wheels = work.folder.join("wheels");
    let _ = std::fs::remove_dir_all(&wheels);
    let mut maturin = command(&[&python, "-m", "maturin", "build", "--release", "--locked", "--manifest-path"]);
    execute(maturin.arg(bindings().join("python/Cargo.toml")).arg("--out").arg(&wheels))?;
    let wheel = wheel(&wheels)?;
    let size = std::fs::metadata(&wheel).map_or(u64::MAX, |file| file.len());
    if size > LARGEST {
        return Err(Problem::Failed(format!("the wheel has {size} bytes, more than {LARGEST}")));
    }
    execute(command(&[&python, "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]).arg(wheel))?;
    // The package's dictionaries against the command line's JSON, its errors, and its types.
    execute(&mut command(&[
        "cargo",
        "build",
        "--locked",
        "--release",
        "--package",
        "shakedown",
        "--bin",
        "shakedown",
    ]))?;
    script(work, "python/tests/facade.py", &[&work.release("shakedown")])?;
    execute(&mut command(&[&python, "-m", "mypy.stubtest", "shakedown_table._native"]))
}

/// The one wheel in the folder.
fn wheel(folder: &Path) -> Result<PathBuf, Problem> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let wheel = files.into_iter().find(|path| path.extension().is_some_and(|ending| ending == "whl"));
    wheel.ok_or_else(|| Problem::Failed(format!("no wheel in {}", folder.display())))
}

pub(super) fn play(work: &Work, folder: &Path) -> Result<(), Problem> {
    script(work, "python/tests/tape.py", &[&folder.join("tape"), &folder.join("answers")]).map(drop)
}
