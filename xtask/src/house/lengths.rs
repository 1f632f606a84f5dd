//! No file over 300 lines without a reason; every module says what it is.

use super::File;

/// Most lines of one source file; tests, at its end or in a file of their own, are not counted.
const MOST: usize = 300;

/// Files that may be longer, each with its reason.
const LONGER: &[(&str, &str)] = &[
    ("core/src/controller.rs", "the order of a tick, from sample to command, in one place to be read together"),
    (
        "sim-host/src/cli/modify.rs",
        "arguments, figures and page of one command; its page is the next thing to move out",
    ),
    ("sim-host/src/cli/run.rs", "arguments and steps of one command; what is played is the next thing to move out"),
    ("sim-host/src/cli/compare/drive.rs", "one comparison, from its files to its page"),
    ("sim-host/src/device/drive.rs", "one state machine, whose steps are read together"),
    ("sim-host/src/files/layout.rs", "one search for delimiter, decimal sign and header, judged together"),
    ("sim-host/src/motion/condition.rs", "the steps of one recipe in their order, each short"),
    ("sim-host/src/plant/effects.rs", "the shape of an effect and the registry that names them all"),
    (
        "sim-host/src/plant/simulate/dynamics.rs",
        "the equations of all effects at their stages, in one place to be read together",
    ),
    ("sim-host/src/recording/check/consistency.rs", "one check after another over the same channels"),
    ("sim-host/src/recording/binary/tdms/objects.rs", "the objects of one format and how each stores its samples"),
    ("tests/truth/src/case.rs", "one dealing of a case from its seed, read top to bottom"),
];

/// Names files that are too long, reasons no longer needed, and modules without a word on what they are.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let sources = || files.iter().filter(|f| is_source(&f.path));
    let excused = |path: &str| LONGER.iter().any(|(longer, _)| *longer == path);
    let long = sources()
        .filter(|f| length(f) > MOST && !excused(&f.path))
        .map(|f| format!("{}: {} lines; split it, or say why not in {}", f.path, length(f), file!()));
    let stale = LONGER
        .iter()
        .filter(|(path, _)| !sources().any(|f| f.path == *path && length(f) > MOST))
        .map(|(path, _)| format!("{path}: no longer over {MOST} lines; take it out of {}", file!()));
    let silent = sources()
        .filter(|f| ends_in(&f.path, &["rs"]) && !f.path.ends_with("tests.rs") && !f.text.starts_with("//!"))
        .map(|f| format!("{}: begins without a line on what it is", f.path));
    long.chain(stale).chain(silent).collect()
}

/// Lines ahead of the tests.
fn length(file: &File) -> usize {
    if file.path.ends_with("tests.rs") || file.path.contains("/tests/") {
        return 0;
    }
    file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default().lines().count()
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
        let tested = file("core/src/d.rs", "//! D.\n".repeat(MOST) + "#[cfg(test)]\nmod tests {\n}\n");
        let breaches = check(&[long, silent, fine, tested]);
        let named = |path: &str| breaches.iter().filter(|breach| breach.starts_with(path)).count();
        assert_eq!(["core/src/a.rs", "core/src/b.rs", "core/src/c.rs", "core/src/d.rs"].map(named), [1, 1, 0, 0]);
    }
}
