//! What a file of recordings holds before channels are given to it: named columns of numbers.

use super::error::{Place, Problem, RecordingError, nearest};
use super::unit::Unit;
use std::path::Path;

/// Most values kept of one file: 2^26 of them, half a gigabyte.
pub(crate) const MAX_VALUES: usize = 1 << 26;

/// Largest file that is read, bytes.
pub(crate) const MAX_BYTES: usize = 1 << 30;

/// A column's name and what its header says of its unit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Heading {
    /// The whole heading, trimmed.
    pub text: String,
    /// The heading without a unit in brackets at its end, trimmed.
    pub name: String,
    /// What is in the brackets.
    pub unit: Option<String>,
}

/// Columns of a file, in the order they were asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Their headings.
    pub headings: Vec<Heading>,
    /// Their values, all of one length; NaN where a sample was dropped.
    pub columns: Vec<Vec<f64>>,
    /// What was assumed to read them, in words.
    pub notes: Vec<String>,
}

impl Heading {
    /// Splits `displacement [mm]` into name and unit.
    pub fn parse(text: &str) -> Self {
        let text = text.trim();
        let split = text.strip_suffix(']').and_then(|t| t.rsplit_once('['));
        let (name, unit) = match split {
            Some((name, unit)) if !name.trim().is_empty() => (name.trim(), Some(unit.trim().to_owned())),
            _ => (text, None),
        };
        Self { text: text.to_owned(), name: name.to_owned(), unit }
    }

    /// Checks the unit in brackets against the experiment's.
    pub fn agrees(&self, stated: Unit, place: Place) -> Result<(), RecordingError> {
        let Some(header) = &self.unit else { return Ok(()) };
        let known = Unit::in_header(header);
        let uncalibrated = known.is_none() && stated == super::unit::NUMBER;
        if uncalibrated || known == Some(stated) {
            return Ok(());
        }
        Err(place.refuse(Problem::UnitContradicted { header: header.clone(), stated: stated.symbol }))
    }
}

/// Where each wanted column stands among the headings: the whole heading counts first, then the name without its unit.
pub(crate) fn locate(headings: &[Heading], wanted: &[&str], path: &Path) -> Result<Vec<usize>, RecordingError> {
    wanted.iter().map(|w| locate_one(headings, w.trim(), path)).collect()
}

fn locate_one(headings: &[Heading], wanted: &str, path: &Path) -> Result<usize, RecordingError> {
    let place = || Place::line(path, 1).column(wanted);
    let all = |field: fn(&Heading) -> &str| -> Vec<usize> {
        headings.iter().enumerate().filter(|(_, h)| field(h) == wanted).map(|(i, _)| i).collect()
    };
    let whole = all(|h| &h.text);
    let found = if whole.is_empty() { all(|h| &h.name) } else { whole };
    match found.as_slice() {
        [one] => Ok(*one),
        [] => Err(place().refuse(Problem::NoSuchColumn {
            wanted: wanted.to_owned(),
            suggestion: nearest(wanted, headings.iter().map(|h| h.name.as_str())),
            available: listed(headings),
        })),
        several => Err(place().refuse(Problem::SameName { count: several.len() })),
    }
}

fn listed(headings: &[Heading]) -> String {
    const SHOWN: usize = 30;
    let mut names: Vec<&str> = headings.iter().map(|h| h.name.as_str()).take(SHOWN).collect();
    if headings.len() > SHOWN {
        names.push("...");
    }
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_in_brackets_is_taken_off_the_name() {
        let heading = Heading::parse(" table acceleration [m/s2] ");
        assert_eq!(heading.name, "table acceleration");
        assert_eq!(heading.unit.as_deref(), Some("m/s2"));
        assert_eq!(Heading::parse("[odd]").name, "[odd]");
        assert_eq!(Heading::parse("plain").unit, None);
    }

    #[test]
    fn a_contradicted_unit_is_refused_and_an_agreeing_one_is_not() {
        let place = || Place::line(Path::new("a.csv"), 1).column("x");
        let mm = Unit::named("mm").unwrap();
        assert!(Heading::parse("x [mm]").agrees(mm, place()).is_ok());
        assert!(Heading::parse("x").agrees(mm, place()).is_ok());
        let error = Heading::parse("x [m]").agrees(mm, place()).unwrap_err().to_string();
        assert_eq!(
            error,
            "a.csv, line 1, `x`: the header gives the unit [m], the experiment `mm`; correct the one that is wrong"
        );
        assert!(Heading::parse("p [counts]").agrees(super::super::unit::NUMBER, place()).is_ok());
    }
}
