//! C over the static library, by two compilers and with and without optimisation.

use super::{Work, bindings};
use crate::firmware::GCC;
use crate::shell::{Problem, command, read, run as execute, works};
use crate::toolchain::{self, TARGET};
use std::path::Path;

pub(super) const LIBRARY: [&str; 6] = ["cargo", "build", "--locked", "--release", "--package", "shakedown-c"];
/// What a host's C compiler is told: no fused multiplication where the source has none.
const FLAGS: [&str; 5] = ["-std=c11", "-Wall", "-Wextra", "-Werror", "-ffp-contract=off"];
/// What Rust's standard library needs.
pub(super) const LINKED: [&str; 3] = ["-lpthread", "-ldl", "-lm"];

fn program(compiler: &str, optimised: &str) -> String {
    format!("tape-{compiler}{optimised}")
}

pub(super) fn build(work: &Work, compiler: &str, optimised: &str) -> Result<(), Problem> {
    if !works(&[compiler, "--version"]) {
        return Err(Problem::Failed(format!("{compiler} is not here: run `cargo xtask setup`")));
    }
    execute(&mut command(&LIBRARY))?;
    compile(work, compiler, optimised, "tape.c", &program(compiler, optimised))?;
    compile(work, compiler, optimised, "misuse.c", "misuse")?;
    read(&mut command(&[&work.folder.join("misuse").display().to_string()])).map(drop)
}

fn compile(work: &Work, compiler: &str, optimised: &str, source: &str, to: &str) -> Result<(), Problem> {
    let c = bindings().join("c");
    let mut cc = command(&[&[compiler, optimised], &FLAGS[..]].concat());
    cc.arg("-I").arg(c.join("include")).arg(c.join("tests").join(source)).arg(work.release("libshakedown_c.a"));
    execute(cc.args(LINKED).arg("-o").arg(work.folder.join(to)))
}

pub(super) fn play(folder: &Path, compiler: &str, optimised: &str) -> Result<(), Problem> {
    // target/hosts/NAME/whole, and the program in target/hosts.
    let program = Path::new("../..").join(program(compiler, optimised));
    read(command(&[&program.display().to_string(), "tape", "answers"]).current_dir(folder)).map(drop)
}

pub(super) fn build_cost(work: &Work) -> Result<(), Problem> {
    execute(&mut command(&LIBRARY))?;
    compile(work, "gcc", "-O3", "cost.c", "cost")
}

/// What a call of `step` costs from C, ns.
pub(super) fn cost(work: &Work) -> Result<f64, Problem> {
    let said = read(&mut command(&[&work.folder.join("cost").display().to_string()]))?;
    said.trim().parse().map_err(|_| Problem::Failed(format!("the cost in C is no number: {said}")))
}

/// The example of a C project: built by CMake, its loop run.
pub(super) fn example(work: &Work) -> Result<(), Problem> {
    let folder = work.folder.join("c-loop");
    let cargo = format!("-DCARGO_TARGET={}", work.target.display());
    execute(command(&["cmake", "-S", "examples/c-loop", &cargo, "-B"]).arg(&folder))?;
    execute(command(&["cmake", "--build"]).arg(&folder))?;
    execute(command(&["ctest", "--output-on-failure", "--test-dir"]).arg(&folder))
}

/// What the loop takes of a board's HAL: addresses that resolve to nothing, for a link that is not run.
const BOARD: [&str; 7] =
    ["HAL_GPIO_ReadPin", "HAL_GPIO_WritePin", "HAL_DAC_SetValue", "htim2", "hdac", "port_a", "adc"];

/// The same loop for a bare Cortex-M4F: compiled, and linked without any standard library.
pub(super) fn bare_example(work: &Work) -> Result<(), Problem> {
    if !works(&[GCC, "--version"]) {
        return Err(Problem::Failed(format!("{GCC} is not here: run `cargo xtask setup`")));
    }
    let none = format!("no compiler for {TARGET}: run `cargo xtask setup`");
    let found = toolchain::find().ok_or(Problem::Failed(none))?;
    execute(&mut found.cargo(&LIBRARY[1..])?)?;
    let processor = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"];
    let mut gcc = command(&[&[GCC, "-O2", "-ffreestanding", "-nostdlib"], &processor[..], &FLAGS[..]].concat());
    gcc.arg("-I").arg(bindings().join("c/include")).arg("examples/c-loop/loop.c");
    gcc.arg(work.target.join(TARGET).join("release/libshakedown_c.a"));
    gcc.args(["-Wl,--gc-sections", "-Wl,-e,HAL_TIM_PeriodElapsedCallback", "-Wl,-u,loop_begin"]);
    gcc.args(BOARD.map(|name| format!("-Wl,--defsym={name}=0x20000000")));
    execute(gcc.arg("-o").arg(work.folder.join("loop-bare.elf")))
}
