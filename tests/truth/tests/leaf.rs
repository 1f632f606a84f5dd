//! The examiner shares nothing with the examined: no crate of this workspace may appear below it.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "the lint knows test functions, not helpers"
)]

use std::process::Command;

#[test]
fn no_crate_of_the_workspace_is_below_the_truth() {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["tree", "--package", "shakedown-truth", "--edges", "all", "--prefix", "none", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let tree = String::from_utf8_lossy(&output.stdout);
    let own: Vec<&str> = tree.lines().filter(|line| line.starts_with("shakedown")).collect();
    assert!(own.first().is_some_and(|first| first.starts_with("shakedown-truth ")), "{tree}");
    assert!(own.iter().all(|line| line.starts_with("shakedown-truth ")), "the truth depends on {own:?}");
}
