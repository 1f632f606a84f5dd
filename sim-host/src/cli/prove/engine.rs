//! The examinee: a `shakedown` binary, asked through the commands that anybody can call. A case that brings it down costs
//! that case only.

use super::super::{Failure, output};
use serde_json::Value;
use shakedown::prove::Examinee;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A binary with `diagnose` and `identify`.
pub(super) struct Engine {
    binary: PathBuf,
    version: String,
}

impl Engine {
    /// This binary or another one; its fingerprint freezes its version.
    pub(super) fn new(other: Option<&Path>) -> Result<Self, Failure> {
        let own = || std::env::current_exe().map_err(|e| Failure::Work(format!("cannot find this binary: {e}")));
        let binary = other.map_or_else(own, |path| Ok(path.to_path_buf()))?;
        let fingerprint = output::sha256(&binary)?;
        let engine = Self { binary, version: String::new() };
        let name = engine.ask(&["--version".as_ref()]).map_err(Failure::Input)?;
        let name = String::from_utf8_lossy(&name).trim().to_string();
        Ok(Self { version: format!("{name}, sha256 {}", &fingerprint[..16]), ..engine })
    }

    fn ask(&self, arguments: &[&std::ffi::OsStr]) -> Result<Vec<u8>, String> {
        let output = Command::new(&self.binary)
            .args(arguments)
            // The cases run beside one another: each keeps to one core, so that its time is its own.
            .env("RAYON_NUM_THREADS", "1")
            .output()
            .map_err(|e| format!("{}: {e}", self.binary.display()))?;
        if output.status.success() {
            return Ok(output.stdout);
        }
        let said = String::from_utf8_lossy(&output.stderr);
        let message = said.lines().find(|line| line.starts_with("error")).or(said.lines().last()).unwrap_or("");
        Err(format!("{}: {message}", output.status))
    }

    fn json(&self, command: &str, experiment: &Path) -> Result<Value, String> {
        let said = self.ask(&[command.as_ref(), experiment.as_os_str(), "--json".as_ref(), "-".as_ref()])?;
        serde_json::from_slice(&said).map_err(|e| format!("{command} --json: {e}"))
    }
}

impl Examinee for Engine {
    fn diagnose(&self, experiment: &Path) -> Result<Value, String> {
        self.json("diagnose", experiment)
    }

    fn identify(&self, experiment: &Path) -> Option<Result<Value, String>> {
        Some(self.json("identify", experiment))
    }

    fn version(&self) -> String {
        self.version.clone()
    }
}
