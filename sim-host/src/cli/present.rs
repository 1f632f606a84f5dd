//! What a command found, once: a section of the page whose tables a terminal shows too, and the same as JSON.

use super::output::{print, print_table};
use crate::report::{Item, Section, terminal};
use std::path::PathBuf;

/// One part of a command's answer.
pub(crate) struct Part {
    /// Its key in the JSON.
    pub(crate) key: &'static str,
    /// Its value there.
    pub(crate) json: serde_json::Value,
    /// What came out, in a sentence.
    pub(crate) found: String,
    /// The figure that it comes down to.
    pub(crate) figure: (String, String),
    /// Its section of the page.
    pub(crate) section: Section,
    /// Files it was made from.
    pub(crate) inputs: Vec<PathBuf>,
}

/// Prints a section's heading, texts and tables; figures are the page's, and a section of figures alone is not printed.
pub(crate) fn print_section(section: &Section) {
    if section.items.iter().all(|item| matches!(item, Item::Plot(_))) {
        return;
    }
    print(&format!("{}\n\n", section.heading));
    for item in &section.items {
        match item {
            Item::Text(text) => print(&paragraph(text)),
            Item::Note(text) => print(&paragraph(&format!("note: {text}"))),
            Item::Tiles(tiles) => print(&format!("{}\n", terminal::tiles(tiles))),
            Item::Table(table) => {
                print_table(table);
                print("\n");
            }
            _ => {}
        }
    }
}

/// Widest line of running text.
const WIDTH: usize = 100;

/// A paragraph in lines of at most [`WIDTH`] characters, and an empty line.
fn paragraph(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= WIDTH => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines.join("\n") + "\n\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_wrapped_and_lose_no_word() {
        let text = "one two three ".repeat(40);
        let wrapped = paragraph(&text);
        assert!(wrapped.lines().all(|line| line.len() <= WIDTH) && wrapped.lines().count() > 3);
        assert_eq!(wrapped.split_whitespace().count(), 120);
    }
}
