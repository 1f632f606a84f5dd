//! Texts that say on their own first lines how they are written: MTS 793 and LabVIEW measurement files.

use crate::files::layout::{self, Decimal, Delimiter, Stated};

/// What a known form says of its own layout.
#[derive(Default)]
pub(super) struct Special {
    /// What it is, and what was taken from its header.
    pub(super) notes: Vec<String>,
    /// Its layout.
    pub(super) stated: Stated,
    /// How another block of the same file begins.
    pub(super) block_mark: Option<String>,
    /// The line with the names, from 0, and its new text: no column of remarks, every name once.
    pub(super) names: Option<(usize, String)>,
    /// True where rows may end with a remark.
    pub(super) remarks: bool,
    /// The times that an empty first column stands for.
    pub(super) clock: Option<Clock>,
}

impl Special {
    /// The first lines without remarks, which no column of numbers has.
    pub(super) fn without_remarks<'a>(&self, head: &'a [String]) -> Vec<&'a str> {
        let separator = if self.stated.delimiter == Some(Delimiter::Comma) { ',' } else { '\t' };
        let columns = self.names.as_ref().map_or(0, |(_, names)| names.matches(separator).count() + 1);
        let first = self.names.as_ref().map_or(usize::MAX, |(line, _)| *line);
        let cut = |line: &'a String| {
            line.match_indices(separator).nth(columns - 1).map_or(line.as_str(), |(end, _)| &line[..end])
        };
        let line = |(i, line): (usize, &'a String)| if self.remarks && i > first { cut(line) } else { line.as_str() };
        head.iter().enumerate().map(line).collect()
    }
}

/// Evenly spaced times that a header states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Clock {
    start: f64,
    step: f64,
}

impl Clock {
    /// The time of a row, from 0.
    pub(super) fn at(self, row: usize) -> f64 {
        self.start + self.step * row as f64
    }
}

/// True for the first bytes of such a text.
pub(super) fn is_start(start: &[u8]) -> bool {
    start.starts_with(MTS.as_bytes()) || start.starts_with(LABVIEW.as_bytes())
}

const MTS: &str = "MTS793|";
const LABVIEW: &str = "LabVIEW Measurement";
/// The end of LabVIEW's header of a file, and of a block.
const END: &str = "***End_of_Header***";
/// What LabVIEW calls a column of times.
const TIMES: &str = "X_Value";

/// What the first lines say; nothing where they are of no such form.
pub(super) fn of(head: &[String]) -> Option<Special> {
    let first = head.first()?;
    if first.starts_with(MTS) {
        return mts793(head);
    }
    first.starts_with(LABVIEW).then(|| labview(head)).flatten()
}

/// `MTS793|program|language|version|delimiter|decimal|...`: delimiter 0 blank, 1 comma, 2 tab. The first block is read; its first line
/// says when it was taken, its second names the columns, its third their units.
fn mts793(head: &[String]) -> Option<Special> {
    let fields: Vec<&str> = head.first()?.split('|').collect();
    let delimiter = match *fields.get(4)? {
        "0" => Delimiter::Blank,
        "1" => Delimiter::Comma,
        _ => Delimiter::Tab,
    };
    let decimal = fields.get(5)?.parse().ok();
    let title = head.windows(3).position(|w| {
        let names = delimiter.split(&w[1]).len();
        let units = delimiter.split(&w[2]);
        names > 1 && units.len() == names && units.iter().all(|u| u.is_empty() || layout::is_unit(u))
    })?;
    let block_mark = delimiter.split(&head[title]).first().map(|word| (*word).to_owned()).filter(|w| !w.is_empty());
    let stated = Stated { skip_lines: Some(title + 1), delimiter: Some(delimiter), decimal, units: None };
    Some(Special { notes: vec!["MTS 793 text".to_owned()], stated, block_mark, ..Special::default() })
}

/// A header of the file and one of the first block, each of lines `KEY, value, value, ...`, then the names. A block has one column of
/// times, one for each channel, or none and its times in the header; further blocks bring a header of their own.
fn labview(head: &[String]) -> Option<Special> {
    let mut ends = head.iter().enumerate().filter(|(_, line)| line.starts_with(END)).map(|(i, _)| i);
    let first = ends.next()?;
    let end = ends.next().unwrap_or(first);
    let comma = head[..end].iter().any(|line| line.starts_with("Separator") && line.contains("Comma"));
    let delimiter = if comma { Delimiter::Comma } else { Delimiter::Tab };
    let stated = |key: &str| -> Vec<String> {
        let of =
            head[..end].iter().rev().map(|line| delimiter.split(line)).find(|f| f.first().is_some_and(|k| *k == key));
        of.map_or_else(Vec::new, |fields| fields[1..].iter().map(|f| (*f).to_owned()).collect())
    };
    let word = |key: &str| stated(key).into_iter().next().unwrap_or_default();
    let mut names = delimiter.split(head.get(end + 1)?);
    while names.last().is_some_and(|name| name.is_empty()) {
        names.pop();
    }
    let remarks = names.last() == Some(&"Comment");
    let names = &names[..names.len() - usize::from(remarks)];
    let in_time = matches!(word("X_Dimension").as_str(), "" | "Time");
    let labels = stated("Y_Unit_Label");
    let unit = |(i, name): (usize, &&str)| match *name {
        TIMES if in_time => "s".to_owned(),
        TIMES => String::new(),
        // The first label is of the column after the times.
        _ => i.checked_sub(1).and_then(|i| labels.get(i)).cloned().unwrap_or_default(),
    };
    let units: Vec<String> = names.iter().enumerate().map(unit).collect();
    let clock = (word("X_Columns") == "No").then(|| clock(&stated)).flatten();
    let mut notes = vec!["LabVIEW measurement file".to_owned()];
    notes.extend(clock.map(|c| format!("times from the header: {} s and on in steps of {} s", c.start, c.step)));
    Some(Special {
        notes,
        stated: Stated {
            skip_lines: Some(end + 1),
            delimiter: Some(delimiter),
            decimal: word("Decimal_Separator").parse().ok(),
            units: Some(units),
        },
        block_mark: Some("Channels".to_owned()),
        names: Some((end + 1, once(names).join(if comma { "," } else { "\t" }))),
        remarks,
        clock,
    })
}

/// The times that `X0` and `Delta_X` state, where they do alike for every channel that has samples.
fn clock(stated: &dyn Fn(&str) -> Vec<String>) -> Option<Clock> {
    let samples = stated("Samples");
    let filled = |i: usize| samples.get(i).is_none_or(|n| n != "0");
    let of = |key: &str| -> Option<f64> {
        let number = |text: &str| Decimal::Point.number(text).or_else(|| Decimal::Comma.number(text));
        let all: Vec<f64> = stated(key)
            .iter()
            .enumerate()
            .filter(|(i, text)| filled(*i) && !text.is_empty())
            .filter_map(|(_, t)| number(t))
            .collect();
        let first = all.first().copied()?;
        all.iter().all(|v| v.to_bits() == first.to_bits()).then_some(first)
    };
    let step = of("Delta_X").filter(|step| *step > 0.0 && step.is_finite())?;
    Some(Clock { start: of("X0").filter(|x| x.is_finite()).unwrap_or(0.0), step })
}

/// The names, those of several columns of times with the channel that each belongs to.
fn once(names: &[&str]) -> Vec<String> {
    let several = names.iter().filter(|name| **name == TIMES).count() > 1;
    let name = |(i, name): (usize, &&str)| match names.get(i + 1) {
        Some(channel) if several && *name == TIMES => format!("{TIMES} of {channel}"),
        _ => (*name).to_owned(),
    };
    names.iter().enumerate().map(name).collect()
}
