//! Lines of a text, each bounded.

use crate::recording::error::{Place, Problem, RecordingError};
use std::io::{BufRead, Read as _};
use std::path::Path;

/// Longest line that is read, bytes.
pub(super) const MAX_LINE: usize = 1 << 20;

/// The lines of a text.
pub(super) struct Lines<'a> {
    input: Box<dyn BufRead + 'a>,
    number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(input: Box<dyn BufRead + 'a>) -> Self {
        Self { input, number: 0 }
    }

    /// The next line without its end; none after the last.
    pub(super) fn next(&mut self, path: &Path) -> Result<Option<String>, RecordingError> {
        let mut line = Vec::new();
        let read = (&mut self.input)
            .take(MAX_LINE as u64 + 1)
            .read_until(b'\n', &mut line)
            .map_err(|e| Place::file(path).refuse(Problem::Unreadable(e)))?;
        if read == 0 {
            return Ok(None);
        }
        self.number += 1;
        if read > MAX_LINE {
            let problem = Problem::TooLarge { what: "bytes in one line", limit: MAX_LINE };
            return Err(Place::line(path, self.number).refuse(problem));
        }
        while matches!(line.last(), Some(b'\n' | b'\r')) {
            line.pop();
        }
        // Older data loggers write superscripts and the micro sign in Windows-1252.
        let text = String::from_utf8(line).unwrap_or_else(|e| {
            crate::files::layout::decode(&e.into_bytes(), crate::files::layout::Encoding::Windows1252).into_owned()
        });
        let mark = if self.number == 1 { '\u{feff}' } else { '\0' };
        Ok(Some(text.trim_start_matches(mark).to_owned()))
    }
}
