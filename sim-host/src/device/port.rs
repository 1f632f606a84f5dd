//! A serial port: raw, eight bits, no parity, and never waited on.

use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;

use rustix::fs::OFlags;
use rustix::termios::{OptionalActions, tcgetattr, tcsetattr};

use super::session::Line;

/// An open port.
#[derive(Debug)]
pub struct Port(File);

impl Port {
    /// Opens the port at `path` with `baud` bits a second.
    pub fn open(path: &Path, baud: u32) -> io::Result<Self> {
        let flags = OFlags::NONBLOCK | OFlags::NOCTTY;
        let file = OpenOptions::new().read(true).write(true).custom_flags(flags.bits() as i32).open(path)?;
        let mut terminal = tcgetattr(&file)?;
        terminal.make_raw();
        terminal.set_speed(baud)?;
        tcsetattr(&file, OptionalActions::Flush, &terminal)?;
        Ok(Self(file))
    }
}

impl Line for Port {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        nothing_yet(self.0.read(bytes))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        nothing_yet(self.0.write(bytes))
    }
}

fn nothing_yet(done: io::Result<usize>) -> io::Result<usize> {
    match done {
        Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) => Ok(0),
        done => done,
    }
}
