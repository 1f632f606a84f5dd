//! An effect of the library is its own file and a registry line: its identifier stands as a string nowhere else.
//!
//! Exempt are tests, and `prove`, whose rivals and planted faults are an examiner's choice.

use super::File;

/// Where the effects lie.
const FOLDER: &str = "sim-host/src/plant/effects/";
/// Rooms that may name an effect. `faults` has a table of its own, whose bias is called like one.
const MAY_NAME: [&str; 3] = [FOLDER, "sim-host/src/prove", "sim-host/src/faults"];

/// Names lines outside an effect's file that know it by its identifier.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let names: Vec<String> = files.iter().filter_map(identifier).map(|id| format!("\"{id}\"")).collect();
    let host = files.iter().filter(|file| file.path.starts_with("sim-host/src/"));
    let outside = host.filter(|file| !MAY_NAME.iter().any(|room| file.path.starts_with(room)) && !is_test(&file.path));
    outside.flat_map(|file| of_file(file, &names)).collect()
}

/// The identifier of the effect that a file holds.
fn identifier(file: &File) -> Option<&str> {
    file.path.strip_prefix(FOLDER)?;
    let (_, entry) = file.text.split_once("const ENTRY: Entry")?;
    entry.split_once("id: \"")?.1.split('"').next()
}

fn is_test(path: &str) -> bool {
    path.ends_with("tests.rs") || path.contains("/tests/")
}

fn of_file(file: &File, names: &[String]) -> Vec<String> {
    let code = file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let named = |line: &str| names.iter().find(|name| line.contains(name.as_str()));
    let found = code.lines().enumerate().filter_map(|(at, line)| Some((at, named(line)?)));
    found.map(|(at, name)| format!("{}:{}: names the effect {name}; ask its entry", file.path, at + 1)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_named_outside_its_file_is_found() {
        let file = |path: &str, text: &str| File { path: path.into(), text: text.into() };
        let drag =
            file("sim-host/src/plant/effects/drag.rs", "pub const ENTRY: Entry = Entry {\n    id: \"drag\",\n};\n");
        let fine = file("sim-host/src/plant/stepped.rs", "fn f() {}\n#[cfg(test)]\nmod tests {\n\"drag\"\n}\n");
        let rival = file("sim-host/src/prove/rival.rs", "const TERMS: [&str; 1] = [\"drag\"];\n");
        let knows = file("sim-host/src/closed_loop/twin.rs", "fn f() {}\nif id == \"drag\" {}\n");
        assert_eq!(check(&[drag.clone(), fine, rival]), Vec::<String>::new());
        assert_eq!(
            check(&[drag, knows]),
            ["sim-host/src/closed_loop/twin.rs:2: names the effect \"drag\"; ask its entry"]
        );
    }
}
