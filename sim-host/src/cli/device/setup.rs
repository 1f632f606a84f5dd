//! A device's setup, as a file.

use super::failed;
use crate::cli::Failure;
use crate::cli::output::{print, write_whole};
use crate::cli::places::place;
use crate::cli::unseen::say_unseen;
use crate::device::{Port, Session};
use crate::files::{bounded, wording};
use shakedown_core::link::{HostRequest, Setup};
use std::path::{Path, PathBuf};

/// `device get`.
#[derive(Debug, clap::Args)]
pub(super) struct Get {
    /// The file; without it, standard output.
    #[arg(long, value_name = "FILE", value_parser = place())]
    out: Option<PathBuf>,
}

impl Get {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        let setup = session.setup().map_err(failed)?;
        let text = toml::to_string(&setup).map_err(|e| Failure::Work(e.to_string()))?;
        if let Some(path) = &self.out {
            return write_whole(path, text.as_bytes());
        }
        print(&text);
        Ok(())
    }
}

/// `device set`.
#[derive(Debug, clap::Args)]
pub(super) struct Set {
    /// The setup, as `get` writes it.
    #[arg(value_name = "SETUP.toml")]
    file: PathBuf,
    /// Keeps it over a reset; the ticks stop for a second or two.
    #[arg(long)]
    save: bool,
}

impl Set {
    pub(super) fn run(&self, session: &mut Session<Port>) -> Result<(), Failure> {
        let setup = read(&self.file)?;
        say_unseen(&setup.control);
        session.order(&HostRequest::WriteSetup(setup)).map_err(failed)?;
        if self.save {
            session.order(&HostRequest::Save).map_err(failed)?;
        }
        Ok(())
    }
}

/// Reads a setup and checks it by the very check that the device makes.
pub(super) fn read(path: &Path) -> Result<Setup, Failure> {
    let refuse = |why: &dyn std::fmt::Display| Failure::Input(format!("{}: {why}", path.display()));
    let text = bounded::text(path, bounded::BY_HAND).map_err(|e| refuse(&e))?;
    let setup: Setup = toml::from_str(&text).map_err(|e| {
        let line = e.span().map(|span| text[..span.start.min(text.len())].matches('\n').count() + 1);
        let place = line.map_or_else(String::new, |line| format!("line {line}: "));
        refuse(&format!("{place}{}", wording::plain(e.message())))
    })?;
    setup.validate().map_err(|e| refuse(&e))?;
    Ok(setup)
}
