//! Inside a room of the host crate files use each other one way: what a file uses does not use it back, through whatever
//! others. A file may use those it lies inside of (`a/b.rs` uses `a.rs`), for a module's types are its children's too.

use super::File;
use std::collections::{BTreeMap, BTreeSet};

/// A module's path from the crate's root.
type Module = Vec<String>;

/// Names every set of files that use each other in a circle.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let texts: BTreeMap<Module, String> = files.iter().filter_map(module).collect();
    let known: BTreeSet<&Module> = texts.keys().collect();
    let uses: BTreeMap<&Module, BTreeSet<&Module>> =
        texts.iter().map(|(from, text)| (from, used(from, text, &known))).collect();
    let reached: BTreeMap<&Module, BTreeSet<&Module>> = uses.keys().map(|from| (*from, reach(from, &uses))).collect();
    let mut named: BTreeSet<Vec<&Module>> = BTreeSet::new();
    for (from, there) in reached.iter().filter(|(from, there)| there.contains(*from)) {
        let circle = there.iter().copied().filter(|of| reached[of].contains(from)).collect();
        named.insert(circle);
    }
    let line = |circle: &Vec<&Module>| {
        let names: Vec<String> = circle.iter().map(|module| module.join("/")).collect();
        format!("sim-host/src: files use each other in a circle: {}", names.join(", "))
    };
    named.iter().map(line).collect()
}

/// The module that a source file is, with its text less comments and tests.
fn module(file: &File) -> Option<(Module, String)> {
    let rest = file.path.strip_prefix("sim-host/src/")?.strip_suffix(".rs")?;
    let module: Module = rest.split('/').map(str::to_owned).collect();
    if module.last().is_some_and(|name| name == "tests") || matches!(rest, "main" | "lib") {
        return None;
    }
    let text = file.text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned();
    Some((module, text.lines().map(code).collect::<Vec<_>>().join("\n")))
}

/// The modules of the same room that a module uses, those it lies inside of left out.
fn used<'a>(from: &Module, text: &str, known: &BTreeSet<&'a Module>) -> BTreeSet<&'a Module> {
    let mut paths: Vec<String> = Vec::new();
    for statement in text.split("use ").skip(1) {
        expand(statement.split(';').next().unwrap_or_default(), "", &mut paths);
    }
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    paths.extend(text.split(|c: char| !is_path(c)).filter(|word| word.contains("::")).map(str::to_owned));
    let found = paths.iter().filter_map(|path| resolve(from, path, known));
    found.filter(|to| *to != from && to.first() == from.first() && !from.starts_with(to)).collect()
}

/// The single paths of a `use` with braces.
fn expand(statement: &str, before: &str, paths: &mut Vec<String>) {
    let statement = statement.trim();
    let Some((head, body)) = statement.split_once('{') else {
        let path = statement.split(" as ").next().unwrap_or_default();
        paths.push(format!("{before}{path}").split_whitespace().collect());
        return;
    };
    let body = body.rsplit_once('}').map_or(body, |(body, _)| body);
    let (mut depth, mut start) = (0, 0);
    for (i, c) in body.char_indices().chain([(body.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                expand(&body[start..i], &format!("{before}{head}"), paths);
                start = (i + 1).min(body.len());
            }
            _ => {}
        }
    }
}

/// The file that a path names, or lies in.
fn resolve<'a>(from: &Module, path: &str, known: &BTreeSet<&'a Module>) -> Option<&'a Module> {
    let mut segments: Vec<&str> = path.split("::").collect();
    let mut base: Module = match *segments.first()? {
        "crate" => Vec::new(),
        "super" => from.clone(),
        _ => {
            // Its own child, or nothing of ours.
            let child: Module = from.iter().cloned().chain([segments[0].to_owned()]).collect();
            return known.get(&child).copied();
        }
    };
    if base.is_empty() {
        segments.remove(0);
    }
    while segments.first() == Some(&"super") {
        base.pop();
        segments.remove(0);
    }
    base.extend(segments.iter().map(|s| (*s).to_owned()));
    while !base.is_empty() {
        if let Some(found) = known.get(&base) {
            return Some(found);
        }
        base.pop();
    }
    None
}

/// Every module that can be reached from one.
fn reach<'a>(from: &Module, uses: &BTreeMap<&'a Module, BTreeSet<&'a Module>>) -> BTreeSet<&'a Module> {
    let mut seen = BTreeSet::new();
    let mut open: Vec<&Module> = uses.get(from).into_iter().flatten().copied().collect();
    while let Some(next) = open.pop() {
        if let Some(&module) = uses.keys().find(|module| **module == next)
            && seen.insert(module)
        {
            open.extend(uses[module].iter().copied());
        }
    }
    seen
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(path: &str, text: &str) -> File {
        File { path: format!("sim-host/src/{path}"), text: text.into() }
    }

    #[test]
    fn a_circle_through_three_files_is_named() {
        let files = [
            file("room.rs", "mod a;\nmod b;\nmod c;\nuse a::A;"),
            file("room/a.rs", "use super::b::{B, More};"),
            file("room/b.rs", "// use super::nothing\npub struct B(super::c::C);"),
            file("room/c.rs", "use crate::room::a::A;"),
        ];
        let circles = check(&files);
        assert_eq!(circles.len(), 1, "{circles:?}");
        assert!(circles[0].ends_with("room/a, room/b, room/c"), "{}", circles[0]);
    }

    #[test]
    fn a_child_may_use_what_it_lies_inside_of() {
        let files = [
            file("room.rs", "mod a;\nuse a::A;\npub struct Shared;"),
            file("room/a.rs", "use super::Shared;\n#[cfg(test)]\nmod tests {\n    use super::super::z::Z;\n}"),
            file("room/z.rs", "use super::a::A;"),
        ];
        assert_eq!(check(&files), Vec::<String>::new());
    }
}
