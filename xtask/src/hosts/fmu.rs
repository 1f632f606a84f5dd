//! The FMUs, of the core and of a simulated table: compiled against the headers that FMPy brings, packed, validated and played
//! by FMPy.

use super::venv::{python, script};
use super::{Work, bindings, c};
use crate::output::say;
use crate::shell::{Problem, command, read, run as execute};
use std::path::{Path, PathBuf};

const FLAGS: [&str; 9] =
    ["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off", "-fPIC", "-shared"];

/// An FMU: its folder below `bindings/fmu`, where it takes its header from, and its library.
struct Fmu {
    name: &'static str,
    header: &'static str,
    package: &'static str,
    library: &'static str,
}

const CORE: Fmu = Fmu { name: "core", header: "c", package: "shakedown-c", library: "libshakedown_c.a" };
const TWIN: Fmu = Fmu { name: "twin", header: "twin", package: "shakedown-twin", library: "libshakedown_twin.a" };

pub(super) fn build(work: &Work) -> Result<(), Problem> {
    pack(work, &CORE)?;
    pack(work, &TWIN)?;
    compare_twin(work)
}

fn pack(work: &Work, of: &Fmu) -> Result<(), Problem> {
    execute(&mut command(&["cargo", "build", "--locked", "--release", "--package", of.package]))?;
    let asked = "import fmpy, os; print(os.path.join(os.path.dirname(fmpy.__file__), 'c-code'))";
    let headers = read(&mut command(&[&python(work)?.display().to_string(), "-c", asked]))?;
    let (library, folder) = (work.folder.join(format!("shakedown_{}.so", of.name)), bindings().join("fmu"));
    let mut gcc = command(&FLAGS);
    gcc.args(["-I", headers.trim(), "-I"]).arg(&folder).arg("-I").arg(bindings().join(of.header).join("include"));
    gcc.arg(folder.join(of.name).join(format!("{}.c", of.name)));
    gcc.args(["common.c", "refused.c"].map(|file| folder.join(file)));
    gcc.arg(work.release(of.library)).args(["-s", "-Wl,--gc-sections,--exclude-libs=ALL"]).args(c::LINKED);
    execute(gcc.arg("-o").arg(&library))?;
    script(work, "fmu/pack.py", &[&folder.join(of.name), &library, &path(work, of)]).map(drop)
}

fn path(work: &Work, of: &Fmu) -> PathBuf {
    work.folder.join(format!("shakedown_{}.fmu", of.name))
}

/// The twin, alone and in a loop with the core, against what `shakedown run` makes of the same tables.
fn compare_twin(work: &Work) -> Result<(), Problem> {
    let line = ["cargo", "build", "--locked", "--release", "--package", "shakedown", "--bin", "shakedown"];
    execute(&mut command(&line))?;
    for table in ["twin/resources/table.toml", "tests/oil.toml"] {
        let (table, trace) = (bindings().join("fmu").join(table), work.folder.join("twin.csv"));
        let mut run = command(&[&work.release("shakedown").display().to_string(), "run"]);
        run.arg(bindings().join("fmu/tests/scenario.toml")).arg("--table").arg(&table).arg("--trace").arg(&trace);
        read(&mut run)?;
        say(script(work, "fmu/tests/twin.py", &[&path(work, &CORE), &path(work, &TWIN), &table, &trace])?.trim());
    }
    Ok(())
}

pub(super) fn play(work: &Work, folder: &Path) -> Result<(), Problem> {
    script(work, "fmu/tests/tape.py", &[&path(work, &CORE), &folder.join("tape"), &folder.join("answers")]).map(drop)
}
