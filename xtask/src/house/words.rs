//! Words of a private idiom that must not come back: the field has its own for each of them.
//!
//! Looked for in README, ARCHITECTURE and docs (decisions in docs/adr are history), in every doc comment, and in what the
//! commands of `cli` and `prove` print.

use super::File;

/// The phrase, in lower case, and what to write instead. A phrase that ends in `*` is the beginning of a word.
const WORDS: &[(&str, &str)] = &[
    ("told from", "distinguished from"),
    ("what stands", "name it"),
    ("stands at", "is, is at"),
    ("goes before", "overrides, precedes"),
    ("foresee*", "predict"),
    ("held back", "hold-out, held out"),
    ("reckon*", "compute, estimate"),
    ("how it fares", "health"),
    ("how the device fares", "health"),
    ("taken for", "mistaken for, treated as"),
    ("making good", "recovering"),
    ("of way", "of travel"),
    ("pretends", "simulates"),
    ("first excess", "initial misfit"),
    ("undone", "rejected, corrected"),
    ("strayed unseen", "undetected deviation"),
    ("the gains stand", "gain margin"),
    ("why not something else", "alternatives"),
];

/// Names each line that holds such a word, and what to write instead.
pub(super) fn check(files: &[File]) -> Vec<String> {
    files.iter().flat_map(of_file).collect()
}

fn of_file(file: &File) -> Vec<String> {
    let lines = file.text.lines().enumerate().filter(|(_, line)| is_read(&file.path, line));
    let found = |(at, line): (usize, &str)| {
        let line = line.to_lowercase();
        let words = WORDS.iter().filter(|(phrase, _)| holds(&line, phrase));
        let named = words.map(|(phrase, instead)| {
            format!("{}:{}: `{}`; write: {instead}", file.path, at + 1, phrase.trim_end_matches('*'))
        });
        named.collect::<Vec<_>>()
    };
    lines.flat_map(found).collect()
}

/// Whether a line is text for a reader.
fn is_read(path: &str, line: &str) -> bool {
    if path.rsplit('.').next() == Some("md") {
        let named = ["README.md", "ARCHITECTURE.md"].contains(&path);
        return named || (path.starts_with("docs/") && !path.starts_with("docs/adr/"));
    }
    if path.rsplit('.').next() != Some("rs") {
        return false;
    }
    let line = line.trim_start();
    if line.starts_with("//") {
        return line.starts_with("///") || line.starts_with("//!");
    }
    // Identifiers have no spaces, so what is found in a line of code is in a string.
    path.starts_with("sim-host/src/cli") || path.starts_with("sim-host/src/prove")
}

/// Whether a line in lower case holds the phrase as whole words.
fn holds(line: &str, phrase: &str) -> bool {
    let stem = phrase.trim_end_matches('*');
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(stem).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + stem.len()..].chars().next();
        let ends = stem.len() < phrase.len() || !after.is_some_and(part_of_word);
        ends && !before.is_some_and(part_of_word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(path: &str, text: &str) -> usize {
        check(&[File { path: path.into(), text: text.into() }]).len()
    }

    #[test]
    fn a_word_is_found_where_a_reader_meets_it() {
        let (doc, string) = ("    /// What it foresees.\n", "    say(\"the runs held back\");\n");
        assert_eq!(named("core/src/a.rs", doc), 1);
        assert_eq!(named("sim-host/src/cli/a.rs", string), 1);
        assert_eq!(named("docs/a.md", "The valve pretends.\nFine.\n"), 1);
    }

    #[test]
    fn words_of_others_and_texts_of_history_pass() {
        assert_eq!(named("docs/a.md", "mistaken for; a chest of wayward drawers\n"), 0);
        assert_eq!(named("docs/adr/0001-a.md", "held back\n"), 0);
        assert_eq!(named("core/src/a.rs", "    // held back\n    let guard_reckons_with = 1;\n"), 0);
        assert_eq!(named("sim-host/src/cli/a.rs", "    found.held_back.chi2\n"), 0);
    }
}
