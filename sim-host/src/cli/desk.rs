//! What a shell and a desk want of the tool: completions, man pages, a page opened.

use super::output::{print, tell, write_whole};
use super::{Arguments, Failure};
use clap::CommandFactory as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Prints the completions of a shell.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown completions bash > ~/.local/share/bash-completion/completions/shakedown
  shakedown completions zsh > ~/.zfunc/_shakedown
  shakedown completions fish > ~/.config/fish/completions/shakedown.fish")]
pub(crate) struct Completions {
    /// The shell.
    shell: clap_complete::Shell,
}

/// Writes the man pages, one a command.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  shakedown man ~/.local/share/man/man1")]
pub(crate) struct Man {
    /// The folder they go to.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Opens a page with whatever the desktop opens pages with.
#[derive(Debug, clap::Args)]
pub(crate) struct Open {
    /// The page.
    #[arg(value_name = "PAGE.html")]
    page: PathBuf,
}

/// Prints the completions.
pub(crate) fn completions(args: &Completions) {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Arguments::command(), "shakedown", &mut text);
    print(&String::from_utf8_lossy(&text));
}

/// Writes the man pages.
pub(crate) fn man(args: &Man) -> Result<(), Failure> {
    if args.folder.exists() && !args.folder.is_dir() {
        return Err(Failure::Input(format!("{}: is a file, name a folder", args.folder.display())));
    }
    let failed = |e: std::io::Error| Failure::Work(format!("{}: {e}", args.folder.display()));
    let made = tempfile::tempdir().map_err(failed)?;
    clap_mangen::generate_to(Arguments::command(), made.path()).map_err(failed)?;
    let mut count = 0;
    for entry in std::fs::read_dir(made.path()).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        write_whole(&args.folder.join(entry.file_name()), &std::fs::read(entry.path()).map_err(failed)?)?;
        count += 1;
    }
    tell(&format!("{count} pages in {}", args.folder.display()));
    Ok(())
}

/// Opens the page.
pub(crate) fn open(args: &Open) -> Result<(), Failure> {
    let place = args.page.display();
    let page = args.page.canonicalize().map_err(|_| {
        Failure::Input(format!("{place}: there is no such page; name one that a command wrote with --report"))
    })?;
    if !page.is_file() {
        return Err(Failure::Input(format!("{place}: is no file; name a page that `--report` wrote")));
    }
    if !page.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm")) {
        return Err(Failure::Input(format!("{place}: is no page; name an .html that `--report` wrote")));
    }
    show(page.as_os_str())
}

/// Hands a page or an address to whatever the desktop opens it with.
pub(crate) fn show(what: impl AsRef<std::ffi::OsStr>) -> Result<(), Failure> {
    let program = match std::env::consts::OS {
        "macos" => "open",
        "windows" => "explorer",
        _ => "xdg-open",
    };
    let what = what.as_ref();
    let started =
        Command::new(program).arg(what).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
    let by_hand = || format!("open {} in a browser by hand", std::path::Path::new(what).display());
    started.map(drop).map_err(|e| Failure::Work(format!("{program}: {e}; {}", by_hand())))
}
