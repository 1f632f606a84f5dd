//! A page as one HTML text: markup here, style and scripts from `assets`, data beside each figure.

use super::escape::{prose, text, units, without_one};
use super::{Item, Page, Plot, Section, Table, figure, matrix, terminal};
use std::fmt::Write as _;

const UPLOT_STYLE: &str = include_str!("../../assets/uplot/uPlot.min.css");
const UPLOT_SCRIPT: &str = include_str!("../../assets/uplot/uPlot.iife.min.js");
const STYLE: &str = include_str!("../../assets/report/page.css");
const SCRIPTS: [&str; 4] = [
    include_str!("../../assets/report/format.js"),
    include_str!("../../assets/report/figure.js"),
    include_str!("../../assets/report/zoom.js"),
    include_str!("../../assets/report/page.js"),
];
/// Forbids every request, whatever the page holds.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'";
/// Cells with more characters than this wrap.
const LONG: usize = 36;
/// The mark beside the name: one pulse of a record, cut where the table can go no faster.
const MARK: &str =
    r#"<svg class="mark" viewBox="0 0 48 24" aria-hidden="true"><path d="M1 12h8l4-7h7l5 14h7l4-7h11"/></svg>"#;

/// The whole page.
pub(crate) fn page(page: &Page) -> String {
    let mut out = String::new();
    head(&mut out, page);
    let _ = write!(
        out,
        "<body>\n<header>\n<p class=\"name\">{MARK}shakedown</p>\n<h1>{}</h1>\n{}</header>\n",
        text(&page.title),
        paragraphs(&page.lead, "lead")
    );
    if !page.key.is_empty() {
        tiles(&mut out, &page.key);
    }
    advice(&mut out, &page.advice);
    let all: Vec<&Section> = page.sections.iter().chain(&page.details).collect();
    contents(&mut out, &all);
    out.push_str("<main>\n");
    let mut figures = 0;
    for (i, one) in page.sections.iter().enumerate() {
        let _ = writeln!(out, "<section id=\"section-{i}\">");
        if !one.heading.is_empty() {
            let _ = writeln!(out, "<h2>{}</h2>", text(&one.heading));
        }
        section(&mut out, one, &mut figures);
        out.push_str("</section>\n");
    }
    for (i, one) in page.details.iter().enumerate() {
        let id = page.sections.len() + i;
        let _ = writeln!(out, "<details id=\"section-{id}\"><summary><h2>{}</h2></summary>", text(&one.heading));
        section(&mut out, one, &mut figures);
        out.push_str("</details>\n");
    }
    out.push_str("</main>\n");
    footer(&mut out, page);
    for script in std::iter::once(UPLOT_SCRIPT).chain(SCRIPTS) {
        let _ = write!(out, "<script>\n{}\n</script>\n", script.trim());
    }
    out.push_str("</body>\n</html>\n");
    out
}

fn head(out: &mut String, page: &Page) {
    let _ = write!(
        out,
        r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="shakedown">
<title>{}</title>
<link rel="icon" href="data:,">
<style>
{}
{}
</style>
</head>
"#,
        text(&page.title),
        UPLOT_STYLE.trim(),
        STYLE.trim()
    );
}

/// Links to the sections, where there are enough to lose one's way.
fn contents(out: &mut String, sections: &[&Section]) {
    if sections.len() < 3 {
        return;
    }
    out.push_str("<nav aria-label=\"Contents\">\n");
    for (i, section) in sections.iter().enumerate().filter(|(_, s)| !s.heading.is_empty()) {
        let _ = writeln!(out, "<a href=\"#section-{i}\">{}</a>", text(&section.heading));
    }
    out.push_str("</nav>\n");
}

/// What to do, in order.
fn advice(out: &mut String, advice: &[String]) {
    if advice.is_empty() {
        return;
    }
    out.push_str("<div class=\"advice\">\n<h2>What to do</h2>\n<ol>\n");
    for one in advice {
        let _ = writeln!(out, "<li>{}</li>", prose(one));
    }
    out.push_str("</ol>\n</div>\n");
}

fn section(out: &mut String, section: &Section, figures: &mut usize) {
    let group_of = |item: &Item| if let Item::Plot(plot) = item { plot.group.clone() } else { None };
    for items in section.items.chunk_by(|a, b| group_of(a) == group_of(b)) {
        let grouped = group_of(&items[0]).is_some();
        out.push_str(if grouped { "<div class=\"group\">\n" } else { "" });
        for one in items {
            item(out, one, figures);
        }
        out.push_str(if grouped { "</div>\n" } else { "" });
    }
}

fn item(out: &mut String, item: &Item, figures: &mut usize) {
    match item {
        Item::Text(words) => out.push_str(&paragraphs(words, "")),
        Item::Note(words) => {
            let _ = writeln!(out, "<aside role=\"note\">{}</aside>", paragraphs(words, "").trim_end());
        }
        Item::Tiles(one) => tiles(out, one),
        Item::Table(one) => table(out, one),
        Item::Matrix(one) => matrix::write(out, one),
        Item::Plot(one) => {
            *figures += 1;
            plot(out, one, *figures);
        }
    }
}

fn tiles(out: &mut String, tiles: &[(String, String)]) {
    out.push_str("<dl class=\"tiles\">\n");
    for (label, value) in tiles {
        let _ = writeln!(out, "<div><dt>{}</dt><dd>{}</dd></div>", prose(&units(label)), figure_of(value));
    }
    out.push_str("</dl>\n");
}

/// A tile's value, its unit set smaller.
fn figure_of(value: &str) -> String {
    match value.split_once(' ') {
        Some((number, unit)) if terminal::is_number(number) => {
            format!("{} <small>{}</small>", text(number), text(unit))
        }
        _ => text(value),
    }
}

fn paragraphs(words: &str, class: &str) -> String {
    let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
    let parts = words.split("\n\n").filter(|p| !p.trim().is_empty());
    parts.fold(String::new(), |mut out, part| {
        let _ = writeln!(out, "<p{class}>{}</p>", prose(part));
        out
    })
}

fn table(out: &mut String, table: &Table) {
    let numeric = terminal::numeric_columns(table);
    let class = |column: usize, cell: &str| match numeric.get(column) {
        Some(true) => " class=\"number\"",
        _ if cell.chars().count() > LONG => " class=\"long\"",
        _ => "",
    };
    // A region that can be scrolled by the keyboard has a name in any case.
    let first = table.columns.iter().find(|name| !name.is_empty()).cloned().unwrap_or_default();
    let _ = write!(
        out,
        "<div class=\"table\" role=\"region\" aria-label=\"{}\" tabindex=\"0\">\n<table>\n",
        text(if table.caption.is_empty() { &first } else { &table.caption })
    );
    if !table.caption.is_empty() {
        let _ = writeln!(out, "<caption>{}</caption>", prose(&table.caption));
    }
    out.push_str("<thead><tr>");
    for (i, name) in table.columns.iter().enumerate() {
        let _ = write!(out, "<th scope=\"col\"{}>{}</th>", class(i, name), text(&units(name)));
    }
    out.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        out.push_str("<tr>");
        for (i, cell) in row.iter().enumerate() {
            let (tag, scope) = if i == 0 { ("th", " scope=\"row\"") } else { ("td", "") };
            let _ = write!(out, "<{tag}{scope}{}>{}</{tag}>", class(i, cell), prose(&without_one(cell)));
        }
        out.push_str("</tr>\n");
    }
    out.push_str("</tbody>\n</table>\n</div>\n");
}

fn plot(out: &mut String, plot: &Plot, number: usize) {
    let drawing = figure::draw(plot);
    let thinned = drawing.thinned_from.map_or_else(String::new, |n| {
        format!("<p class=\"thinned\">Drawn from {n} samples a curve, thinned so that every extreme stays.</p>\n")
    });
    let _ = write!(
        out,
        r#"<figure id="figure-{number}" tabindex="0" aria-label="{}">
<figcaption>{}</figcaption>
<script type="application/json">{}</script>
{thinned}<noscript><p>{}</p></noscript>
</figure>
"#,
        text(&drawing.words),
        prose(&plot.title),
        drawing.data,
        text(&drawing.words)
    );
}

fn footer(out: &mut String, page: &Page) {
    out.push_str("<footer>\n<h2>Where this comes from</h2>\n<dl>\n");
    for (name, value) in &page.provenance {
        let _ = writeln!(out, "<div><dt>{}</dt><dd>{}</dd></div>", text(name), text(value));
    }
    out.push_str(
        "</dl>\n<p>One file, no network: keep it with the data. Figures drawn by uPlot (MIT).</p>\n</footer>\n",
    );
}
