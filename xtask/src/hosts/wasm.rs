//! WebAssembly in a real browser: one page that holds library, tape and player, opened from disk in headless Chromium.

use super::{Work, bindings};
use crate::shell::{Problem, command, read, run as execute, works};
use std::fmt::Write as _;
use std::path::Path;

/// The target.
pub(super) const WASM: &str = "wasm32-unknown-unknown";
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// What a browser is told: to open the page, to let it end its work, to say what has become of it.
const FLAGS: [&str; 7] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--virtual-time-budget=600000",
    "--dump-dom",
];

/// Sees to it that there is a standard library for the target.
pub(super) fn target(name: &str) -> Result<(), Problem> {
    let libraries = read(&mut command(&["rustc", "--print", "target-libdir", "--target", name]));
    if libraries.is_ok_and(|folder| Path::new(folder.trim()).is_dir()) {
        return Ok(());
    }
    execute(&mut command(&["rustup", "target", "add", name]))
}

pub(super) fn build(_: &Work) -> Result<(), Problem> {
    target(WASM)?;
    let words = ["cargo", "build", "--locked", "--release", "--package", "shakedown-c", "--target", WASM];
    execute(&mut command(&words))
}

pub(super) fn play(work: &Work, folder: &Path) -> Result<(), Problem> {
    let none = "no Chromium here: run `cargo xtask setup`";
    let browser = BROWSERS.into_iter().find(|name| works(&[name, "--version"]));
    let browser = browser.ok_or_else(|| Problem::Failed(none.into()))?;
    let page = folder.join("page.html");
    let failed = |e: std::io::Error| Problem::Failed(format!("{}: {e}", page.display()));
    std::fs::write(&page, html(work, folder)?).map_err(failed)?;
    let profile = folder.join("profile");
    let mut chromium = command(&[&[browser], &FLAGS[..]].concat());
    chromium.arg(format!("--user-data-dir={}", profile.display())).arg(format!("file://{}", page.display()));
    let said = read(&mut chromium)?;
    let result = said.split_once("<pre>").and_then(|(_, rest)| rest.split_once("</pre>")).map(|(result, _)| result);
    let result = result.ok_or_else(|| Problem::Failed("the page ended without an answer".into()))?;
    let bytes = bytes(result).ok_or_else(|| Problem::Failed(format!("the page says: {result}")))?;
    std::fs::write(folder.join("answers"), bytes).map_err(failed)
}

/// The page: library and tape in hexadecimal digits, and both modules as one.
fn html(work: &Work, folder: &Path) -> Result<String, Problem> {
    let file = |path: &Path| std::fs::read(path).map_err(|e| Problem::Failed(format!("{}: {e}", path.display())));
    let text = |path: &Path| file(path).map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let library = file(&work.target.join(WASM).join("release/shakedown_c.wasm"))?;
    let core = text(&bindings().join("wasm/shakedown.js"))?.replace("export ", "");
    let player = text(&bindings().join("wasm/tests/tape.js"))?.replace("export ", "");
    // What both say of the same names is said once.
    let player = player.split_once("function code").map(|(_, rest)| format!("function code{rest}")).unwrap_or_default();
    Ok(format!(
        "<!doctype html><meta charset=utf-8><title>tape</title><pre></pre><script>\n{core}\n{player}\n\
         const bytes = (hex) => Uint8Array.from(hex.match(/../g), (two) => parseInt(two, 16));\n\
         const hex = (bytes) => Array.from(bytes, (byte) => byte.toString(16).padStart(2, \"0\")).join(\"\");\n\
         const say = (text) => (document.querySelector(\"pre\").textContent = text);\n\
         Core.from(bytes(\"{}\")).then((core) => say(play(core, bytes(\"{}\")).map(hex).join(\"\")))\n\
         .catch((error) => say(String(error)));\n</script>\n",
        hex(&library),
        hex(&file(&folder.join("tape"))?)
    ))
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}

/// What hexadecimal digits stand for; none for other text.
fn bytes(text: &str) -> Option<Vec<u8>> {
    let digits: Option<Vec<u8>> = text.bytes().map(|byte| char::from(byte).to_digit(16).map(|d| d as u8)).collect();
    let (pairs, rest) = digits.as_ref().map(|digits| digits.as_chunks::<2>())?;
    (rest.is_empty() && !pairs.is_empty()).then(|| pairs.iter().map(|[high, low]| high << 4 | low).collect())
}

#[cfg(test)]
mod tests {
    use super::{bytes, hex};

    #[test]
    fn digits_are_read_as_they_are_written() {
        assert_eq!(bytes(&hex(&[0, 7, 255])), Some(vec![0, 7, 255]));
        assert_eq!(bytes("Error: no"), None);
        assert_eq!(bytes("abc"), None);
    }
}
