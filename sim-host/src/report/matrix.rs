//! A matrix of counts or shares as a shaded table.

use super::escape::text;
use super::{Matrix, Shade};
use std::fmt::Write as _;

/// Writes the matrix.
pub(crate) fn write(out: &mut String, matrix: &Matrix) {
    let caption = text(&matrix.caption);
    let region = format!("<div class=\"table\" role=\"region\" aria-label=\"{caption}\" tabindex=\"0\">");
    let _ = writeln!(out, "{region}\n<table class=\"matrix\">\n<caption>{caption}</caption>");
    let _ = write!(
        out,
        "<thead><tr><th scope=\"col\">{} \u{2193} {} \u{2192}</th>",
        text(&matrix.rows_are),
        text(&matrix.columns_are)
    );
    for column in &matrix.columns {
        let _ = write!(out, "<th scope=\"col\"><span>{}</span></th>", text(column));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    let sizes = |values: &[f64]| values.iter().filter(|v| v.is_finite()).map(|v| v.abs()).collect::<Vec<f64>>();
    let largest = matrix.rows.iter().flat_map(|(_, values)| sizes(values)).fold(0.0, f64::max);
    for (name, values) in &matrix.rows {
        let total = match matrix.shade {
            Shade::OfRow => sizes(values).iter().sum(),
            Shade::OfLargest => largest,
        };
        let _ = write!(out, "<tr><th scope=\"row\">{}</th>", text(name));
        for value in values {
            cell(out, *value, total);
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n</div>\n");
}

fn cell(out: &mut String, value: f64, total: f64) {
    if !value.is_finite() {
        out.push_str("<td></td>");
        return;
    }
    let share = if total > 0.0 { (100.0 * value.abs() / total).round() } else { 0.0 };
    let class = if share > 55.0 { "full" } else { "part" };
    let shown = if value.fract() == 0.0 { format!("{value:.0}") } else { format!("{value:.3}") };
    let shown = if value == 0.0 { "\u{b7}".to_owned() } else { shown };
    let _ = write!(out, "<td class=\"{class}\" style=\"--share:{share}%\">{shown}</td>");
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One controller fills every row; what is worst is shaded whole all the same, and what is not less.
    #[test]
    fn errors_are_shaded_by_the_largest() {
        let shares = |shade| {
            let rows = vec![("weak".to_owned(), vec![0.1]), ("strong".to_owned(), vec![0.4])];
            let mut out = String::new();
            write(&mut out, &Matrix { columns: vec!["tracking".into()], rows, shade, ..Matrix::default() });
            [25, 100].map(|share| out.matches(&format!("--share:{share}%")).count())
        };
        assert_eq!(shares(Shade::OfRow), [0, 2]);
        assert_eq!(shares(Shade::OfLargest), [1, 1]);
    }
}
