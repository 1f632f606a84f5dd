//! Text of a bounded file, its lines with their numbers, and the numbers on them.

pub(super) use super::error::excerpt;
use super::error::{Problem, ReadError};
use crate::files::layout::{Encoding, decode};
use std::io::Read as _;
use std::path::{Path, PathBuf};

/// The largest record file that is read, bytes: 30 channels of 100 s at 200 Hz with velocity and displacement are 18 MB.
pub const SIZE_LIMIT: u64 = 64 << 20;
/// The most lines a record file may have, so that their index stays within memory.
const LINE_LIMIT: usize = 4 << 20;

/// A file's text, within bounds.
pub(super) struct Source {
    path: PathBuf,
    text: String,
    /// How the file's bytes stood for its characters.
    pub(super) encoding: Encoding,
}

impl Source {
    /// Reads a file, refusing what is too large before reading it, and what is not text.
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let error = |problem| ReadError { file: path.to_owned(), line: None, column: None, problem: Box::new(problem) };
        let unreadable = |e: std::io::Error| {
            error(if e.kind() == std::io::ErrorKind::NotFound { Problem::Absent } else { Problem::Unreadable(e) })
        };
        let file = std::fs::File::open(path).map_err(unreadable)?;
        let bytes = file.metadata().map_err(unreadable)?.len();
        if bytes > SIZE_LIMIT {
            return Err(error(Problem::TooLarge { bytes, limit: SIZE_LIMIT }));
        }
        // A pipe has no size: it is cut one byte past the limit.
        let mut content = Vec::new();
        file.take(SIZE_LIMIT + 1).read_to_end(&mut content).map_err(unreadable)?;
        Self::from_bytes(path, content)
    }

    /// No text, to point at a file that is none.
    pub(super) fn named(path: &Path) -> Self {
        Self { path: path.to_owned(), text: String::new(), encoding: Encoding::Utf8 }
    }

    /// Takes bytes already at hand.
    pub(super) fn from_bytes(path: &Path, bytes: Vec<u8>) -> Result<Self, ReadError> {
        let error = |problem| ReadError { file: path.to_owned(), line: None, column: None, problem: Box::new(problem) };
        let size = bytes.len() as u64;
        if size > SIZE_LIMIT {
            return Err(error(Problem::TooLarge { bytes: size, limit: SIZE_LIMIT }));
        }
        let encoding = match Encoding::of(&bytes) {
            Ok(encoding) => encoding,
            Err(reason) if reason.contains("UTF-16") => return Err(error(Problem::Encoding(reason))),
            // Named below with its place.
            Err(_) => Encoding::Utf8,
        };
        if matches!(encoding, Encoding::Utf16Le | Encoding::Utf16Be) {
            let text = decode(&bytes, encoding).into_owned();
            let blank = text.trim().is_empty();
            return if blank { Err(error(Problem::Empty)) } else { Ok(Self { path: path.to_owned(), text, encoding }) };
        }
        // Ctrl-Z ends old DOS files; form feeds stand between pages of printed ones.
        let plain = |b: u8| b >= 0x20 || matches!(b, b'\t' | b'\r' | b'\n' | 0x0c | 0x1a);
        if let Some(offset) = bytes.iter().position(|&b| !plain(b)) {
            return Err(error(Problem::Binary { offset, byte: bytes[offset] }));
        }
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Err(error(Problem::Empty));
        }
        // Old headers hold names in Latin-1, which Windows-1252 holds.
        let text = decode(&bytes, encoding).into_owned();
        Ok(Self { path: path.to_owned(), text, encoding })
    }

    /// The file's lines without their ends; classic, DOS and old Macintosh ends alike.
    pub(super) fn lines(&self) -> Result<Vec<&str>, ReadError> {
        let mut lines: Vec<&str> = Vec::new();
        let text = self.text.trim_end_matches(['\u{1a}', '\n', '\r', ' ', '\t', '\u{c}']);
        let split: &[char] = if text.contains('\n') { &['\n'] } else { &['\r'] };
        for line in text.split(split) {
            if lines.len() == LINE_LIMIT {
                let problem = Problem::TooManyLines { limit: LINE_LIMIT };
                return Err(ReadError {
                    file: self.path.clone(),
                    line: Some(LINE_LIMIT),
                    column: None,
                    problem: Box::new(problem),
                });
            }
            lines.push(line.trim_end());
        }
        Ok(lines)
    }
}

/// A run of lines of a file that knows where it stands.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    file: &'a Path,
    /// The lines.
    pub(super) lines: &'a [&'a str],
    /// The number of the first, from 1.
    first: usize,
}

impl<'a> Block<'a> {
    /// The whole file.
    pub(super) fn whole(source: &'a Source, lines: &'a [&'a str]) -> Self {
        Self { file: &source.path, lines, first: 1 }
    }

    /// The lines `from..to` of this block, cut where it ends.
    pub(super) fn part(&self, from: usize, to: usize) -> Self {
        let to = to.min(self.lines.len());
        let from = from.min(to);
        Self { file: self.file, lines: &self.lines[from..to], first: self.first + from }
    }

    /// The file's name without folder and extension.
    pub(super) fn name(&self) -> String {
        self.file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
    }

    /// The number of a line of this block in the file, from 1.
    pub(super) fn number(&self, index: usize) -> usize {
        self.first + index
    }

    /// An error at a line of this block.
    pub(super) fn at(&self, index: usize, problem: Problem) -> ReadError {
        ReadError {
            file: self.file.to_owned(),
            line: Some(self.number(index)),
            column: None,
            problem: Box::new(problem),
        }
    }

    /// An error at a character of a line of this block, both from 0.
    pub(super) fn at_column(&self, index: usize, column: usize, problem: Problem) -> ReadError {
        ReadError { column: Some(column + 1), ..self.at(index, problem) }
    }

    /// An error that says two things do not go together: `(stated, found)`.
    pub(super) fn contradiction(
        &self,
        index: usize,
        what: &'static str,
        (stated, found): (String, String),
        remedy: &'static str,
    ) -> ReadError {
        self.at(index, Problem::Contradiction { what, stated, found, remedy })
    }

    /// An error that says something the format has is not in this block.
    pub(super) fn missing(&self, expected: &'static str, remedy: &'static str) -> ReadError {
        self.at(0, Problem::Missing { expected, remedy })
    }

    /// The first line that holds a text, whatever the case, with its index.
    pub(super) fn find(&self, needle: &str) -> Option<(usize, &'a str)> {
        self.lines.iter().copied().enumerate().find(|(_, l)| l.to_lowercase().contains(needle))
    }

    /// Every number of the block, line by line: separated by blanks, or in columns `width` wide where they touch.
    pub(super) fn numbers(&self, width: Option<usize>) -> Result<Vec<f64>, ReadError> {
        let mut values = Vec::new();
        for (index, line) in self.lines.iter().enumerate() {
            let before = values.len();
            let outcome = fields(line).try_for_each(|(column, field)| {
                values.push(number(field).map_err(|p| self.at_column(index, column, p))?);
                Ok(())
            });
            if let Err(error) = outcome {
                values.truncate(before);
                values.extend(width.and_then(|w| fixed(line, w)).ok_or(error)?);
            }
        }
        Ok(values)
    }
}

/// Every field of a line with the column it starts in, from 0.
pub(super) fn fields(line: &str) -> impl Iterator<Item = (usize, &str)> {
    line.split_whitespace().map(move |f| (f.as_ptr() as usize - line.as_ptr() as usize, f))
}

/// The numbers of a line in columns of one width; none where any column holds something else.
fn fixed(line: &str, width: usize) -> Option<Vec<f64>> {
    if width == 0 || !line.is_ascii() {
        return None;
    }
    line.as_bytes().chunks(width).map(|c| number(std::str::from_utf8(c).ok()?.trim()).ok()).collect()
}

/// A number as Fortran or C writes it, finite.
pub(super) fn number(field: &str) -> Result<f64, Problem> {
    let expected = "a number";
    let clean = field.trim_end_matches([',', ';']);
    let value = clean.parse::<f64>().or_else(|_| clean.replace(['D', 'd'], "E").parse::<f64>());
    match value {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(Problem::NotFinite { found: excerpt(field), expected }),
        Err(_) => Err(Problem::NotANumber { found: excerpt(field), expected }),
    }
}

/// The first number in a text, units and words around it.
pub(super) fn first_number(text: &str) -> Option<&str> {
    text.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '=' | '(' | ')'))
        .map(|w| w.trim_end_matches(|c: char| c.is_ascii_alphabetic() || c == '.'))
        .find(|w| w.parse::<f64>().is_ok_and(f64::is_finite))
}

/// What follows the first occurrence of a text, whatever the case.
pub(super) fn after<'a>(line: &'a str, needle: &str) -> Option<&'a str> {
    // Lower case may change a text's length outside ASCII; only ASCII is compared.
    let at = line.to_ascii_lowercase().find(needle)?;
    line.get(at + needle.len()..)
}

/// A peak that a header states, as a number and with the size of its last digit.
pub(super) struct Stated<'a> {
    /// The text of it.
    pub(super) text: &'a str,
    /// Its value.
    pub(super) value: f64,
    /// The size of its last digit.
    pub(super) digit: f64,
}

impl<'a> Stated<'a> {
    /// Takes the first number in a text.
    pub(super) fn first_in(text: &'a str) -> Option<Self> {
        let text = first_number(text)?;
        let value = text.parse().ok()?;
        let mantissa = text.split(['e', 'E']).next()?;
        let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len());
        let exponent: i32 = text.split(['e', 'E']).nth(1).and_then(|e| e.parse().ok()).unwrap_or(0);
        let digit = 10f64.powi(exponent.saturating_sub(i32::try_from(decimals).unwrap_or(i32::MAX)));
        Some(Self { text, value, digit })
    }

    /// True where a value found in the data is this one, both rounded: within one last digit of the statement, half a last
    /// digit of the data, and a ten-thousandth.
    pub(super) fn agrees(&self, found: f64) -> bool {
        // Data fill their columns: what has room for decimals near zero may have none at the peak.
        let whole = |scale: f64| ((found * scale).round() - found * scale).abs() < 1e-6;
        let digit = [1.0, 10.0, 100.0].into_iter().find(|&s| whole(s)).map_or(0.0, |s| 1.0 / s);
        (self.value - found).abs() <= self.digit + digit / 2.0 + 1e-4 * self.value.abs()
    }
}

/// The value of largest magnitude, with its sign; where it is reached on both sides, with that of `stated`.
pub(super) fn signed_peak(values: &[f64], stated: f64) -> f64 {
    let farther = |x: f64, p: f64| x.abs() > p.abs() || x.abs() == p.abs() && x.signum() == stated.signum();
    values.iter().fold(0.0, |p: f64, &x| if farther(x, p) { x } else { p })
}
