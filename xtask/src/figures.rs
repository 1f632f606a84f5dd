//! Every figure the project claims: its bound and the command that prints it, in one table.

mod table;

use crate::output::say;
use crate::shell::{Problem, no_words};
use table::FIGURES;

/// A figure someone may ask for.
struct Figure {
    /// What it belongs to.
    of: &'static str,
    /// What is measured.
    name: &'static str,
    /// What it must be.
    bound: &'static str,
    /// The command that prints it, from the top of the workspace; empty while none does.
    command: &'static str,
}

/// The chore: lists them.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    for figures in FIGURES.chunk_by(|a, b| a.of == b.of) {
        say(&format!("== {}", figures[0].of));
        for figure in figures {
            let command = if figure.command.is_empty() { "none prints it yet" } else { figure.command };
            say(&format!("{}\n    bound    {}\n    command  {command}", figure.name, figure.bound));
        }
        say("");
    }
    let without = FIGURES.iter().filter(|figure| figure.command.is_empty()).count();
    say(&format!("{} figures; {without} of them have no command yet.", FIGURES.len()));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_has_a_bound_and_stands_once() {
        for (i, figure) in FIGURES.iter().enumerate() {
            assert!(!figure.bound.is_empty(), "{}", figure.name);
            assert!(FIGURES[..i].iter().all(|other| other.name != figure.name), "{} stands twice", figure.name);
        }
        let groups = FIGURES.chunk_by(|a, b| a.of == b.of).map(|figures| figures[0].of);
        let mut names: Vec<&str> = groups.collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count, "each group stands together");
    }
}
