//! No file over 300 lines without a reason; every module says what it is.

use super::File;

/// Most lines of one source file.
const MOST: usize = 300;

/// Files that may be longer, each with its reason.
const LONGER: &[(&str, &str)] = &[];

/// Names files that are too long, reasons no longer needed, and modules without a word on what they are.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let sources = || files.iter().filter(|f| is_source(&f.path));
    let excused = |path: &str| LONGER.iter().any(|(longer, _)| *longer == path);
    let long = sources()
        .filter(|f| f.text.lines().count() > MOST && !excused(&f.path))
        .map(|f| format!("{}: {} lines; split it, or say why not in {}", f.path, f.text.lines().count(), file!()));
    let stale = LONGER
        .iter()
        .filter(|(path, _)| !sources().any(|f| f.path == *path && f.text.lines().count() > MOST))
        .map(|(path, _)| format!("{path}: no longer over {MOST} lines; take it out of {}", file!()));
    let silent = sources()
        .filter(|f| ends_in(&f.path, &["rs"]) && !f.path.ends_with("tests.rs") && !f.text.starts_with("//!"))
        .map(|f| format!("{}: begins without a line on what it is", f.path));
    long.chain(stale).chain(silent).collect()
}

fn is_source(path: &str) -> bool {
    !path.contains("assets/uplot/") && ends_in(path, &["rs", "js", "css"])
}

fn ends_in(path: &str, endings: &[&str]) -> bool {
    path.rsplit_once('.').is_some_and(|(_, ending)| endings.contains(&ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_file_and_a_silent_one_are_named() {
        let file = |path: &str, text: String| File { path: path.into(), text };
        let long = file("core/src/a.rs", "//! A.\n".repeat(MOST + 1));
        let silent = file("core/src/b.rs", "fn b() {}\n".into());
        let fine = file("core/src/c.rs", "//! C.\n".repeat(MOST));
        assert_eq!(check(&[long, silent, fine]).len(), 2);
    }
}
