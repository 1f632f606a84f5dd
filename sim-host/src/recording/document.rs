//! A TOML document read key by key, so that every message can name the line, and a key that nobody asked for is refused.

use super::error::{Place, Problem, RecordingError, nearest};
use crate::files::{bounded, wording};
use std::cell::RefCell;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Reads a small text file.
pub(crate) fn read_text(path: &Path) -> Result<String, RecordingError> {
    bounded::text(path, bounded::BY_HAND).map_err(|e| Place::file(path).refuse(Problem::Unreadable(e)))
}

/// One table of the document, and the keys that were asked for so far.
pub(crate) struct Section<'a> {
    source: &'a Source,
    table: &'a DeTable<'a>,
    name: String,
    start: usize,
    asked: RefCell<Vec<&'static str>>,
}

/// The text of a document, for line numbers.
pub(crate) struct Source {
    path: std::path::PathBuf,
    line_starts: Vec<usize>,
}

impl Source {
    /// The document's text and where it came from.
    pub(crate) fn new(path: &Path, text: &str) -> Self {
        let breaks = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Self { path: path.to_path_buf(), line_starts: std::iter::once(0).chain(breaks).collect() }
    }

    /// The line, from one, of a byte.
    fn line(&self, byte: usize) -> usize {
        self.line_starts.partition_point(|&start| start <= byte)
    }

    fn place(&self, byte: usize, key: &str) -> Place {
        Place::line(&self.path, self.line(byte)).column(key)
    }
}

/// Parses a document.
pub(crate) fn parse<'a>(source: &Source, text: &'a str) -> Result<Spanned<DeTable<'a>>, RecordingError> {
    DeTable::parse(text).map_err(|error| {
        let place = error
            .span()
            .map_or_else(|| Place::file(&source.path), |span| Place::line(&source.path, source.line(span.start)));
        let line = error.span().and_then(|span| text.lines().nth(source.line(span.start) - 1));
        place.refuse(Problem::Syntax(error.message().to_owned() + wording::comma(line.unwrap_or_default())))
    })
}

/// A value and where it stands.
pub(crate) struct Entry<'a> {
    source: &'a Source,
    value: &'a DeValue<'a>,
    start: usize,
    name: String,
}

impl<'a> Section<'a> {
    /// The document's outermost table.
    pub(crate) fn root(source: &'a Source, table: &'a Spanned<DeTable<'a>>) -> Self {
        Self { source, table: table.get_ref(), name: String::new(), start: 0, asked: RefCell::default() }
    }

    /// Where this table starts.
    pub(crate) fn place(&self) -> Place {
        let place = Place::line(&self.source.path, self.source.line(self.start));
        if self.name.is_empty() { place } else { place.column(&self.name) }
    }

    /// The value of a key, where it is there.
    pub(crate) fn get(&self, key: &'static str) -> Option<Entry<'a>> {
        let mut asked = self.asked.borrow_mut();
        if !asked.contains(&key) {
            asked.push(key);
        }
        let value = self.table.get(key)?;
        Some(self.entry(key, value))
    }

    /// The value of a key that must be there.
    pub(crate) fn required(&self, key: &'static str, remedy: &'static str) -> Result<Entry<'a>, RecordingError> {
        self.get(key)
            .ok_or_else(|| self.misspelt(key).unwrap_or_else(|| self.place().refuse(Problem::Missing { key, remedy })))
    }

    /// The key that stands here in place of a missing one, where one is near enough.
    pub(crate) fn misspelt(&self, key: &'static str) -> Option<RecordingError> {
        let asked = self.asked.borrow();
        let near = self.table.iter().filter(|(name, _)| {
            let name = name.get_ref().as_ref();
            !asked.contains(&name) && nearest(name, [key]).is_some()
        });
        let found = near.min_by_key(|(name, _)| !name.get_ref().eq_ignore_ascii_case(key))?;
        let place = self.source.place(found.0.span().start, &self.path_of(found.0.get_ref()));
        Some(place.refuse(Problem::UnknownKey { suggestion: Some(key.to_owned()), known: key.to_owned() }))
    }

    /// A number, where it is there.
    pub(crate) fn number(&self, key: &'static str) -> Result<Option<f64>, RecordingError> {
        self.get(key).map(|e| e.number()).transpose()
    }

    /// A string, where it is there.
    pub(crate) fn string(&self, key: &'static str) -> Result<Option<String>, RecordingError> {
        self.get(key).map(|e| e.string().map(str::to_owned)).transpose()
    }

    /// Every key with its value, whatever it is called.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&'a str, Entry<'a>)> + '_ {
        let table = self.table;
        table.iter().map(|(key, value)| (key.get_ref().as_ref(), self.entry(key.get_ref(), value)))
    }

    /// Refuses every key that was not asked for.
    pub(crate) fn finish(&self) -> Result<(), RecordingError> {
        let asked = self.asked.borrow();
        for (key, _) in self.table {
            if !asked.contains(&key.get_ref().as_ref()) {
                let place = self.source.place(key.span().start, &self.path_of(key.get_ref()));
                return Err(place.refuse(unknown_key(key.get_ref(), &asked)));
            }
        }
        Ok(())
    }

    fn path_of(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    fn entry(&self, key: &str, value: &'a Spanned<DeValue<'a>>) -> Entry<'a> {
        Entry { source: self.source, value: value.get_ref(), start: value.span().start, name: self.path_of(key) }
    }
}

/// The problem of a key that is not among the known ones.
pub(crate) fn unknown_key(key: &str, known: &[&str]) -> Problem {
    Problem::UnknownKey { suggestion: nearest(key, known.iter().copied()), known: known.join(", ") }
}

impl<'a> Entry<'a> {
    /// Where it stands.
    pub(crate) fn place(&self) -> Place {
        self.source.place(self.start, &self.name)
    }

    /// A problem with it.
    pub(crate) fn refuse(&self, problem: Problem) -> RecordingError {
        self.place().refuse(problem)
    }

    fn wrong_type(&self, expected: &'static str) -> RecordingError {
        let kind = self.value.type_str();
        let article = if kind.starts_with(['a', 'i']) { "an" } else { "a" };
        self.refuse(Problem::WrongType { expected, found: format!("{article} {kind}") })
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64, RecordingError> {
        let value = match self.value {
            DeValue::Float(f) => f.as_str().parse().ok(),
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok().map(|n| n as f64),
            _ => None,
        };
        match value {
            Some(v) if f64::is_finite(v) => Ok(v),
            Some(value) => Err(self.refuse(Problem::OutOfRange { value, expected: "a finite number is expected" })),
            None => Err(self.wrong_type("a number")),
        }
    }

    /// A number above zero.
    pub(crate) fn positive(&self) -> Result<f64, RecordingError> {
        let value = self.number()?;
        if value > 0.0 {
            Ok(value)
        } else {
            Err(self.refuse(Problem::OutOfRange { value, expected: "it must be above zero" }))
        }
    }

    /// A number not below zero.
    pub(crate) fn not_negative(&self) -> Result<f64, RecordingError> {
        let value = self.number()?;
        if value >= 0.0 {
            Ok(value)
        } else {
            Err(self.refuse(Problem::OutOfRange { value, expected: "it must not be below zero" }))
        }
    }

    /// True or false.
    pub(crate) fn boolean(&self) -> Result<bool, RecordingError> {
        self.value.as_bool().ok_or_else(|| self.wrong_type("true or false"))
    }

    /// A string.
    pub(crate) fn string(&self) -> Result<&'a str, RecordingError> {
        self.value.as_str().ok_or_else(|| self.wrong_type("a string"))
    }

    /// True for a string, which some keys take beside a table.
    pub(crate) fn is_string(&self) -> bool {
        self.value.is_str()
    }

    /// True for a table, which some keys take beside a number.
    pub(crate) fn is_table(&self) -> bool {
        self.value.is_table()
    }

    /// A table.
    pub(crate) fn section(&self) -> Result<Section<'a>, RecordingError> {
        let table = self.value.as_table().ok_or_else(|| self.wrong_type("a table"))?;
        Ok(Section {
            source: self.source,
            table,
            name: self.name.clone(),
            start: self.start,
            asked: RefCell::default(),
        })
    }

    /// The tables of an array, each written under its name in double brackets.
    pub(crate) fn tables(&self) -> Result<Vec<Entry<'a>>, RecordingError> {
        if self.value.is_array() {
            self.list()
        } else {
            Err(self.wrong_type("an array of tables, each begun by [[runs]],"))
        }
    }

    /// The entries of an array.
    pub(crate) fn list(&self) -> Result<Vec<Entry<'a>>, RecordingError> {
        let array = self.value.as_array().ok_or_else(|| self.wrong_type("an array"))?;
        Ok(array
            .iter()
            .map(|v| Entry { source: self.source, value: v.get_ref(), start: v.span().start, name: self.name.clone() })
            .collect())
    }
}
