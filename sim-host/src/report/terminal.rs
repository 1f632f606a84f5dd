//! The same tables for a terminal: aligned columns, numbers to the right, cells wrapped where the window is narrow.

use super::Table;
use super::escape::without_one;
use std::fmt::Write as _;

/// Narrowest a column of words is wrapped to.
const NARROWEST: usize = 12;
const BETWEEN: usize = 2;

/// A table as lines of at most `width` characters where its words allow it; `None` wraps nothing.
pub fn table(table: &Table, width: Option<usize>) -> String {
    let columns = table.columns.iter().map(|name| without_one(name)).collect();
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| without_one(cell)).collect()).collect();
    let table = &Table { columns, rows, caption: table.caption.clone() };
    let numeric = numeric_columns(table);
    let widths = column_widths(table, &numeric, width);
    let mut out = String::new();
    if !table.caption.is_empty() {
        for line in wrap(&table.caption, width.unwrap_or(usize::MAX)) {
            let _ = writeln!(out, "{line}");
        }
    }
    row(&mut out, &table.columns, &widths, &numeric);
    let rule: Vec<String> = widths.iter().map(|w| "\u{2500}".repeat(*w)).collect();
    let _ = writeln!(out, "{}", rule.join(&" ".repeat(BETWEEN)));
    for cells in &table.rows {
        row(&mut out, cells, &widths, &numeric);
    }
    out
}

/// Labels and values, one a line, the values aligned.
pub fn tiles(tiles: &[(String, String)]) -> String {
    let tiles: Vec<(String, &String)> = tiles.iter().map(|(label, value)| (without_one(label), value)).collect();
    let widest = tiles.iter().map(|(label, _)| length(label)).max().unwrap_or(0);
    tiles.iter().fold(String::new(), |mut out, (label, value)| {
        let _ = writeln!(out, "{label}{}  {value}", " ".repeat(widest - length(label)));
        out
    })
}

/// Which columns hold numbers: at least one, and nothing else but marks that stand for none.
pub(crate) fn numeric_columns(table: &Table) -> Vec<bool> {
    let none = |cell: &str| matches!(cell.trim(), "" | "-" | "\u{2013}" | "\u{2014}" | "n/a" | "NaN");
    let columns = 0..table.columns.len();
    let cells = |c: usize| table.rows.iter().filter_map(move |row| row.get(c)).filter(|cell| !none(cell));
    columns.map(|c| cells(c).next().is_some() && cells(c).all(|cell| starts_with_number(cell))).collect()
}

/// A number, or one with a unit, a spread or a mark behind it: `0.31`, `12 %`, `7.50 ± 0.08`.
fn starts_with_number(cell: &str) -> bool {
    cell.trim().trim_start_matches(['<', '>', '≤', '≥', '~', ' ']).split(' ').next().is_some_and(is_number)
}

/// True for a plain number, a typographic minus and a percent sign allowed.
pub(crate) fn is_number(word: &str) -> bool {
    let plain = word.trim_end_matches(['%', '×', 'x', 'g', 's']).replace('\u{2212}', "-");
    plain.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) && plain.parse::<f64>().is_ok()
}

/// Characters a terminal shows; combining marks and wide scripts are not measured.
fn length(text: &str) -> usize {
    text.chars().count()
}

/// Each column as wide as its widest cell, then the widest columns of words narrowed until all fits.
fn column_widths(table: &Table, numeric: &[bool], width: Option<usize>) -> Vec<usize> {
    let widest = |c: usize| {
        let cells = table.rows.iter().filter_map(|row| row.get(c)).map(|cell| length(cell));
        cells.chain([length(&table.columns[c])]).max().unwrap_or(0)
    };
    let mut widths: Vec<usize> = (0..table.columns.len()).map(widest).collect();
    let Some(limit) = width else { return widths };
    loop {
        let total = widths.iter().sum::<usize>() + BETWEEN * widths.len().saturating_sub(1);
        let narrowable = (0..widths.len()).filter(|&c| !numeric[c] && widths[c] > NARROWEST);
        let Some(column) = narrowable.max_by_key(|&c| widths[c]).filter(|_| total > limit) else { return widths };
        widths[column] = widths[column].saturating_sub(total - limit).max(NARROWEST).max(widths[column] * 2 / 3);
    }
}

fn row(out: &mut String, cells: &[String], widths: &[usize], numeric: &[bool]) {
    let empty = String::new();
    let wrapped: Vec<Vec<String>> =
        widths.iter().enumerate().map(|(c, w)| wrap(cells.get(c).unwrap_or(&empty), *w)).collect();
    for line in 0..wrapped.iter().map(Vec::len).max().unwrap_or(0) {
        let mut text = String::new();
        for (c, lines) in wrapped.iter().enumerate() {
            let cell = lines.get(line).map_or("", String::as_str);
            let pad = " ".repeat(widths[c].saturating_sub(length(cell)));
            let gap = " ".repeat(if c == 0 { 0 } else { BETWEEN });
            let _ = if numeric[c] { write!(text, "{gap}{pad}{cell}") } else { write!(text, "{gap}{cell}{pad}") };
        }
        let _ = writeln!(out, "{}", text.trim_end());
    }
}

/// Breaks at blanks; a word longer than the width is cut.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let mut word: Vec<char> = word.chars().collect();
        if !line.is_empty() && length(&line) + 1 + word.len() > width {
            lines.push(std::mem::take(&mut line));
        }
        while word.len() > width.max(1) {
            lines.push(word.drain(..width.max(1)).collect());
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.extend(word);
    }
    if !line.is_empty() || lines.is_empty() {
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn example() -> Table {
        let row = |cells: [&str; 3]| cells.map(String::from).to_vec();
        Table {
            columns: row(["controller", "E_a [1]", "remark"]),
            rows: vec![row(["current", "0.304", "as in the paper"]), row(["velo-disp-acc", "10.2", "-"])],
            caption: "Kobe".into(),
        }
    }

    #[test]
    fn columns_line_up() {
        let expected = "\
Kobe
controller       E_a  remark
─────────────  ─────  ───────────────
current        0.304  as in the paper
velo-disp-acc   10.2  -
";
        assert_eq!(table(&example(), None), expected);
    }

    #[test]
    fn a_narrow_window_wraps_words_and_never_numbers() {
        let text = table(&example(), Some(40));
        assert!(text.lines().all(|line| length(line) <= 40), "{text}");
        assert!(text.contains("0.304"));
    }

    #[test]
    fn numbers_are_told_from_words() {
        for yes in ["0.3", "-2e-3", "12 %", "12%", "7.50 ± 0.08", "< 1", "\u{2212}4", "0.74g", "1.2×"] {
            assert!(starts_with_number(yes), "{yes}");
        }
        for no in ["kobe", "E", "inf", "a 3", "3.V2"] {
            assert!(!starts_with_number(no), "{no}");
        }
    }

    proptest! {
        #[test]
        fn nothing_is_lost_in_wrapping(text in "[a-z ]{0,80}", width in 1_usize..30) {
            let letters = |s: &str| s.chars().filter(|c| !c.is_whitespace()).collect::<String>();
            let lines = wrap(&text, width);
            prop_assert_eq!(letters(&lines.concat()), letters(&text));
            prop_assert!(lines.iter().all(|l| length(l) <= width));
        }

        #[test]
        fn any_table_prints(cells in prop::collection::vec(prop::collection::vec(any::<String>(), 0..5), 0..5), width in 0_usize..100) {
            let any = Table { columns: vec!["a".into(), "b".into(), "c".into()], rows: cells, caption: String::new() };
            prop_assert!(table(&any, Some(width)).lines().count() >= 2);
        }
    }
}
