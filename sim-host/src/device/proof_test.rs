//! The proof test of stop, limit switches and relay: where it is kept, how long it holds, and whether one is due.
//!
//! It is walked through with the hydraulics off; whoever arms a device asks here first.

use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Where it is kept, in the folder that the tool is called from: one folder a table.
pub const PROOF_TEST: &str = "proof-test.toml";
/// How long it holds, s: a day.
const HOLDS: u64 = 86_400;

/// Whose arming asks for a proof test, and in which file it is kept.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProofTest(PathBuf);

impl ProofTest {
    /// The one kept in `file`.
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self(file.into())
    }

    /// The file.
    pub fn file(&self) -> &Path {
        &self.0
    }

    /// What is to be said where one is due now; none where one holds.
    pub fn overdue(&self) -> Option<String> {
        let text = std::fs::read_to_string(&self.0).ok();
        let why = due(text.as_deref(), now())?;
        Some(format!("the proof test of stop, limit switches and relay {why} ({})", self.0.display()))
    }
}

/// Seconds since 1970.
fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

/// The head of a file that is kept of a test at this time.
pub fn proof_test_kept(date: &str, passed: bool) -> String {
    format!("date = {date:?}\nseconds = {}\npassed = {passed}\n", now())
}

/// Why a proof test is due, `now` in seconds since 1970; none where one holds.
fn due(text: Option<&str>, now: u64) -> Option<&'static str> {
    let Some(text) = text else { return Some("was never done here") };
    let Ok(table) = text.parse::<toml::Table>() else { return Some("left a file that cannot be read") };
    let seconds = table.get("seconds").and_then(toml::Value::as_integer).and_then(|at| u64::try_from(at).ok());
    match (table.get("passed").and_then(toml::Value::as_bool), seconds) {
        (Some(true), Some(at)) if at <= now && now - at <= HOLDS => None,
        (Some(true), Some(_)) => Some("is older than a day"),
        (Some(false), _) => Some("was not passed"),
        _ => Some("left a file that cannot be read"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proof_test_holds_for_a_day_and_only_if_it_passed() {
        let file = |passed, at| format!("date = \"\"\nseconds = {at}\npassed = {passed}\n");
        let now = 1_000_000;
        assert_eq!(due(Some(&file(true, now - HOLDS)), now), None);
        assert_eq!(due(Some(&file(true, now - HOLDS - 1)), now), Some("is older than a day"));
        assert_eq!(due(Some(&file(true, now + 1)), now), Some("is older than a day"));
        assert_eq!(due(Some(&file(false, now)), now), Some("was not passed"));
        assert_eq!(due(None, now), Some("was never done here"));
        for text in ["passed = true", "seconds = 1", "passed = 1\nseconds = 1", "= ="] {
            assert_eq!(due(Some(text), now), Some("left a file that cannot be read"), "{text}");
        }
    }

    #[test]
    fn what_is_kept_of_a_test_is_found_again() {
        let folder = tempfile::tempdir().unwrap();
        let proof = ProofTest::new(folder.path().join(PROOF_TEST));
        assert!(proof.overdue().unwrap().contains("was never done here"));
        for (passed, holds) in [(false, false), (true, true)] {
            std::fs::write(proof.file(), proof_test_kept("2026-01-01", passed)).unwrap();
            assert_eq!(proof.overdue().is_none(), holds);
        }
    }
}
