//! The same sources give the same bytes: builds twice, from two folders into two others, and compares.

use crate::output::say;
use crate::shell::{Problem, command, read, run as execute, top};
use crate::{boards, firmware};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What can be built twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Product {
    /// The host tool.
    Tool,
    /// The firmware image.
    Firmware,
}

/// The chore: builds the host tool and the image, or one of them, twice from scratch and compares what came out.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let products = match words.as_slice() {
        [] => vec![Product::Tool, Product::Firmware],
        ["tool"] => vec![Product::Tool],
        ["firmware"] => vec![Product::Firmware],
        _ => return Err(Problem::Usage("reproduce takes `tool`, `firmware` or nothing".into())),
    };
    let elsewhere = copied()?;
    for product in products {
        let built = [build(product, &top(), "first")?, build(product, &elsewhere, "second-of-another-length")?];
        for hash in &built {
            say(&format!("{product:?}: sha256 {hash}"));
        }
        if built[0] != built[1] {
            return Err(Problem::Failed(format!("the two builds of {product:?} differ")));
        }
    }
    Ok(())
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
fn build(product: Product, from: &Path, name: &str) -> Result<String, Problem> {
    let folder = top().join("target/reproduce").join(name);
    let (mut cargo, flags, made) = match product {
        Product::Tool => {
            let cargo = command(&["cargo", "build", "--release", "--locked", "--package", "shakedown"]);
            (cargo, remap(from, &folder), folder.join("release/shakedown"))
        }
        Product::Firmware => {
            let flags = format!("{} {}", firmware::LINKER, remap(from, &folder));
            let board = boards::default()?;
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
