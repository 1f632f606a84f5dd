//! The house rules a compiler does not know: lengths of files, the direction of dependencies, circles, stray
//! paths, boards known outside their folders, the width of the core's front door, the length of its tick, effects known outside their files, words that must not come back.

mod circles;
mod direction;
mod effects;
mod front_door;
mod lengths;
mod paths;
mod ports;
mod tick;
mod words;

use crate::output::say;
use crate::shell::{Problem, command, no_words, read, top};
use std::path::PathBuf;

/// The chore: names every breach.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let files = files()?;
    let breaches = breaches(&files)?;
    say(&format!("  core: {} public items", front_door::count(&files)));
    say(&format!("  {}", tick::describe(&files)));
    for breach in &breaches {
        say(&format!("  {breach}"));
    }
    match breaches.len() {
        0 => Ok(()),
        n => Err(Problem::Failed(format!("{n} breaches of the house rules"))),
    }
}

fn breaches(files: &[File]) -> Result<Vec<String>, Problem> {
    Ok([
        lengths::check(files),
        direction::crates()?,
        direction::modules(files),
        circles::check(files),
        paths::check(files),
        ports::check(files),
        front_door::check(files),
        tick::check(files),
        effects::check(files),
        words::check(files),
    ]
    .concat())
}

/// A file of the tree: its path from the top, and its text.
#[derive(Clone)]
struct File {
    path: String,
    text: String,
}

/// Every text file that is tracked, or new and not ignored.
fn files() -> Result<Vec<File>, Problem> {
    let listed = read(&mut command(&["git", "ls-files", "--cached", "--others", "--exclude-standard"]))?;
    let text = |path: &str| std::fs::read_to_string(top().join(PathBuf::from(path))).ok();
    Ok(listed.lines().filter_map(|path| Some(File { path: path.into(), text: text(path)? })).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_house_is_in_order() {
        let breaches = breaches(&files().unwrap()).unwrap();
        assert!(breaches.is_empty(), "{}", breaches.join("\n"));
    }
}
