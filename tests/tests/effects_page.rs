//! The documentation's table of effects is what the registry prints.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "the lint knows test functions, not helpers")]

use shakedown_tests::binary::shakedown;
use std::path::Path;

#[test]
fn the_page_is_what_the_registry_prints() {
    let output = shakedown().args(["effects", "--markdown"]).output().unwrap();
    assert!(output.status.success());
    let table = String::from_utf8(output.stdout).unwrap();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let page = std::fs::read_to_string(&path).unwrap_or_default();
    let head = "# The library of effects\n\nPrinted by `shakedown effects --markdown`; `UPDATE_GOLDEN=1 cargo test -p shakedown-tests \
                --test effects_page` writes it.\nHow to add one: [CONTRIBUTING.md](../CONTRIBUTING.md).\n\n";
    let wanted = format!("{head}{}\n", table.trim_end());
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, wanted).unwrap();
        return;
    }
    assert_eq!(page, wanted, "docs/effects.md: run this test with UPDATE_GOLDEN=1");
}
