//! What a command found, once: a section of the page whose tables a terminal shows too, and the same as JSON.

use super::output::{print, print_table};
use shakedown::report::{Item, Section, terminal};
use std::path::PathBuf;

/// One part of a command's answer.
pub(crate) struct Part {
    /// Its key in the JSON.
    pub(crate) key: &'static str,
    /// Its value there.
    pub(crate) json: serde_json::Value,
    /// Its section of the page.
    pub(crate) section: Section,
    /// Files it was made from.
    pub(crate) inputs: Vec<PathBuf>,
}

/// Prints a section's heading, texts and tables; figures are the page's.
pub(crate) fn print_section(section: &Section) {
    print(&format!("{}\n\n", section.heading));
    for item in &section.items {
        match item {
            Item::Text(text) => print(&format!("{text}\n\n")),
            Item::Note(text) => print(&format!("note: {text}\n\n")),
            Item::Tiles(tiles) => print(&format!("{}\n", terminal::tiles(tiles))),
            Item::Table(table) => {
                print_table(table);
                print("\n");
            }
            _ => {}
        }
    }
}
