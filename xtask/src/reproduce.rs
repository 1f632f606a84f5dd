//! The same sources give the same bytes: builds twice into two folders and compares.

use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute, top};
use sha2::{Digest as _, Sha256};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The chore: builds the host tool twice from scratch and compares what came out.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let built: Vec<String> = ["first", "second"].iter().map(|name| build(name)).collect::<Result<_, _>>()?;
    for hash in &built {
        say(&format!("sha256 {hash}"));
    }
    if built[0] == built[1] { Ok(()) } else { Err(Problem::Failed("the two builds differ".into())) }
}

/// Builds into a folder of its own, every path in the result cut down to a name that no folder changes.
fn build(name: &str) -> Result<String, Problem> {
    let folder = top().join("target/reproduce").join(name);
    let mut cargo = command(&["cargo", "build", "--release", "--locked", "--package", "shakedown"]);
    execute(cargo.env("CARGO_TARGET_DIR", &folder).env("RUSTFLAGS", remap(&folder)))?;
    sha256(&folder.join("release/shakedown"))
}

/// Compiler flags that write `/shakedown` and `/cargo` for this machine's folders.
pub(crate) fn remap(target: &Path) -> String {
    let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let home = home.or_else(|| std::env::home_dir().map(|home| home.join(".cargo")));
    let folders = [Some((target.to_path_buf(), "/target")), Some((top(), "/shakedown")), home.map(|h| (h, "/cargo"))];
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
