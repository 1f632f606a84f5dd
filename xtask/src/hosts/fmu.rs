//! The FMU: compiled against the headers that FMPy brings, packed, validated and played by FMPy.

use super::venv::{python, script};
use super::{Work, bindings, c};
use crate::shell::{Problem, command, read, run as execute};
use std::path::{Path, PathBuf};

const FLAGS: [&str; 9] =
    ["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off", "-fPIC", "-shared"];

pub(super) fn build(work: &Work) -> Result<(), Problem> {
    execute(&mut command(&c::LIBRARY))?;
    let asked = "import fmpy, os; print(os.path.join(os.path.dirname(fmpy.__file__), 'c-code'))";
    let headers = read(&mut command(&[&python(work)?.display().to_string(), "-c", asked]))?;
    let (library, fmu) = (work.folder.join("shakedown_core.so"), fmu(work));
    let mut gcc = command(&FLAGS);
    gcc.args(["-I", headers.trim(), "-I"]).arg(bindings().join("c/include"));
    gcc.args(["core.c", "refused.c"].map(|file| bindings().join("fmu").join(file)));
    gcc.arg(work.release("libshakedown_c.a")).args(["-s", "-Wl,--gc-sections,--exclude-libs=ALL"]).args(c::LINKED);
    execute(gcc.arg("-o").arg(&library))?;
    script(work, "fmu/pack.py", &[&library, &fmu]).map(drop)
}

fn fmu(work: &Work) -> PathBuf {
    work.folder.join("shakedown_core.fmu")
}

pub(super) fn play(work: &Work, folder: &Path) -> Result<(), Problem> {
    script(work, "fmu/tests/tape.py", &[&fmu(work), &folder.join("tape"), &folder.join("answers")]).map(drop)
}
