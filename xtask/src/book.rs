//! The tutorial as a book: mdBook builds it, and every chapter and picture is in it.

use std::path::Path;

use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute, top};

/// The version of mdBook, which this installs beside what is built.
const MDBOOK: &str = "0.5.4";
/// Where its program is put, from the top of the workspace.
const TOOLS: &str = "target/tools";
/// Where the book is put.
const BOOK: &str = "target/book";
/// Where it is written.
pub(crate) const SOURCE: &str = "docs/tutorial";

/// The chore.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let program = top().join(TOOLS).join("bin/mdbook");
    if !program.exists() {
        let version = format!("={MDBOOK}");
        let line =
            ["cargo", "install", "--locked", "mdbook", "--no-default-features", "--version", &version, "--root", TOOLS];
        execute(command(&line).current_dir(top()))?;
    }
    let (source, book) = (top().join(SOURCE), top().join(BOOK));
    execute(&mut command(&[&path(&program), "build", &path(&source), "--dest-dir", &path(&book)]))?;
    let chapters = whole(&source.join("src"), &book)?;
    say(&format!("{BOOK}/index.html: {chapters} chapters, each with its pictures"));
    Ok(())
}

fn path(path: &Path) -> String {
    path.display().to_string()
}

/// The number of chapters; a failure where one or a picture of one is missing.
fn whole(source: &Path, book: &Path) -> Result<usize, Problem> {
    let read =
        |file: &Path| std::fs::read_to_string(file).map_err(|e| Problem::Failed(format!("{}: {e}", file.display())));
    let summary = read(&source.join("SUMMARY.md"))?;
    let chapters: Vec<&str> = links(&summary).collect();
    for chapter in &chapters {
        let page = read(&book.join(chapter).with_extension("html"))?;
        for picture in
            links(&read(&source.join(chapter))?).filter(|link| Path::new(link).extension().is_some_and(|e| e == "svg"))
        {
            if !page.contains(picture) || !book.join(picture).is_file() {
                return Err(Problem::Failed(format!("{chapter}: {picture} is not in the book")));
            }
        }
    }
    if chapters.is_empty() { Err(Problem::Failed("the book has no chapters".into())) } else { Ok(chapters.len()) }
}

/// What the lines of a Markdown text link to, where a line ends with its link.
pub(crate) fn links(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| line.split_once("](")?.1.strip_suffix(')'))
}
