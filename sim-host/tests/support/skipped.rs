//! Says that a test had nothing to test with, where it is seen: a test that returns early is green, and its output is not shown.

use std::io::Write as _;
use std::path::Path;

/// The file that `cargo xtask test` gathers such lines in, for its summary.
const VARIABLE: &str = "SHAKEDOWN_SKIPPED";

/// Says that something is left out, and why.
pub(crate) fn skipped(why: &str) {
    eprintln!("SKIPPED: {why}");
    if let Some(path) = std::env::var_os(VARIABLE) {
        let test = std::thread::current().name().unwrap_or("a test").to_owned();
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        // A line in one write, for tests run beside each other.
        let _ = file.and_then(|mut file| file.write_all(format!("{test}: {why}\n").as_bytes()));
    }
}

/// Says that development data are not at hand.
#[allow(dead_code, reason = "not every test that includes this needs data")]
pub(crate) fn without(path: &Path) {
    skipped(&format!("{} is not at hand; set SHAKEDOWN_DATA to the folder of the development data", path.display()));
}
