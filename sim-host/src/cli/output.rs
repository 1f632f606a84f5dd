//! The one door for output: text and JSON to standard output or a file, written whole or not at all.

use super::places::{folder, place, place_or_stdout};
use super::{Failure, asked};
use crate::report::{Page, Table, terminal};
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

mod figures;

/// `--json` and `--report`, the same on every command.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct Outputs {
    /// Writes the result as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE", value_parser = place_or_stdout())]
    pub(crate) json: Option<PathBuf>,
    /// Writes one HTML page that opens with no network.
    #[arg(long, value_name = "FILE", value_parser = place())]
    pub(crate) report: Option<PathBuf>,
    /// Writes the page's figures into this folder: each as SVG, and what they draw as `figures.json`.
    #[arg(long, value_name = "DIR", value_parser = folder())]
    pub(crate) figures: Option<PathBuf>,
}

impl Outputs {
    /// Writes `value`, with the version and the inputs' fingerprints added, where `--json` asks for it.
    pub(crate) fn write_json(&self, mut value: serde_json::Value, inputs: &[PathBuf]) -> Result<(), Failure> {
        let Some(path) = &self.json else { return Ok(()) };
        if let Some(object) = value.as_object_mut() {
            object.insert("version".into(), env!("CARGO_PKG_VERSION").into());
            object.insert("inputs".into(), fingerprints(inputs)?);
        }
        let text = serde_json::to_string_pretty(&value).map_err(|e| Failure::Work(e.to_string()))? + "\n";
        if path.as_os_str() == "-" {
            print(&text);
            return Ok(());
        }
        spared(path, inputs)?;
        write_whole(path, text.as_bytes())
    }

    /// Writes the page where `--report` asks for it and says where it is; the version and the inputs' fingerprints are
    /// added to what the page says of its origin.
    pub(crate) fn write_report(&self, page: &mut Page, inputs: &[PathBuf]) -> Result<(), Failure> {
        if let Some(folder) = &self.figures {
            figures::write(page, folder)?;
        }
        let Some(path) = &self.report else { return Ok(()) };
        spared(path, inputs)?;
        let mut origin = vec![("command".to_owned(), asked::line())];
        if !asked::defaults().is_empty() {
            origin.push(("left at defaults".into(), asked::defaults().into()));
        }
        origin.push(("version".into(), format!("shakedown {}", env!("CARGO_PKG_VERSION"))));
        origin.push(("written".into(), asked::utc()));
        page.provenance.splice(0..0, origin);
        for input in inputs {
            page.provenance.push((input.display().to_string(), sha256(input)?));
        }
        announce(path);
        page.write(path).map_err(|e| Failure::Work(format!("{}: cannot write: {e}", path.display())))?;
        tell(&format!("report: {}", path.display()));
        Ok(())
    }

    /// True where figures or a page are asked for.
    pub(crate) fn draws(&self) -> bool {
        self.report.is_some() || self.figures.is_some()
    }

    /// True where standard output belongs to JSON and no table may be printed.
    pub(crate) fn quiet(&self) -> bool {
        self.json.as_deref() == Some(Path::new("-"))
    }
}

/// Refuses to write over what was read, such as a recording that an experiment names.
fn spared(path: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    let there = path.canonicalize().ok();
    if there.is_some() && inputs.iter().any(|input| input.canonicalize().ok() == there) {
        return Err(Failure::Input(format!(
            "{}: was read, and is not written over: give another place",
            path.display()
        )));
    }
    Ok(())
}

/// Each file's SHA-256 by its name.
pub(crate) fn fingerprints(inputs: &[PathBuf]) -> Result<serde_json::Value, Failure> {
    let mut map = serde_json::Map::new();
    for path in inputs {
        map.insert(path.display().to_string(), sha256(path)?.into());
    }
    Ok(map.into())
}

/// A file's SHA-256 in hexadecimal.
pub(crate) fn sha256(path: &Path) -> Result<String, Failure> {
    let mut file = std::fs::File::open(path).map_err(|e| Failure::Input(format!("{}: {e}", path.display())))?;
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let n = std::io::Read::read(&mut file, &mut buffer)
            .map_err(|e| Failure::Input(format!("{}: {e}", path.display())))?;
        if n == 0 {
            break;
        }
        hash.update(&buffer[..n]);
    }
    Ok(hash.finalize().iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    }))
}

/// Writes a file whole or not at all: beside its place first, then renamed.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    announce(path);
    crate::files::write_whole(path, bytes).map_err(|e| Failure::Work(format!("{}: cannot write: {e}", path.display())))
}

/// Prints a table to standard output, as wide as the window where there is one.
pub(crate) fn print_table(table: &Table) {
    let window = std::io::stdout().is_terminal().then(terminal_size::terminal_size).flatten();
    print(&terminal::table(table, window.map(|(width, _)| usize::from(width.0))));
}

/// The first failure of standard output; nothing is printed after it.
static LOST: OnceLock<std::io::Error> = OnceLock::new();

/// Prints to standard output; what could not be printed is reported by [`finished`].
pub(crate) fn print(text: &str) {
    if LOST.get().is_some() {
        return;
    }
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        let _ = LOST.set(error);
    }
}

/// A failure where standard output did not take all that was printed: a full disk, or a pipe whose reader has gone.
pub(crate) fn finished() -> Result<(), Failure> {
    match LOST.get() {
        None => Ok(()),
        Some(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::Cut),
        Some(error) => Err(Failure::Work(format!("standard output: cannot write: {error}"))),
    }
}

/// Says a line on standard error; a standard error that takes nothing is no reason to fail.
pub(crate) fn tell(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Says which folder is made for a file, and what a pipe without a reader makes this process wait for.
pub(crate) fn announce(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    if let Some(folder) = folder {
        tell(&format!("note: {}: there is no such folder; it is made for {}", folder.display(), path.display()));
    }
    #[cfg(unix)]
    if std::fs::metadata(path).is_ok_and(|there| std::os::unix::fs::FileTypeExt::is_fifo(&there.file_type())) {
        tell(&format!("{}: is a pipe; waiting for its reader", path.display()));
    }
}
