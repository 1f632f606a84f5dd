//! Running other programs from the top of the workspace, each named before it runs.

use crate::output::say;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

/// Why a chore ended early.
#[derive(Debug)]
pub(crate) enum Problem {
    /// The command line is wrong: exit status 2.
    Usage(String),
    /// The work failed: exit status 1.
    Failed(String),
}

impl Problem {
    /// Prints the one message and gives the exit status.
    pub(crate) fn report(&self) -> ExitCode {
        let (Self::Usage(message) | Self::Failed(message)) = self;
        eprintln!("error: {message}");
        ExitCode::from(if matches!(self, Self::Usage(_)) { 2 } else { 1 })
    }
}

/// Refuses words behind a chore that takes none.
pub(crate) fn no_words(words: &[String]) -> Result<(), Problem> {
    match words {
        [] => Ok(()),
        [first, ..] => {
            Err(Problem::Usage(format!("this chore takes no `{first}`; `cargo xtask help` lists what does")))
        }
    }
}

/// The top of the workspace.
pub(crate) fn top() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// A program and its arguments, to be run from the top of the workspace.
pub(crate) fn command(words: &[&str]) -> Command {
    let (program, arguments) = words.split_first().map_or(("true", &[][..]), |(p, a)| (*p, a));
    let mut command = Command::new(if program == "cargo" { cargo() } else { program.into() });
    command.args(arguments).current_dir(top());
    command
}

/// Runs a program whose output everyone sees.
pub(crate) fn run(command: &mut Command) -> Result<(), Problem> {
    let line = spelled(command);
    say(&format!("$ {line}"));
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(Problem::Failed(format!("`{line}` ended with {status}"))),
        Err(e) => Err(Problem::Failed(format!("`{line}` did not start: {e}"))),
    }
}

/// Runs a program for what it prints.
pub(crate) fn read(command: &mut Command) -> Result<String, Problem> {
    let line = spelled(command);
    let output = command.output().map_err(|e| Problem::Failed(format!("`{line}` did not start: {e}")))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    Err(Problem::Failed(format!("`{line}`: {}", String::from_utf8_lossy(&output.stderr).trim())))
}

/// True where the program runs and is content.
pub(crate) fn works(words: &[&str]) -> bool {
    command(words).output().is_ok_and(|output| output.status.success())
}

/// Where this machine's cargo puts what it builds: beside the sources, or wherever its configuration says.
pub(crate) fn target() -> Result<PathBuf, Problem> {
    let metadata = metadata(false)?;
    Ok(metadata["target_directory"].as_str().map_or_else(|| top().join("target"), PathBuf::from))
}

/// What `cargo metadata` knows, of this workspace alone or with all it depends on.
pub(crate) fn metadata(dependencies: bool) -> Result<serde_json::Value, Problem> {
    metadata_of("Cargo.toml", dependencies)
}

/// The same of another workspace.
pub(crate) fn metadata_of(manifest: &str, dependencies: bool) -> Result<serde_json::Value, Problem> {
    let mut words = vec!["cargo", "metadata", "--format-version=1", "--locked", "--manifest-path", manifest];
    words.extend((!dependencies).then_some("--no-deps"));
    serde_json::from_str(&read(&mut command(&words))?).map_err(|e| Problem::Failed(format!("cargo metadata: {e}")))
}

/// The cargo that runs this chore.
fn cargo() -> PathBuf {
    std::env::var_os("CARGO").map_or_else(|| "cargo".into(), PathBuf::from)
}

/// The command as a person would type it.
fn spelled(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or(command.get_program());
    let words = std::iter::once(program).chain(command.get_args());
    words.map(|word| word.to_string_lossy().into_owned()).collect::<Vec<_>>().join(" ")
}
