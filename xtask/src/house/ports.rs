//! A port is its folder: no board's name stands outside of that, manifests, `tests/replay` and what people read.

use super::File;
use crate::boards::FOLDER;
use std::collections::BTreeSet;

/// Names lines outside a board's folder that know it by its name, whole or without the letters before its first digit.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let names = names(files);
    let outside = files.iter().filter(|file| !may_name(&file.path));
    outside.flat_map(|file| of_file(file, &names)).collect()
}

/// Folders of boards, in lower case, and each without its vendor's letters, as people say it.
fn names(files: &[File]) -> BTreeSet<String> {
    let folders = files.iter().filter_map(|file| file.path.strip_prefix(FOLDER)?.split_once('/')).map(|(name, _)| name);
    folders
        .flat_map(|name| {
            let name = name.to_lowercase();
            let short = name.strip_prefix("stm32").map(str::to_owned);
            [Some(name), short]
        })
        .flatten()
        .collect()
}

fn may_name(path: &str) -> bool {
    let file = path.rsplit('/').next().unwrap_or(path);
    let read = std::path::Path::new(file).extension().is_some_and(|extension| extension == "md")
        || ["docs/", "examples/"].iter().any(|folder| path.starts_with(folder));
    let manifest = file == "Cargo.toml" || file == "Cargo.lock";
    path.starts_with(FOLDER) || path.starts_with("tests/replay/") || manifest || read
}

fn of_file(file: &File, names: &BTreeSet<String>) -> Vec<String> {
    let named = |line: &str| names.iter().find(|name| line.to_lowercase().contains(name.as_str()));
    let lines = file.text.lines().enumerate();
    let found = lines.filter_map(|(at, line)| Some((at, named(line)?)));
    found
        .map(|(at, name)| format!("{}:{}: knows the board {name}, which is for its folder", file.path, at + 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File { path: path.into(), text: text.into() }
    }

    #[test]
    fn a_board_named_outside_its_folder_is_found() {
        let board = file("firmware/boards/stm32x1/src/lib.rs", "//! An STM32X1.\n");
        let stray = [
            file("xtask/src/a.rs", "fine\nconst IT: &str = \"shakedown-stm32x1\";\n"),
            file("core/src/a.rs", "// as on the X1\n"),
            file("memory.x", "/* STM32X1 */\n"),
        ];
        let may = [
            "Cargo.toml",
            "tests/hil/Cargo.toml",
            "tests/replay/src/x1.rs",
            "docs/a.md",
            "README.md",
            "examples/b/a.c",
        ];
        let files = [vec![board], stray.into(), may.map(|path| file(path, "stm32x1\n")).into()].concat();
        let breaches = check(&files);
        assert_eq!(breaches.len(), 3, "{breaches:?}");
        assert!(breaches[0].starts_with("xtask/src/a.rs:2:"), "{breaches:?}");
    }
}
