//! The same sources give the same bytes: builds twice, from two folders into two others, and compares.

use crate::boards::{self, Board};
use crate::firmware;
use crate::output::say;
use crate::shell::{Problem, command, read, run as execute, top};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What can be built twice.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Product {
    /// The host tool.
    Tool,
    /// The firmware image of a board.
    Image(Board),
}

impl Product {
    /// Its name for people.
    fn name(&self) -> &str {
        match self {
            Self::Tool => "host tool",
            Self::Image(board) => &board.title,
        }
    }
}

/// The chore: builds the host tool and the image of every board, or those named, twice from scratch and compares what came out.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    let products = products(words, boards::all()?)?;
    let elsewhere = copied()?;
    let mut differ = Vec::new();
    for product in &products {
        let built = [build(product, &top(), "first")?, build(product, &elsewhere, "second-of-another-length")?];
        for hash in &built {
            say(&format!("{}: sha256 {hash}", product.name()));
        }
        if built[0] != built[1] {
            differ.push(product.name());
        }
    }
    if differ.is_empty() {
        Ok(())
    } else {
        Err(Problem::Failed(format!("the two builds differ: {}", differ.join(", "))))
    }
}

/// What `words` name: the tool, the firmware of all `boards`, or that of one; everything where they name nothing.
fn products(words: &[String], boards: Vec<Board>) -> Result<Vec<Product>, Problem> {
    let names: Vec<String> = boards.iter().map(|board| board.name.clone()).collect();
    let images = boards.into_iter().map(Product::Image);
    let one = |name: &str| images.clone().find(|image| matches!(image, Product::Image(board) if board.name == name));
    match words {
        [] => Ok(std::iter::once(Product::Tool).chain(images).collect()),
        [word] if word == "tool" => Ok(vec![Product::Tool]),
        [word] if word == "firmware" => Ok(images.collect()),
        [word] if let Some(image) = one(word) => Ok(vec![image]),
        _ => Err(Problem::Usage(format!(
            "reproduce takes `tool`, `firmware`, the name of a board ({}) or nothing",
            names.join(", ")
        ))),
    }
}

/// A copy of the sources in another place, as they are now.
fn copied() -> Result<PathBuf, Problem> {
    let to = top().join("target/reproduce/sources");
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", to.display()));
    if to.exists() {
        std::fs::remove_dir_all(&to).map_err(failed)?;
    }
    for name in read(&mut command(&["git", "ls-files"]))?.lines() {
        let (from, copy) = (top().join(name), to.join(name));
        // A name that git still lists and nobody has any more is no source.
        if from.is_file() {
            std::fs::create_dir_all(copy.parent().unwrap_or(&to)).map_err(failed)?;
            std::fs::copy(&from, &copy).map_err(failed)?;
        }
    }
    Ok(to)
}

/// Builds the sources in `from` into a folder of their own, every path in the result cut down to a name that no folder
/// changes.
fn build(product: &Product, from: &Path, name: &str) -> Result<String, Problem> {
    let folder = top().join("target/reproduce").join(name);
    let (mut cargo, flags, made) = match product {
        Product::Tool => {
            let cargo = command(&["cargo", "build", "--release", "--locked", "--package", "shakedown"]);
            (cargo, remap(from, &folder), folder.join("release/shakedown"))
        }
        Product::Image(board) => {
            let flags = format!("{} {}", firmware::LINKER, remap(from, &folder));
            (board.command()?, flags, board.built(&folder))
        }
    };
    in_folder(&mut cargo, from).env("CARGO_TARGET_DIR", &folder).env("RUSTFLAGS", flags);
    execute(&mut cargo)?;
    sha256(&made)
}

fn in_folder<'c>(cargo: &'c mut Command, folder: &Path) -> &'c mut Command {
    cargo.current_dir(folder)
}

/// Compiler flags that write `/shakedown` and `/cargo` for this machine's folders.
pub(crate) fn remap(sources: &Path, target: &Path) -> String {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let folders = [
        Some((sources.to_path_buf(), "/shakedown")),
        Some((target.to_path_buf(), "/target")),
        home.map(|h| (h, "/cargo")),
    ];
    folders.into_iter().flatten().fold(String::new(), |mut flags, (from, to)| {
        let _ = write!(flags, "--remap-path-prefix={}={to} ", from.display());
        flags
    })
}

/// A file's SHA-256 in hexadecimal.
pub(crate) fn sha256(path: &Path) -> Result<String, Problem> {
    let bytes = std::fs::read(path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))?;
    Ok(Sha256::digest(&bytes).iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nothing named is everything, and a board that is not there is refused with those that are.
    #[test]
    fn every_board_is_built_twice_unless_one_is_named() {
        let boards = || boards::all().unwrap();
        let asked = |words: &[&str]| {
            let words: Vec<String> = words.iter().map(ToString::to_string).collect();
            products(&words, boards()).map(|products| products.iter().map(|p| p.name().to_owned()).collect::<Vec<_>>())
        };
        let titles: Vec<String> = boards().into_iter().map(|board| board.title).collect();
        assert_eq!(asked(&["firmware"]).unwrap(), titles);
        assert_eq!(asked(&[]).unwrap(), [vec!["host tool".to_owned()], titles.clone()].concat());
        let last = boards().pop().unwrap();
        assert_eq!(asked(&[&last.name]).unwrap(), std::slice::from_ref(&last.title));
        let Err(Problem::Usage(why)) = asked(&["stm32f4"]) else { panic!("it was taken") };
        assert!(why.contains(&last.name), "{why}");
    }
}
