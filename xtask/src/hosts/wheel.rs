//! The Python wheel: built by maturin, installed into the environment, played.

use super::venv::{python, script};
use super::{Work, bindings};
use crate::output::say;
use crate::shell::{Problem, command, run as execute, top, works};
use std::path::{Path, PathBuf};

/// Largest wheel, byte.
const LARGEST: u64 = 15_000_000;
/// Other versions of Python that the wheel is tested on, with a NumPy of theirs: the oldest, and the newest that is here.
const OTHERS: [(&[&str], &str); 2] = [(&["3.10"], "2.2.6"), (&["3.15", "3.14", "3.13"], "2.5.5")];

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
    execute(command(&[&python, "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]).arg(&wheel))?;
    // The package's dictionaries against the command line's JSON, its errors, and its types.
    let line = ["cargo", "build", "--locked", "--release", "--package", "shakedown", "--bin", "shakedown"];
    execute(&mut command(&line))?;
    let facade = promises(work);
    script(work, "python/tests/facade.py", &facade.iter().map(PathBuf::as_path).collect::<Vec<_>>())?;
    for package in ["shakedown_table", "shakedown_table._native"] {
        execute(&mut command(&[&python, "-m", "mypy.stubtest", package]))?;
    }
    execute(command(&[&python, "-m", "mypy", "--strict"]).arg(bindings().join("python/python/shakedown_table")))?;
    OTHERS.iter().try_for_each(|(versions, numpy)| on(work, versions, numpy, &wheel))
}

/// What the facade's test is given: the command line's binary, and the recordings that are at hand.
fn promises(work: &Work) -> Vec<PathBuf> {
    let data = std::env::var_os("SHAKEDOWN_DATA").map_or_else(|| top().join("../shared/data"), PathBuf::from);
    let folder = data.join("recordings/shake_table");
    let experiments = ["CHY027.toml", "KAU039.toml", "TAP089.toml"].map(|name| folder.join(name));
    let (here, missing): (Vec<_>, Vec<_>) = experiments.into_iter().partition(|path| path.exists());
    for path in missing {
        say(&format!("SKIPPED: {} is not at hand; set SHAKEDOWN_DATA", path.display()));
    }
    std::iter::once(work.release("shakedown")).chain(here).collect()
}

/// The promises again on another Python: the first of these versions that is here.
fn on(work: &Work, versions: &[&str], numpy: &str, wheel: &Path) -> Result<(), Problem> {
    let wanted = versions.join(" or ");
    let none = || Problem::Failed(format!("no Python {wanted} here, which the wheel is tested on: install one"));
    let here = versions.iter().find_map(|version| Some((version, interpreter(version)?)));
    let (version, found) = here.ok_or_else(none)?;
    let folder = work.target.join("tools").join(format!("venv-{version}"));
    let python = folder.join("bin/python").display().to_string();
    if !works(&[&python, "-c", "import numpy"]) {
        execute(command(&[&found.display().to_string(), "-m", "venv"]).arg(&folder))?;
        execute(&mut command(&[&python, "-m", "pip", "install", "--quiet", &format!("numpy=={numpy}")]))?;
    }
    execute(command(&[&python, "-m", "pip", "install", "--quiet", "--no-deps", "--force-reinstall"]).arg(wheel))?;
    let test = bindings().join("python/tests/facade.py");
    say(&format!("Python {version}"));
    execute(command(&[&python]).arg(test).arg(work.release("shakedown")))
}

/// An interpreter of this version: on the path, or of pyenv's.
fn interpreter(version: &str) -> Option<PathBuf> {
    let name = format!("python{version}");
    if works(&[&name, "--version"]) {
        return Some(name.into());
    }
    let root = std::env::var_os("PYENV_ROOT").map(PathBuf::from);
    let root = root.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".pyenv")))?;
    let installed = std::fs::read_dir(root.join("versions")).ok()?.flatten();
    let fits = |name: &str| name.strip_prefix(version).is_some_and(|rest| rest.starts_with('.'));
    let of = installed.filter(|entry| fits(&entry.file_name().to_string_lossy())).map(|entry| entry.path());
    of.map(|path| path.join("bin/python")).find(|path| works(&[&path.display().to_string(), "--version"]))
}

/// What a call of `step` costs from Python, and a sample of `steps`, ns.
pub(super) fn cost(work: &Work) -> Result<(f64, f64), Problem> {
    let said = script(work, "python/tests/cost.py", &[])?;
    let numbers: Vec<f64> = said.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let [step, steps] = numbers[..] else { return Err(Problem::Failed(format!("no two costs: {said}"))) };
    Ok((step, steps))
}

/// The notebooks, each run to its end on the wheel that is installed.
pub(super) fn notebooks(work: &Work) -> Result<(), Problem> {
    for name in ["own_recording", "tracking_design", "benchmarks"] {
        say(&format!("notebook {name}"));
        say(script(work, &format!("python/notebooks/{name}.py"), &[])?.trim());
    }
    Ok(())
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
