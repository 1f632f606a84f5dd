//! How wide the core's front door is: its public types, traits, functions, constants and modules. Fields, variants, methods
//! and associated constants are not counted.
//!
//! The compiler's lint `unreachable_pub` makes `pub` mean public, so declarations marked `pub` are what a user can reach; a
//! re-export is another way to one of them, and not counted again.

use super::File;

/// Where the core lies.
const CORE: &str = "core/src/";
/// Most public items of the core.
const MOST: usize = 200;
/// What a public item's declaration begins with.
const KINDS: [&str; 10] = [
    "pub struct ",
    "pub enum ",
    "pub union ",
    "pub trait ",
    "pub type ",
    "pub fn ",
    "pub const ",
    "pub static ",
    "pub mod ",
    "pub unsafe fn ",
];

/// The core's public items.
pub(super) fn count(files: &[File]) -> usize {
    let of_core = files.iter().filter(|file| file.path.starts_with(CORE));
    of_core.map(|file| public_items(&file.text)).sum()
}

/// Complains where there are more than a user can take in.
pub(super) fn check(files: &[File]) -> Vec<String> {
    let items = count(files);
    if items <= MOST {
        return Vec::new();
    }
    vec![format!("{CORE}: {items} public items; at most {MOST}, the rest is `pub(crate)`")]
}

/// Public items of a formatted file, outside and inside its inline modules.
fn public_items(text: &str) -> usize {
    let mut modules = 0;
    let mut items = 0;
    for line in text.lines() {
        let plain = line.trim_start();
        let depth = (line.len() - plain.len()) / 4;
        if plain == "}" && modules > 0 && depth == modules - 1 {
            modules -= 1;
        }
        if depth != modules {
            continue;
        }
        items += usize::from(KINDS.iter().any(|kind| plain.starts_with(kind)));
        let opens = plain.starts_with("pub mod ") || plain.starts_with("mod ") || plain.starts_with("pub(crate) mod ");
        modules += usize::from(opens && plain.ends_with('{'));
    }
    items
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_fields_and_private_items_do_not_count() {
        let text = "\
pub struct Table {
    pub stroke: f32,
}

impl Table {
    pub const LONGEST: f32 = 1.0;

    pub fn new() -> Self {
        Self { stroke: 0.1 }
    }
}

pub(crate) fn hidden() {}

pub mod code {
    pub const OK: i32 = 0;

    impl Code {
        pub fn name(self) {}
    }

    pub fn name() {}
}

pub const fn after() {}
";
        // Table, code, OK, name, after.
        assert_eq!(public_items(text), 5);
    }

    #[test]
    fn a_wide_door_is_found() {
        let text = "pub fn one() {}\n".repeat(MOST + 1);
        let file = |path: &str| File { path: path.into(), text: text.clone() };
        assert_eq!(check(&[file("core/src/lib.rs")]).len(), 1);
        assert!(check(&[file("sim-host/src/lib.rs")]).is_empty());
    }
}
