//! The diagnosis as an examinee: its public entry, and nothing else of it.

use super::super::{Failure, output};
use serde_json::Value;
use shakedown::prove::Examinee;
use std::path::Path;

/// The engine in this binary.
pub(super) struct Engine {
    version: String,
}

impl Engine {
    /// Freezes the engine's version: that of the package and the fingerprint of the binary.
    pub(super) fn new() -> Result<Self, Failure> {
        let binary = std::env::current_exe().map_err(|e| Failure::Work(format!("cannot find this binary: {e}")))?;
        let fingerprint = output::sha256(&binary)?;
        Ok(Self { version: format!("{} {}", env!("CARGO_PKG_VERSION"), &fingerprint[..16]) })
    }
}

impl Examinee for Engine {
    fn diagnose(&self, _experiment: &Path) -> Result<Value, String> {
        Err("the diagnosis is not there yet".into())
    }

    fn identify(&self, _experiment: &Path) -> Option<Result<Value, String>> {
        None
    }

    fn version(&self) -> String {
        self.version.clone()
    }
}
