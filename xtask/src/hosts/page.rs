//! The page: the command line as WebAssembly and everything around it in one file that opens from disk.

use super::wasm::target;
use super::{Work, bindings};
use crate::output::say;
use crate::shell::{Problem, command, no_words, run as execute};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// The target: std with files, clocks and arguments, which `bindings/web/worker.js` gives it.
const WASI: &str = "wasm32-wasip1";
/// The profile of the root `Cargo.toml`.
const PROFILE: &str = "web";
/// Largest page, byte.
const LARGEST: u64 = 6_000_000;

/// The chore: builds the page and says where it is.
pub(crate) fn run(words: &[String]) -> Result<(), Problem> {
    no_words(words)?;
    let path = build(&Work::new()?)?;
    say(&format!("page: {}", path.display()));
    Ok(())
}

/// The page, built anew.
pub(super) fn build(work: &Work) -> Result<PathBuf, Problem> {
    target(WASI)?;
    let words = ["cargo", "build", "--locked", "--package", "shakedown", "--bin", "shakedown"];
    execute(command(&words).args(["--profile", PROFILE, "--target", WASI]))?;
    let program = packed(&work.target.join(WASI).join(PROFILE).join("shakedown.wasm"))?;
    let (path, page) = (work.folder.join("shakedown.html"), html(&base64(&program))?);
    std::fs::write(&path, &page).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))?;
    if page.len() as u64 > LARGEST {
        return Err(Problem::Failed(format!("the page has {} bytes, more than {LARGEST}", page.len())));
    }
    say(&format!("the page has {} bytes", page.len()));
    Ok(path)
}

/// A file as gzip packs it, the same bytes whenever it is packed.
fn packed(path: &Path) -> Result<Vec<u8>, Problem> {
    let failed = |e: std::io::Error| Problem::Failed(format!("gzip {}: {e}", path.display()));
    let content = std::fs::read(path).map_err(failed)?;
    let mut gzip = command(&["gzip", "-9nc"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().map_err(failed)?;
    let mut into = gzip.stdin.take().ok_or_else(|| Problem::Failed("gzip takes nothing".into()))?;
    // Written beside the reading: a pipe holds less than the file.
    let writer = std::thread::spawn(move || into.write_all(&content));
    let output = gzip.wait_with_output().map_err(failed)?;
    match writer.join() {
        Ok(Ok(())) if output.status.success() => Ok(output.stdout),
        Ok(Err(e)) => Err(failed(e)),
        _ => Err(Problem::Failed(format!("gzip ended with {}", output.status))),
    }
}

fn html(program: &str) -> Result<String, Problem> {
    let part = |name: &str| {
        let path = bindings().join("web").join(name);
        std::fs::read_to_string(&path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())))
    };
    let mut page = part("page.html")?;
    for (place, content) in [
        ("/*STYLE*/", part("page.css")?),
        ("/*WORKER*/", part("wasi.js")? + &part("worker.js")?),
        ("/*PAGE*/", part("page.js")?),
        ("/*PROGRAM*/", program.to_owned()),
    ] {
        page = page.replacen(place, &content, 1);
    }
    Ok(page)
}

/// Bytes in base 64.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |three: &[u8]| {
        let word = (0..3).fold(0_u32, |word, k| word << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
        let given = three.len();
        [18, 12, 6, 0]
            .into_iter()
            .enumerate()
            .map(move |(k, shift)| if k > given { '=' } else { char::from(DIGITS[(word >> shift & 63) as usize]) })
    };
    bytes.chunks(3).flat_map(digits).collect()
}

#[cfg(test)]
mod tests {
    use super::base64;

    /// The examples of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        let wanted = ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"];
        for (length, wanted) in wanted.into_iter().enumerate() {
            assert_eq!(base64(&b"foobar"[..length]), wanted);
        }
    }
}
