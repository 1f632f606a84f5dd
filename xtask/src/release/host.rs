//! The host tool's files: one binary a system that needs nothing beside it, what can be built here is built and tried, what cannot
//! is named with what is missing. A binary is tried as a newcomer has it: in an empty folder, with an empty environment.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::book;
use crate::output::say;
use crate::shell::{Problem, command, read, run as execute, top, works};
use sha2::{Digest as _, Sha256};

/// Where the files are put, from the top of the workspace.
const FOLDER: &str = "target/release-files/host";
/// Where they are built.
const BUILD: &str = "target/release-build";
/// Chapters of the tutorial that a binary is tried with.
const TRIED: usize = 3;

/// A system that a binary is built for.
struct System {
    target: &'static str,
    /// Its name for a person.
    name: &'static str,
    /// The program that links for it; none where Rust's own will do.
    linker: Option<&'static str>,
    /// How that is had.
    from: &'static str,
    /// Another system's binary that serves as well: where that one can be built, this one is not.
    serves: Option<&'static str>,
    /// What the compiler is told beside.
    flags: &'static str,
    /// What runs its programs here; empty where they run as they are, none where nothing does.
    runs: Option<&'static [&'static str]>,
}

const SYSTEMS: [System; 6] = [
    System {
        target: "x86_64-unknown-linux-musl",
        name: "Linux, 64-bit Intel and AMD, static",
        linker: None,
        from: "",
        serves: None,
        flags: "",
        runs: if cfg!(all(target_os = "linux", target_arch = "x86_64")) { Some(&[]) } else { None },
    },
    // The same with the library that every Linux has the parts of, linked in: no other target need be installed.
    System {
        target: "x86_64-unknown-linux-gnu",
        name: "Linux, 64-bit Intel and AMD, static, glibc",
        linker: None,
        from: "",
        serves: Some("x86_64-unknown-linux-musl"),
        flags: "-C target-feature=+crt-static",
        runs: if cfg!(all(target_os = "linux", target_arch = "x86_64")) { Some(&[]) } else { None },
    },
    System {
        target: "aarch64-unknown-linux-musl",
        name: "Linux, 64-bit ARM, static",
        linker: Some("aarch64-linux-gnu-gcc"),
        from: "apt-get install gcc-aarch64-linux-gnu",
        serves: None,
        flags: "",
        runs: if cfg!(all(target_os = "linux", target_arch = "aarch64")) { Some(&[]) } else { Some(&["qemu-aarch64"]) },
    },
    System {
        target: "x86_64-pc-windows-gnu",
        name: "Windows, 64-bit",
        linker: Some("x86_64-w64-mingw32-gcc"),
        from: "apt-get install gcc-mingw-w64-x86-64",
        serves: None,
        flags: "",
        runs: if cfg!(windows) { Some(&[]) } else { Some(&["wine"]) },
    },
    System {
        target: "aarch64-apple-darwin",
        name: "macOS, Apple silicon",
        linker: Some("xcrun"),
        from: "a Mac with the Xcode command line tools",
        serves: None,
        flags: "",
        runs: if cfg!(target_os = "macos") { Some(&[]) } else { None },
    },
    System {
        target: "x86_64-apple-darwin",
        name: "macOS, Intel",
        linker: Some("xcrun"),
        from: "a Mac with the Xcode command line tools",
        serves: None,
        flags: "",
        runs: if cfg!(target_os = "macos") { Some(&[]) } else { None },
    },
];

/// Builds what can be built; a system that cannot is named and no failure.
pub(super) fn run() -> Result<(), Problem> {
    let folder = top().join(FOLDER);
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", folder.display()));
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(failed)?;
    }
    std::fs::create_dir_all(&folder).map_err(failed)?;
    let installed = read(&mut command(&["rustup", "target", "list", "--installed"])).unwrap_or_default();
    let (mut sums, mut told) = (String::new(), String::new());
    for system in &SYSTEMS {
        let outcome = if let Some(what) = missing(system, &installed) {
            format!("not built here: {what}")
        } else {
            let file = built(system, &folder)?;
            let _ = writeln!(sums, "{}  {}", sha256(&file)?, name(system));
            tried(system, &file)?
        };
        let _ = writeln!(told, "{:28} {}: {outcome}", system.target, system.name);
    }
    std::fs::write(folder.join("SHA256SUMS"), &sums).map_err(failed)?;
    say(&format!("\n{told}\nin {FOLDER}:\n{sums}"));
    Ok(())
}

/// What is missing to build for a system; none where nothing is.
fn missing(system: &System, installed: &str) -> Option<String> {
    if !installed.lines().any(|line| line.trim() == system.target) {
        return Some(format!("needs `rustup target add {}`", system.target));
    }
    let better = SYSTEMS.iter().find(|other| Some(other.target) == system.serves);
    if better.is_some_and(|other| missing(other, installed).is_none()) {
        return Some(format!("{} serves as well", system.serves.unwrap_or_default()));
    }
    let linker = system.linker.filter(|linker| !works(&[linker, "--version"]))?;
    Some(format!("needs {linker} to link ({})", system.from))
}

fn name(system: &System) -> String {
    let suffix = if system.target.contains("windows") { ".exe" } else { "" };
    format!("shakedown-{}-{}{suffix}", env!("CARGO_PKG_VERSION"), system.target)
}

fn built(system: &System, folder: &Path) -> Result<PathBuf, Problem> {
    let line = ["cargo", "build", "--release", "--locked", "--package", "shakedown", "--bin", "shakedown", "--target"];
    let mut cargo = command(&line);
    cargo.arg(system.target).env("CARGO_TARGET_DIR", top().join(BUILD));
    if !system.flags.is_empty() {
        cargo.env("RUSTFLAGS", system.flags);
    }
    if let Some(linker) = system.linker.filter(|linker| linker.ends_with("gcc")) {
        let variable = system.target.to_uppercase().replace('-', "_");
        cargo.env(format!("CARGO_TARGET_{variable}_LINKER"), linker);
    }
    execute(&mut cargo)?;
    let suffix = if system.target.contains("windows") { ".exe" } else { "" };
    let made = top().join(BUILD).join(system.target).join(format!("release/shakedown{suffix}"));
    let place = folder.join(name(system));
    std::fs::copy(&made, &place).map_err(|e| Problem::Failed(format!("{}: {e}", made.display())))?;
    Ok(place)
}

fn sha256(path: &Path) -> Result<String, Problem> {
    let bytes = std::fs::read(path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))?;
    Ok(Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Tries a binary with the tutorial's first chapters; says how it went, or why it was not tried.
fn tried(system: &System, file: &Path) -> Result<String, Problem> {
    let Some(runner) = system.runs.filter(|words| words.first().is_none_or(|program| works(&[program, "--version"])))
    else {
        return Ok("built; not tried, for nothing here runs it".into());
    };
    let folder = top().join(BUILD).join(format!("tried-{}", system.target));
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", folder.display()));
    if folder.exists() {
        std::fs::remove_dir_all(&folder).map_err(failed)?;
    }
    std::fs::create_dir_all(&folder).map_err(failed)?;
    let commands = tutorial()?;
    for line in &commands {
        let words = runner.iter().copied().map(Path::new).chain([file]).collect::<Vec<_>>();
        let mut program = Command::new(words.first().copied().unwrap_or(file));
        program.args(words.iter().skip(1)).args(line.split(' ').skip(1)).current_dir(&folder);
        if runner.is_empty() {
            program.env_clear();
        }
        let output = program.output().map_err(failed)?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            return Err(Problem::Failed(format!("{}: `{line}` ended with {}: {said}", file.display(), output.status)));
        }
    }
    Ok(format!(
        "built; {} commands of the tutorial's first {TRIED} chapters ran, with an empty environment",
        commands.len()
    ))
}

/// The commands of the tutorial's first chapters.
fn tutorial() -> Result<Vec<String>, Problem> {
    let source = top().join(book::SOURCE).join("src");
    let text =
        |name: &str| std::fs::read_to_string(source.join(name)).map_err(|e| Problem::Failed(format!("{name}: {e}")));
    let summary = text("SUMMARY.md")?;
    let mut commands = Vec::new();
    for chapter in book::links(&summary).take(TRIED) {
        commands.extend(text(chapter)?.lines().filter_map(|line| line.strip_prefix("$ ")).map(str::to_owned));
    }
    Ok(commands)
}
